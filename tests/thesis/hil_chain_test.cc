// The closed chain of chapter 6: what it comes to without lag and pulses, its books, both solvers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/gas_engine.h"
#include "tests/support/run_plan.h"

namespace dynoproof {
namespace {

using testing::ClosedChain;
using testing::GasEngine;
using testing::Nrmse;
using testing::RunRig;

const std::vector<double>& Of(const Prepared& prepared, const Samples& samples, const char* name) {
  return samples.outputs[static_cast<std::size_t>(FindOutput(*prepared.rig, name))];
}

/// The bed's cylinder with exactly the model's pressures, angle and fuel, and the ideal cycle of hil_load_step for its
/// charge.
const std::vector<std::string> kIdealBed = {"part.cylinder.inputs.angle=\"part.train.angle\"",
                                            "part.cylinder.inputs.speed=\"part.train.speed\"",
                                            "part.cylinder.inputs.charge_pressure=\"plant.charge_pressure\"",
                                            "part.cylinder.inputs.charge_reference=\"plant.charge_pressure\"",
                                            "part.cylinder.inputs.exhaust_pressure=\"plant.exhaust_pressure\"",
                                            "part.cylinder.inputs.exhaust_theta=\"plant.exhaust_theta\"",
                                            "part.cylinder.inputs.exhaust_air=\"plant.exhaust_air\"",
                                            "part.cylinder.inputs.gas_pressure=\"control.gas_reference.reference\"",
                                            "part.sce.inputs.air=\"part.cylinder.trapped_air\"",
                                            "part.sce.inputs.theta=\"part.cylinder.trapped_theta\"",
                                            "part.sce.inputs.pressure=\"part.cylinder.trapped_pressure\"",
                                            "input.p_evo.from=\"part.sce.p_evo\"",
                                            "input.work.from=\"part.sce.work\"",
                                            "control.nox.inputs.nox=\"part.sce.nox\"",
                                            "control.knock.inputs.knock=\"part.sce.knock\"",
                                            "output.air_ratio.of=\"part.sce.air_ratio\""};

/// What hil_load_step has otherwise than the chain: friction, and where it starts.
std::vector<std::string> AsTheEngineAlone(std::vector<std::string> overrides) {
  for (const char* value :
       {"part.train.friction_Nm=4000.0", "part.train.friction_Nms_per_rad=40.0", "control.governor.initial_kg=1.4e-3",
        "control.nox.initial_percent=20.5", "plant.volume.between.start_pressure_Pa=1.31e5",
        "plant.volume.receiver.start_pressure_Pa=1.954e5", "plant.volume.exhaust.start_pressure_Pa=1.692e5",
        "plant.volume.middle.start_pressure_Pa=1.25e5", "plant.turbocharger.low.start_speed_rad_per_s=755.0",
        "plant.turbocharger.high.start_speed_rad_per_s=1605.0"}) {
    overrides.emplace_back(value);
  }
  return overrides;
}

double DropPercent(const std::vector<double>& speed) {
  return 100.0 * (1.0 - *std::min_element(speed.begin() + 50'000, speed.end()) / speed[49'999]);
}

TEST(HilChain, GivesTheEngineAloneBackWithoutLagAndPulses) {
  // hil_load_step is told of every cylinder's charge as its intake closes; a bed has one cylinder, so that its trace comes
  // back as far as it is told of the first one only.
  const auto alone = GasEngine({"run.duration_s=15.0", "plant.trapped_of=\"first\""});
  auto overrides = AsTheEngineAlone(kIdealBed);
  overrides.emplace_back("plant.trapped_of=\"first\"");
  const auto chain = ClosedChain(overrides);
  const Samples expected = RunRig(*alone->rig, "realtime"), ideal = RunRig(*chain->rig, "realtime");
  // What is left is the gas that stays in the cylinder: the bed's own has burnt with walls and in its time, by a dose that
  // the command gave a stroke earlier. 1.6e-2, 7e-3, 6e-3 and 4e-3 are seen.
  EXPECT_LT(Nrmse(Of(*alone, expected, "speed"), Of(*chain, ideal, "speed")), 2e-2);
  EXPECT_LT(Nrmse(Of(*alone, expected, "p_charge"), Of(*chain, ideal, "p_charge")), 1e-2);
  EXPECT_LT(Nrmse(Of(*alone, expected, "p_exhaust"), Of(*chain, ideal, "p_exhaust")), 1e-2);
  EXPECT_LT(Nrmse(Of(*alone, expected, "power"), Of(*chain, ideal, "power")), 5e-3);
  EXPECT_NEAR(DropPercent(Of(*chain, ideal, "speed")), DropPercent(Of(*alone, expected, "speed")), 0.03);
  // And being told once a cycle alone makes the drop deeper: from 1.39 to 1.6 %.
  const auto each = GasEngine({"run.duration_s=15.0"});
  EXPECT_GT(DropPercent(Of(*alone, expected, "speed")),
            DropPercent(Of(*each, RunRig(*each->rig, "realtime"), "speed")) + 0.1);
}

double MeanBetween(const std::vector<double>& values, double from_s, double to_s) {
  double sum = 0.0;
  const auto from = static_cast<std::size_t>(from_s * 1e4), to = static_cast<std::size_t>(to_s * 1e4);
  for (std::size_t k = from; k < to; ++k) sum += values[k];
  return sum / static_cast<double>(to - from);
}

TEST(HilChain, IsTheFullEngineButForTidingsOnceACycle) {
  // Today's trace, in which each cylinder tells of its charge, ten times a cycle; a bed has one cylinder.
  const auto each = GasEngine({"run.duration_s=15.0"});
  const auto chain = ClosedChain(AsTheEngineAlone(kIdealBed));
  const Samples today = RunRig(*each->rig, "realtime"), ideal = RunRig(*chain->rig, "realtime");
  // Where nothing moves faster than a cycle both are the same: before the step and in the end.
  for (const double from_s : {4.0, 14.0}) {
    for (const auto& [name, off] : {std::pair("speed", 1e-5), std::pair("power", 1e-5), std::pair("p_charge", 2e-3),
                                    std::pair("p_exhaust", 2e-3)}) {
      EXPECT_NEAR(MeanBetween(Of(*chain, ideal, name), from_s, from_s + 1.0) /
                      MeanBetween(Of(*each, today, name), from_s, from_s + 1.0),
                  1.0, off)
          << name << " " << from_s;
    }
  }
  // Over all of it: 3.5e-2, 4.2e-3, 1.4e-2 and 1.5e-2 are seen, 0.06 rad/s and 12 hPa at most behind the first cycle.
  for (const auto& [name, off] : {std::pair("speed", 5e-2), std::pair("power", 6e-3), std::pair("p_charge", 2e-2),
                                  std::pair("p_exhaust", 2e-2)}) {
    EXPECT_LT(Nrmse(Of(*each, today, name), Of(*chain, ideal, name)), off) << name;
  }
  // In between the speed drops by a fiftieth of a per cent more: what is told is up to a cycle old. Today's trace is the limit
  // of an age that goes to 0: told a period T to 2 T later, the engine alone drops by more with each T, and by more than
  // with the bed at the latest with the mean age of a cycle. (`GivesTheEngineAloneBack`: where the governor, too, hears of one
  // cylinder only, its limit of the air ratio makes the drop 1.6 %.)
  double drop = DropPercent(Of(*each, today, "speed"));
  const double bed = DropPercent(Of(*chain, ideal, "speed"));
  EXPECT_GT(bed, drop);
  EXPECT_LT(bed, drop + 0.03);
  for (const double period_s : {0.01, 0.02, 0.04}) {
    const auto later = GasEngine({"run.duration_s=8.0",
                                  fmt::format("control.late={{type=\"indication\", period_s={}, "
                                              "inputs={{p_evo=\"part.sce.p_evo\", work=\"part.sce.work\"}}}}",
                                              period_s),
                                  "input.p_evo.from=\"control.late.p_evo\"", "input.work.from=\"control.late.work\""});
    const double own = DropPercent(Of(*later, RunRig(*later->rig, "realtime"), "speed"));
    EXPECT_GT(own, drop) << period_s;
    drop = own;
  }
  EXPECT_GT(drop, bed);
}

TEST(HilChain, TrapsTheChargeOfTheFirstCylinderToTheLastDigits) {
  // Before anything has burnt: the same valves, walls and pipes.
  auto overrides = AsTheEngineAlone(kIdealBed);
  for (const char* more :
       {"run.duration_s=0.05", "plant.trapped_of=\"first\"", "output.bank={of=\"plant.trapped_air\"}",
        "output.bed={of=\"part.cylinder.trapped_air\"}", "output.bank_p={of=\"plant.trapped_pressure\"}",
        "output.bed_p={of=\"part.cylinder.trapped_pressure\"}"}) {
    overrides.emplace_back(more);
  }
  const auto chain = ClosedChain(overrides);
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunRig(*chain->rig, solver);
    const std::vector<double>&bank = Of(*chain, samples, "bank"), &bed = Of(*chain, samples, "bed");
    ASSERT_NE(bank.front(), bank.back()) << "its intake closed";
    EXPECT_NEAR(bed.back() / bank.back(), 1.0, 1e-9) << solver;
    EXPECT_NEAR(Of(*chain, samples, "bed_p").back() / Of(*chain, samples, "bank_p").back(), 1.0, 1e-9) << solver;
  }
}

TEST(HilChain, IsWithoutEffectOnAModelThatDoesNotListen) {
  // With the synthetic cylinder for the model's own charge in its place: today's trace to the last bit.
  std::vector<std::string> overrides =
      AsTheEngineAlone({"input.p_evo.from=\"part.sce.p_evo\"", "input.work.from=\"part.sce.work\"",
                        "control.nox.inputs.nox=\"part.sce.nox\"", "control.knock.inputs.knock=\"part.sce.knock\"",
                        "run.duration_s=6.0"});
  const auto chain = ClosedChain(overrides);
  const auto alone = GasEngine({"run.duration_s=6.0"});
  const Samples expected = RunRig(*alone->rig, "realtime"), seen = RunRig(*chain->rig, "realtime");
  for (const char* name : {"speed", "power", "p_charge", "p_exhaust", "theta_exhaust"}) {
    EXPECT_EQ(Of(*alone, expected, name), Of(*chain, seen, name)) << name;
  }
}

TEST(HilChain, KeepsItsBooksInBothSolversAndSeesAFlowThatIsLost) {
  const auto chain = ClosedChain({"run.duration_s=1.0"});
  for (const char* solver : {"realtime", "reference"}) {
    const Samples samples = RunRig(*chain->rig, solver);
    for (const char* books : {"bed_mass", "bed_energy", "mass_balance", "energy_balance"}) {
      for (const double value : Of(*chain, samples, books)) ASSERT_LT(std::abs(value), 1e-11) << solver << books;
    }
    for (const double value : Of(*chain, samples, "bed_shaft")) ASSERT_LT(std::abs(value), 1e-9) << solver;
  }
  // Exhaust that is not handed on, and a leak of a square millimetre in the charge pipe.
  const auto lost = ClosedChain({"run.duration_s=1.0", "part.exhaust.inputs.air_flow=\"input.nothing\""});
  EXPECT_GT(std::abs(Of(*lost, RunRig(*lost->rig, "realtime"), "bed_mass").back()), 1e-6);
  const auto leaks = ClosedChain({"run.duration_s=1.0", "part.air.volume.V_1.leakage_area_m2=1e-6"});
  EXPECT_GT(std::abs(Of(*leaks, RunRig(*leaks->rig, "realtime"), "bed_mass").back()), 1e-5);
}

}  // namespace
}  // namespace dynoproof
