// A map's signal that is the rate of change of a column.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiment/records.h"
#include "tests/support/temp_dir.h"

namespace dynoproof {
namespace {

std::optional<MappedRecord> Open(const std::string& unit, Diagnostics& diagnostics) {
  const test::TempDir folder;
  // x = t^2 in millimetres, each 0.1 s.
  folder.Write("record.csv", "t,x\n0,0\n0.1,10\n0.2,40\n0.3,90\n0.4,160\n");
  folder.Write("map.toml", "time = \"t\"\n[input.v]\ncolumn = \"x\"\nunit = \"" + unit +
                               "\"\nderivative = true\noffset = 5.0\nsign = -1\n");
  return OpenRecord((folder / "record.csv").string(), (folder / "map.toml").string(), {{"v", "m/s"}}, {}, diagnostics);
}

TEST(DerivedSignal, IsTheCentralDifferenceOfItsColumn) {
  Diagnostics diagnostics;
  const std::optional<MappedRecord> record = Open("mm", diagnostics);
  ASSERT_TRUE(record.has_value()) << diagnostics.Format();
  const std::vector<double>& v = *record->inputs.at("v").values;
  ASSERT_EQ(v.size(), 5U);
  // The central difference of a parabola is exact. A one-sided one at an end gives the slope half a step away from it. The derivative
  // of an offset is zero.
  const std::vector<double> expected = {-0.1, -0.2, -0.4, -0.6, -0.7};
  for (std::size_t i = 0; i < v.size(); ++i) EXPECT_NEAR(v[i], expected[i], 1e-12) << i;  // round-off of 0.16 / 0.1
}

TEST(DerivedSignal, HasTheUnitOfItsColumnPerSecond) {
  Diagnostics diagnostics;
  EXPECT_FALSE(Open("mm/s", diagnostics).has_value());
  EXPECT_THAT(diagnostics.Format(), ::testing::HasSubstr("different quantities"));
}

}  // namespace
}  // namespace dynoproof
