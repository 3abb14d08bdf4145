// Methods of `identify` by their names, and one that another layer brings along.
#include "identification/identify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::identification {
namespace {

using testing::HasSubstr;
using testing::Key;
using testing::UnorderedElementsAre;

/// Takes a tenth more than the nominal value of each number, and tells so.
Status ATenthMore(const EstimationProblem&, const std::vector<Axis>& axes, const IdentifyOptions& options,
                  Identified& result) {
  for (const Axis& axis : axes)
    result.values.push_back({axis.key, axis.nominal, 1.1 * axis.nominal, std::nullopt, false});
  result.converged = options.starts;
  result.sighting = Sighting{"guess", {{"factors", {1.1}}}, "a tenth more\n"};
  return {};
}

class MethodsOfIdentify : public LumpedLine {
 protected:
  Result<Identified> With(const std::string& method) const {
    const MappedRecord record = LineRecord(blind::IndependentLine(), RandomTorque(500), 1e-3);
    return Identify(*plan_, {record}, registry_, {{{kKey, std::nullopt}}, method});
  }
  static constexpr const char* kKey = "plant.shaft.k4.stiffness_Nm_per_rad";
};

TEST_F(MethodsOfIdentify, AnotherLayerBringsOneAlong) {
  EXPECT_THAT(Methods(), UnorderedElementsAre(Key("corrected"), Key("free_run"), Key("response"), Key("spectrum")));
  const Result<Identified> before = With("guess");
  ASSERT_FALSE(before.ok());
  EXPECT_EQ(before.failure().exit_code, 2);
  EXPECT_THAT(before.failure().message, HasSubstr("guess"));
  AddMethod("guess", {"guesses", ATenthMore});
  AddMethod("guess", {"guesses once more", nullptr});  // which changes nothing
  EXPECT_EQ(Methods().at("guess").help, "guesses");
  const Result<Identified> found = With("guess");
  ASSERT_TRUE(found.ok()) << found.failure().ToString();
  EXPECT_DOUBLE_EQ(found->values.at(0).value, 1.1 * plan_->root.FindPath(kKey)->number());
  EXPECT_GT(found->nrmse_after, 2.0 * found->nrmse_before) << "the plan's numbers are the truth";
  EXPECT_EQ(ToJson(*found)["guess"], (nlohmann::json{{"factors", {1.1}}}));
  EXPECT_THAT(ToTable(*found), HasSubstr("a tenth more\n"));
  const Result<Identified> own = With("free_run");
  ASSERT_TRUE(own.ok()) << own.failure().ToString();
  EXPECT_FALSE(ToJson(*own).contains("guess"));
}

}  // namespace
}  // namespace dynoproof::identification
