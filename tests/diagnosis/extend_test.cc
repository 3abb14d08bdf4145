// When an extension is offered, and what becomes of an earlier one that is not.
#include "diagnosis/extend.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

namespace dynoproof::diagnosis {
namespace {

namespace fs = std::filesystem;

TEST(Extend, OffersNothingThatIsNoBetterThanTheModelAsGiven) {
  EXPECT_TRUE(IsNoBetterThanGiven(Share{0.0, 0.0, 0.0}, false)) << "the run is as it was";
  EXPECT_TRUE(IsNoBetterThanGiven(Share{-0.1, -0.2, 0.1}, false));
  EXPECT_TRUE(IsNoBetterThanGiven(Share{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, false));
  EXPECT_FALSE(IsNoBetterThanGiven(Share{0.1, -0.2, 0.3}, false));
  EXPECT_FALSE(IsNoBetterThanGiven(Share{-1e-3, -0.2, 0.1}, true)) << "nothing but noise is left";
  EXPECT_FALSE(IsNoBetterThanGiven(std::nullopt, false)) << "nothing was compared";
}

TEST(Extend, LeavesNoExtensionOfAnEarlierDiagnosis) {
  const fs::path folder = fs::temp_directory_path() / ("extend_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "extended.toml") << "# of another record\n";
  DiagnoseOptions options;
  options.out = folder.string();
  RemoveExtended(options);
  EXPECT_FALSE(fs::exists(folder / "extended.toml"));
  RemoveExtended(options);  // where there is none
  fs::remove_all(folder);
}

}  // namespace
}  // namespace dynoproof::diagnosis
