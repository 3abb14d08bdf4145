// Which effect would remove how much, on records of a line of four masses that the engine makes.
#include "diagnosis/prospects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

using estimation::FourMasses;
using estimation::RecordOf;
using estimation::WithEffect;

Prospects Of(const Plan& truth) {
  const MappedRecord record = RecordOf(truth, 0.01, {"T_shaft", "omega_1", "omega_4"});
  const Result<Prospects> prospects = ProspectsOf(FourMasses(0.7), {record}, testing::BuiltIns());
  EXPECT_TRUE(prospects.ok()) << prospects.failure().ToString();
  return prospects.ok() ? *prospects : Prospects();
}

/// Of a record in which nothing is hidden.
const Prospects& Clean() {
  static const Prospects clean = Of(FourMasses(0.7));
  return clean;
}

const Prospect& Find(const Prospects& all, const std::string& name, const std::string& at) {
  static const Prospect none;
  const auto found =
      std::ranges::find_if(all.all, [&](const Prospect& one) { return one.name == name && one.at == at; });
  if (found == all.all.end()) ADD_FAILURE() << name << " at " << at << " is none of " << all.all.size();
  return found != all.all.end() ? *found : none;
}

TEST(Prospects, TheCauseRemovesMostAtAboutItsSize) {
  const Prospects all = Of(WithEffect(FourMasses(0.7), "coulomb_friction", "inertia:I3", {12.0}));
  ASSERT_TRUE(all.excess);
  const Prospect& cause = Find(all, "coulomb_friction", "inertia:I3");
  EXPECT_EQ(&cause, &all.all.front()) << all.ToTable();
  EXPECT_GT(cause.removes, 0.5);
  EXPECT_EQ(cause.unit, "N m");
  EXPECT_NEAR(cause.strength, 12.0, 4.0);  // linear about a size that one run has given
  EXPECT_LT(cause.smallest, 3.0);
  // A number that the line's own nominal values stand for removes little.
  EXPECT_LT(Find(all, "inertia_change", "inertia:I1").removes, 0.3);
  // Two masses behind stiff shafts move alike at these memories.
  const Prospect& first = Find(all, "coulomb_friction", "inertia:I1");
  EXPECT_NE(std::ranges::find(first.alike, "coulomb_friction@inertia:I2"), first.alike.end()) << all.ToTable();
  EXPECT_LT(all.simulations, 8 * static_cast<std::int64_t>(all.all.size()));
}

TEST(Prospects, OfTwoCausesThePairRemovesMost) {
  const Plan truth = WithEffect(WithEffect(FourMasses(0.7), "coulomb_friction", "inertia:I3", {40.0}), "actuator_lag",
                                "input:T", {2e-4});
  const Prospects all = Of(truth);
  ASSERT_FALSE(all.pairs.empty()) << all.ToTable();
  const ProspectPair& best = all.pairs.front();
  // A lag of the command and one of the shaft's torque look alike on a line that is stiffer than they are fast.
  EXPECT_TRUE(best.first == "actuator_lag@input:T" || best.first == "sensor_lag@output:T_shaft") << all.ToTable();
  EXPECT_TRUE(best.second.ends_with("friction@inertia:I3")) << all.ToTable();
  EXPECT_GT(best.removes, all.all.front().removes + 0.02);
}

TEST(Prospects, WhatWouldShowIsSeenAboveAndNotBelow) {
  ASSERT_FALSE(Clean().excess) << Clean().ToTable();
  const double smallest = Find(Clean(), "coulomb_friction", "inertia:I3").smallest;
  ASSERT_TRUE(std::isfinite(smallest));
  const auto removed_at = [&](double strength) {
    const Prospects all = Of(WithEffect(FourMasses(0.7), "coulomb_friction", "inertia:I3", {strength}));
    return Find(all, "coulomb_friction", "inertia:I3").removes;
  };
  // What noise alone lets a candidate remove lies far below what one of three times the smallest size does.
  EXPECT_GT(removed_at(3.0 * smallest), 4.0 * removed_at(0.1 * smallest));
}

TEST(Prospects, ANumberWithinItsPriorIsNoCandidateForACause) {
  EXPECT_GE(Find(Clean(), "stiffness_change", "shaft:k3").smallest, 0.03);  // three of its deviations of 1 %
}

}  // namespace
}  // namespace dynoproof::diagnosis
