// A changed inertia moves the modes of the golden scenario: the frequencies are those of `modes` before and after.
#include "experiment/moved_modes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/check_bed.h"

namespace dynoproof {
namespace {

std::string Moved(const std::string& scenario, const std::vector<std::string>& changes) {
  PrepareOptions options;
  options.overrides = changes;
  Diagnostics diagnostics;
  const std::unique_ptr<Prepared> prepared = Prepare(scenario, options, testing::FullRegistry(), diagnostics);
  EXPECT_NE(prepared, nullptr) << diagnostics.Format(false);
  return prepared == nullptr ? "" : MovedModes(*prepared);
}

TEST(MovedModes, OfAnInertiaThatChanged) {
  const std::string line = "scenarios/r2r/soft_rotor_setup_1.toml";
  EXPECT_EQ(Moved(line, {}), "");
  EXPECT_THAT(Moved(line, {"plant.inertia.I4=0.15"}),
              ::testing::StartsWith("modes moved from 605.1 to 599.1 Hz, from 832.2 to 823.6 Hz"));
}

TEST(MovedModes, AreNoneOfAPlantWithoutModes) {
  EXPECT_EQ(Moved("scenarios/backlash/clamped.toml", {"plant.shaft.k7.stiffness_Nm_per_rad=30000"}), "")
      << "it has play";
  EXPECT_EQ(Moved("scenarios/pressure/charge_air_proposed.toml", {"control.proposed.volumetric_efficiency=0.8"}), "");
}

}  // namespace
}  // namespace dynoproof
