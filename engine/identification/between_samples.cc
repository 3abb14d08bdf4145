#include "identification/between_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "estimation/horizon.h"

namespace dynoproof::identification {
namespace {

constexpr double kClearly = 0.5;
/// Share of the NRMSE with held inputs that another course must stay below to be taken. The error of a model and that of half a sample
/// are hardly correlated, so that their squares add: the smallest NRMSE belongs to the likeliest course, however wrong the
/// model. Differences of less than a tenth may come from noise.
constexpr double kBetter = 0.9;
constexpr double kFar = 100.0;  // NRMSE: the run beside the record diverges

}  // namespace

std::vector<std::string> UnstatedInputs(const Plan& plan, const MappedRecord& record) {
  std::vector<std::string> inputs;
  for (const auto& [name, series] : record.inputs) {
    const bool said = record.between.contains(name) && !record.guessed.contains(name);
    const bool stated = said || plan.root.FindPath("input." + name + ".source.interpolation") != nullptr;
    if (!stated) inputs.push_back(name);
  }
  return inputs;
}

MappedRecord WithBetween(MappedRecord record, const Plan& plan, const std::string& between) {
  for (const std::string& name : UnstatedInputs(plan, record))
    record.between[name] = between, record.guessed.insert(name);
  return record;
}

std::vector<std::string> PossibleBetween(const Plan& plan, const MappedRecord& record) {
  const std::vector<std::string> inputs = UnstatedInputs(plan, record);
  const bool equal =
      std::all_of(inputs.begin(), inputs.end(), [&](const std::string& name) { return record.step_s.contains(name); });
  return equal ? std::vector<std::string>{"held", "linear", "band_limited", "band_limited_held"}
               : std::vector<std::string>{"held", "linear"};
}

std::vector<BetweenFit> CompareBetween(const Plan& plan, const Registry& registry, const MappedRecord& record) {
  std::vector<BetweenFit> fits;
  if (UnstatedInputs(plan, record).empty() || record.outputs.empty()) return fits;
  for (const std::string& between : PossibleBetween(plan, record)) {
    const Result<std::optional<estimation::HorizonLevel>> level =
        estimation::ShortestLevelOf(plan, WithBetween(record, plan, between), registry);
    if (!level.ok() || !*level) continue;  // a fit that needs it says why
    fits.push_back({between, (*level)->GeometricMean()});
  }
  return fits;
}

bool IsClear(const std::vector<BetweenFit>& fits, const std::string& between) {
  const auto own =
      std::find_if(fits.begin(), fits.end(), [&](const BetweenFit& fit) { return fit.between == between; });
  return own != fits.end() && std::all_of(fits.begin(), fits.end(), [&](const BetweenFit& fit) {
           return fit.between == between || own->nrmse < kClearly * fit.nrmse;
         });
}

void ChooseBetween(const Plan& plan, const Registry& registry, MappedRecord& record) {
  const std::vector<BetweenFit> fits = CompareBetween(plan, registry, record);
  if (fits.empty()) return;
  const auto [best, worst] = std::ranges::minmax_element(fits, {}, &BetweenFit::nrmse);
  const BetweenFit& taken = best->nrmse < kBetter * fits.front().nrmse ? *best : fits.front();
  record = WithBetween(std::move(record), plan, taken.between);
  if (best->nrmse > kBetter * worst->nrmse) return;
  std::string distances;
  for (const BetweenFit& fit : fits)
    distances += fmt::format("{}{} {}", distances.empty() ? "" : ", ", fit.between,
                             fit.nrmse < kFar ? fmt::format("{:.3g}", fit.nrmse) : "far");
  record.notes.push_back(fmt::format(
      "between their samples the inputs are taken as {}, which neither file nor map says: corrected by the record with "
      "a short memory the outputs are off by (NRMSE) {}; if you know it, say between = ... of each input in a map",
      taken.between, distances));
}

}  // namespace dynoproof::identification
