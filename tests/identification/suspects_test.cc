// Records that are not what they are taken for, each named for what it is; and sound ones, of which nothing is said.
#include "identification/suspects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "experiment/checks.h"
#include "identification/bring_in.h"
#include "identification/identify.h"
#include "scenario/load.h"
#include "tests/identification/made_record.h"
#include "tests/identification/three_masses.h"
#include "tests/support/temp_dir.h"

namespace dynoproof::identification {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Suspects : public testing::Test {
 protected:
  Suspects() {
    RegisterBuiltIns(registry_);
    RegisterChecks(registry_);
    Diagnostics diagnostics;
    plan_ = LoadPlan(folder_.Write("line.toml", kThreeMasses).string(), {}, diagnostics);
    rows_ = RunThreeMasses(Chirp(600, 1e-3, 1), 1e-3);
  }

  /// The rows as a record, with white noise of `noise` of each output's spread.
  MappedRecord Record(double noise, std::uint64_t seed = 1) {
    MappedRecord record;
    const auto time = Shared(rows_.t);
    record.inputs["T_airgap"] = {time, Shared(rows_.T_airgap)};
    record.outputs["T_shaft"] = {time, Noisy(rows_.T_shaft, noise, 2 * seed)};
    record.outputs["omega_1"] = {time, Noisy(rows_.omega_1, noise, 2 * seed + 1)};
    for (const char* name : {"T_airgap", "T_shaft", "omega_1"}) record.step_s[name] = 1e-3;
    record.between["T_airgap"] = "held";
    record.end_s = time->back();
    Diagnostics diagnostics;
    EXPECT_TRUE(BringIn(*plan_, registry_, record, diagnostics));
    return record;
  }

  /// What a fit of the record says it may be.
  std::vector<std::string> Said(const MappedRecord& record) {
    const IdentifyOptions options = {
        {{"plant.inertia.I3", {}}, {"plant.shaft.k1.stiffness_Nm_per_rad", {}}}, "free_run", 1, [](double) {}};
    const Result<Identified> found = Identify(*plan_, {record}, registry_, options);
    EXPECT_TRUE(found.ok());
    if (!found.ok()) return {"failed"};
    return WhatItMayBe(*plan_, {record}, registry_, options, *found);
  }

  static void Scale(std::vector<double>& values, double factor) {
    for (double& value : values) value *= factor;
  }

  test::TempDir folder_;
  Registry registry_;
  std::optional<Plan> plan_;
  Rows rows_;
};

TEST_F(Suspects, ATorqueOfKilonewtonMetres) {
  const Rows sound = rows_;
  Scale(rows_.T_airgap, 1e-3);
  EXPECT_THAT(Said(Record(0.01)), Contains(AllOf(HasSubstr("T_airgap"), HasSubstr("about 1000: a prefix"))));
  rows_ = sound;
  Scale(rows_.T_shaft, 1e-3);
  EXPECT_THAT(Said(Record(0.01)), Contains(AllOf(HasSubstr("T_shaft"), HasSubstr("about 1000: a prefix"))));
}

TEST_F(Suspects, SignalsThatAreExchanged) {
  const Rows sound = rows_;
  std::swap(rows_.T_airgap, rows_.T_shaft);
  EXPECT_THAT(Said(Record(0.0)), Contains(HasSubstr("T_airgap and T_shaft exchanged")));
  rows_ = sound;
  std::swap(rows_.T_airgap, rows_.omega_1);
  EXPECT_THAT(Said(Record(0.0)), Contains(HasSubstr("T_airgap and omega_1 exchanged")));
  rows_ = sound;
  std::swap(rows_.T_shaft, rows_.omega_1);
  EXPECT_THAT(Said(Record(0.0)), Contains(HasSubstr("T_shaft and omega_1 exchanged")));
}

TEST_F(Suspects, VoltsForNewtons) {
  Scale(rows_.T_shaft, 0.037);
  // Noise of 0.14 spreads: a correlation of 0.99.
  EXPECT_THAT(Said(Record(0.14)), Contains(AllOf(HasSubstr("T_shaft 2"), HasSubstr("volts of a sensor?"))));
}

TEST_F(Suspects, AnOutputWithTheOtherSign) {
  Scale(rows_.T_shaft, -1.0);
  EXPECT_THAT(Said(Record(0.01)), Contains(HasSubstr("T_shaft with the other sign")));
}

TEST(CauseOfFactor, IsOneThatTheUnitCanHave) {
  EXPECT_THAT(CauseOfFactor(30.0 / std::numbers::pi, "rad/s").value_or(""), HasSubstr("1/min and rad/s"));
  EXPECT_THAT(CauseOfFactor(1.0 / 3.6, "m/s").value_or(""), HasSubstr("km/h and m/s"));
  EXPECT_THAT(CauseOfFactor(60.0, "kg/s").value_or(""), HasSubstr("minutes and seconds"));
  EXPECT_THAT(CauseOfFactor(1000.0, "N").value_or(""), HasSubstr("kilo or milli"));
  EXPECT_FALSE(CauseOfFactor(180.0 / std::numbers::pi, "m/s"));
  EXPECT_FALSE(CauseOfFactor(60.0, "N m"));
}

TEST_F(Suspects, ARecordOfPureInvention) {
  const Rows sound = rows_;
  for (std::size_t i = 0; i < rows_.t.size(); ++i) {
    rows_.T_shaft[i] = 25.0 * RandomNormal(7, 1, i);
    rows_.omega_1[i] = 0.2 * RandomNormal(7, 2, i);
  }
  EXPECT_THAT(Said(Record(0.0)), ElementsAre(HasSubstr("no output is like what the fitted scenario makes")));
  rows_ = sound;
  for (std::size_t i = 0; i < rows_.t.size(); ++i) {
    rows_.T_shaft[i] = 25.0 * std::sin(2.0 * std::numbers::pi * 13.0 * rows_.t[i]);
    rows_.omega_1[i] = 0.2 * std::sin(2.0 * std::numbers::pi * 29.0 * rows_.t[i]);
  }
  EXPECT_THAT(Said(Record(0.0)), ElementsAre(HasSubstr("no output is like what the fitted scenario makes")));
}

TEST_F(Suspects, NothingIsSaidOfSoundRecords) {
  const Rows sound = rows_;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    // Noise up to three tenths of the spread, and a gain that a calibration may well be off by.
    rows_ = sound;
    Scale(rows_.T_shaft, 1.0 + 0.1 * (RandomUniform(seed, 1, 0) - 0.5));
    EXPECT_THAT(Said(Record(0.3 * RandomUniform(seed, 2, 0), seed)), IsEmpty()) << seed;
  }
}

}  // namespace
}  // namespace dynoproof::identification
