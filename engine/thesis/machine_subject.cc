#include "thesis/machine_subject.h"

#include <algorithm>
#include <cmath>

#include "base/within.h"
#include "thesis/machine_loop.h"

namespace dynoproof::campaign {
namespace {

/// One setup of the test bed with the machine.
class Setup {
 public:
  Setup(double I5_kg_m2, const MachineStudy::Parameters& parameters)
      : radius_(parameters.radius),
        loop_(MachineLoop::Create(R2RPlant(I5_kg_m2), VascatDrive(parameters.current_bandwidth_Hz),
                                  parameters.delay_samples, kHighest_Hz)) {}

  Result<std::vector<FilteredLoopMode>> Modes(double k_V) const {
    if (!loop_.ok()) return loop_.failure();
    return loop_->Modes(k_V, {});
  }
  /// The largest growth with the best filters from these on.
  Result<double> Held(double k_V, std::vector<double> start_Hz) const {
    if (!loop_.ok()) return loop_.failure();
    const Result<SteadiestFilters> found = FindSteadiestFilters(*loop_, k_V, std::move(start_Hz), radius_);
    if (!found.ok()) return found.failure();
    return found->growth_per_s;
  }

 private:
  double radius_;
  Result<MachineLoop> loop_;
};

/// Growth of the mode nearest to a frequency.
double GrowthNear(const std::vector<FilteredLoopMode>& modes, double f_Hz) {
  return std::ranges::min_element(modes, {}, [f_Hz](const auto& mode) { return std::abs(mode.frequency_hz - f_Hz); })
      ->growth_per_s;
}

}  // namespace

const std::vector<FigureInfo>& MachineStudy::Figures() {
  static const std::vector<FigureInfo> figures = {
      {"growing", "1"},  {"first", "1/s"},  {"second", "1/s"}, {"held", "1/s"},   {"quiet_1", "1/s"}, {"loud_1", "1/s"},
      {"held_1", "1/s"}, {"loud_2", "1/s"}, {"held_2", "1/s"}, {"edge_3", "1/s"}, {"held_3", "1/s"}};
  return figures;
}

void MachineStudy::Fill(const Parameters& parameters, std::uint64_t, Row& row) {
  const Setup simulation(0.081, parameters), flange(0.311, parameters), device(0.171, parameters);
  const auto at_9_7 = simulation.Modes(9.7), quiet = flange.Modes(1.0), loud = flange.Modes(4.5),
             run = device.Modes(4.3), usual = device.Modes(2.1);
  for (const auto* modes : {&at_9_7, &quiet, &loud, &run, &usual}) {
    if (modes->ok()) continue;
    row.why = modes->failure().ToString();
    return;
  }
  const double f_1 = loud->front().frequency_hz, f_2 = run->front().frequency_hz, f_3 = usual->front().frequency_hz;
  // Where one mode grows and two filters are at hand, the second takes what the first moves away: 5 Hz below.
  const Result<double> held = simulation.Held(9.7, {606.0, 828.0}), held_1 = flange.Held(4.5, {f_1, f_1 - 5.0}),
                       held_2 = device.Held(4.3, {f_2, f_2 - 5.0}), held_3 = device.Held(2.1, {f_3});
  for (const Result<double>* growth : {&held, &held_1, &held_2, &held_3}) {
    if (growth->ok()) continue;
    row.why = growth->failure().ToString();
    return;
  }
  const auto growing = static_cast<double>(
      std::ranges::count_if(*at_9_7, [](const FilteredLoopMode& mode) { return mode.growth_per_s > 0.0; }));
  const double quiet_1 = quiet->front().growth_per_s, loud_1 = loud->front().growth_per_s,
               loud_2 = run->front().growth_per_s, edge_3 = usual->front().growth_per_s;
  row.figures = {growing,
                 GrowthNear(*at_9_7, 606.0),
                 GrowthNear(*at_9_7, 828.0),
                 *held,
                 quiet_1,
                 loud_1,
                 *held_1,
                 loud_2,
                 *held_2,
                 edge_3,
                 *held_3};
  std::string& why = row.why;
  const auto demand = [&why](bool holds, const char* what) {
    if (!holds) why += (why.empty() ? "" : ", ") + std::string(what);
  };
  demand(growing == 2.0 && *held < 0.0, "not Sec. 5.6.1");
  demand(quiet_1 < 0.0 && loud_1 > 0.0 && *held_1 < 0.0, "not Experiment I");
  demand(loud_2 > 0.0 && *held_2 < 0.0, "not Experiment II");
  demand(edge_3 > 0.0 && *held_3 < 0.0, "not Experiment III");
  row.verdict = why.empty() ? score::Verdict::kPass : score::Verdict::kFail;
}

}  // namespace dynoproof::campaign
