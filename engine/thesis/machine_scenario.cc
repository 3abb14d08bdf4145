#include "thesis/machine_scenario.h"

#include <algorithm>

#include "plugins/control/rotor_flux_control/rotor_flux_control.h"

namespace dynoproof {
namespace {

Failure Refused(std::string why) { return {.message = std::move(why), .signal = "machine loop", .exit_code = 2}; }

/// What the plant measures for an input of the core: the term of the port that the recorded output shows.
std::optional<OutputTerm> MeasuredFor(const Plan& plan, const Rig& rig, const std::string& core_input) {
  const std::string output = plan.root.TextOr("control.core.inputs." + core_input);
  const Block* plant = rig.FindBlock("plant");
  const int port = rig.FindSlot(plan.root.TextOr(output + ".of")) - plant->first_output;
  if (port < 0 || port >= plant->outputs()) return std::nullopt;
  const std::vector<OutputTerm> terms = plant->component->OutputTerms(port);
  return terms.size() == 1 ? std::optional(terms[0]) : std::nullopt;
}

/// How the machine's torque is spread over the line.
Eigen::VectorXd AirgapWeights(const Rig& rig, Eigen::Index nodes) {
  const Block *plant = rig.FindBlock("plant"), *machine = rig.FindBlock("part.machine");
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(nodes);
  for (std::size_t i = 0; i < plant->inputs.size(); ++i) {
    if (plant->inputs[i] != machine->first_output) continue;  // its first output is the torque
    const std::vector<double> own = plant->component->TorqueWeights(static_cast<int>(i));
    weights += Eigen::Map<const Eigen::VectorXd>(own.data(), nodes);
  }
  return weights;
}

}  // namespace

Result<MachineLoop> MachineLoopOf(const Plan& plan, const Rig& rig, double highest_Hz) {
  const Block* plant = rig.FindBlock("plant");
  const Value* control = plan.root.FindPath("control.machine");
  const bool whole = plant != nullptr && plant->component->network() != nullptr && control != nullptr &&
                     control->TextOr("type") == "rotor_flux_control" && rig.FindBlock("part.machine") != nullptr &&
                     control->TextOr("inputs.torque") == "control.core.T_ref";
  if (!whole)
    return Refused("the scenario is no drive line with an induction machine whose control follows control.core");
  const std::optional<OutputTerm> torque = MeasuredFor(plan, rig, "T_shaft"), speed = MeasuredFor(plan, rig, "omega");
  if (!torque || torque->kind != OutputTerm::Kind::kTorque || !speed || speed->kind != OutputTerm::Kind::kSpeed)
    return Refused("the core is not fed with the torque of a shaft and the speed of an inertia");
  Diagnostics ignored;  // the rig was built from this table
  controls::RotorFluxControl::Params drive;
  if (!ReadParams(*control, drive, ignored, "control", {"type", "inputs", "period_s", "offset_s"}))
    return Refused("control.machine: " + ignored.Format());
  SuppressionPlant loop;
  loop.network = *plant->component->network();
  loop.airgap = AirgapWeights(rig, loop.network.size());
  loop.shaft_edge = torque->index;
  loop.speed_node = speed->index;
  return MachineLoop::Create(loop, drive.Config(rig.run.period_s), 0, highest_Hz);
}

}  // namespace dynoproof
