#include "experiment/moved_modes.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

#include "experiment/golden.h"
#include "linear/modes.h"
#include "model/linear_part.h"

namespace dynoproof {
namespace {

std::optional<Eigen::VectorXd> FrequenciesOf(const Rig& rig) {
  const Block* plant = rig.FindBlock("plant");
  const mechanics::Network* network = plant == nullptr ? nullptr : plant->component->network();
  // Play and friction have a line of their own in each state: its runs show other resonances than the linearised one.
  if (network == nullptr || plant->component->linear_part() == nullptr ||
      !plant->component->linear_part()->channels.empty())
    return std::nullopt;
  const Result<Eigen::VectorXd> frequencies = mechanics::UndampedFrequencies(*network);
  return frequencies.ok() ? std::optional(*frequencies) : std::nullopt;
}

}  // namespace

std::string MovedModes(const Prepared& prepared) {
  constexpr double kMoved = 5e-4;  // relative: what four digits show
  constexpr int kSaid = 4;
  const Result<std::optional<Value>> blessed = BlessedScenario(prepared.golden);
  if (!blessed.ok() || !*blessed) return "";
  Plan plan = prepared.plan;
  plan.root = **blessed;
  Diagnostics ignored;  // what cannot be built says nothing
  const std::unique_ptr<Rig> rig = Rig::Build(plan, *prepared.registry, *prepared.records, ignored);
  if (rig == nullptr || ignored.has_errors()) return "";
  const std::optional<Eigen::VectorXd> was = FrequenciesOf(*rig), is = FrequenciesOf(*prepared.rig);
  if (!was || !is || was->size() != is->size()) return "";
  std::string text;
  int said = 0;
  for (Eigen::Index i = 0; i < was->size() && said < kSaid; ++i) {
    if (!(std::abs((*is)[i] - (*was)[i]) > kMoved * (*was)[i])) continue;
    text += fmt::format("{}from {:.4g} to {:.4g} Hz", said > 0 ? ", " : "modes moved ", (*was)[i], (*is)[i]);
    ++said;
  }
  return text;
}

}  // namespace dynoproof
