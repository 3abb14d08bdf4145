#include "thesis/machine_studies.h"

#include <string>
#include <utility>
#include <vector>

#include "thesis/machine_loop.h"

namespace dynoproof {
namespace {

Result<MachineLoop> LoopOf(double I5_kg_m2, double bandwidth_Hz, bool at_once) {
  return MachineLoop::Create(R2RPlant(I5_kg_m2), VascatDrive(bandwidth_Hz), 0, kHighest_Hz, at_once);
}

/// The growth rate of mode number `mode` (the fastest growing is 0) without filters.
Result<double> BareGrowth(const MachineLoop& loop, double k_V, std::size_t mode) {
  const auto modes = loop.Modes(k_V, {});
  if (!modes.ok()) return modes.failure();
  return (*modes)[mode].growth_per_s;
}

/// The growth rate that the best two filters leave, searched from these frequencies on.
Result<double> HeldGrowth(const MachineLoop& loop, double k_V, std::vector<double> start_Hz) {
  const auto found = FindSteadiestFilters(loop, k_V, std::move(start_Hz));
  if (!found.ok()) return found.failure();
  return found->growth_per_s;
}

/// A growth rate by its name: "second", of the second mode of the simulation at k_V = 9.7, "held", the largest there with
/// the best two filters; "quiet", of Experiment I at k_V = 1, "held_flange", the largest at 4.5 with the best two filters.
Result<double> GrowthOf(const std::string& name, double bandwidth_Hz, bool at_once) {
  const bool simulation = name == "second" || name == "held";
  const Result<MachineLoop> loop = LoopOf(simulation ? 0.081 : 0.311, bandwidth_Hz, at_once);
  if (!loop.ok()) return loop.failure();
  if (name == "second") return BareGrowth(*loop, 9.7, 1);
  if (name == "held") return HeldGrowth(*loop, 9.7, {606.0, 828.0});
  if (name == "quiet") return BareGrowth(*loop, 1.0, 0);
  if (name == "held_flange") return HeldGrowth(*loop, 4.5, {443.0, 438.0});
  return Failure{.message = "no such growth rate: " + name, .signal = "study", .exit_code = 2};
}

Result<Figure> MachineGrowth(const Registry&, const Value& parameters) {
  const Result<double> growth = GrowthOf(parameters.TextOr("of"), parameters.NumberOr("machine_Hz", 150.0), false);
  if (!growth.ok()) return growth.failure();
  return Figure{*growth, "1/s"};
}

/// The bandwidth of the current control at which a growth rate passes zero: each rises with it from 50 to 350 Hz.
/// `at_once`: the voltage acts in the period in which it is computed.
Result<Figure> BandwidthWhereItGrows(const Registry&, const Value& parameters) {
  const Value* told = parameters.Find("at_once");
  const bool at_once = told != nullptr && told->is_bool() && told->boolean();
  double low = 50.0, high = 350.0;
  while (high - low > 0.05) {
    const double middle = 0.5 * (low + high);
    const Result<double> growth = GrowthOf(parameters.TextOr("of"), middle, at_once);
    if (!growth.ok()) return growth.failure();
    (*growth > 0.0 ? high : low) = middle;
  }
  return Figure{0.5 * (low + high), "Hz"};
}

}  // namespace

std::map<std::string, Study, std::less<>> MachineStudies() {
  return {{"machine_bandwidth_edge", BandwidthWhereItGrows}, {"machine_growth", MachineGrowth}};
}

}  // namespace dynoproof
