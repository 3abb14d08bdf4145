#include "experiment/analysis.h"

#include <fmt/format.h>

#include <algorithm>

#include "experiment/checks.h"
#include "model/section.h"

namespace dynoproof {

std::optional<AnalysisSettings> ReadAnalysis(const Plan& plan, const Rig& rig, Diagnostics& diagnostics) {
  const Value* table = SectionTable(plan, "analysis", "write [analysis]", diagnostics);
  AnalysisSettings settings;
  if (table == nullptr || !ReadParams(*table, settings, diagnostics, "analysis")) return std::nullopt;
  Faults faults(*table, diagnostics, "analysis");
  const int before = diagnostics.error_count();
  const auto suggest = [](const std::string& word, const auto& lines) {
    std::vector<std::string> names;
    for (const auto& line : lines) names.push_back(line.name);
    const std::optional<std::string> near = Closest(word, names);
    return near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("known: {}", fmt::join(names, ", "));
  };
  if (FindInput(rig, settings.input) < 0) {
    faults.At("input", fmt::format("there is no input \"{}\"", settings.input), suggest(settings.input, rig.inputs));
  }
  if (FindOutput(rig, settings.output) < 0) {
    faults.At("output", fmt::format("there is no output \"{}\"", settings.output),
              suggest(settings.output, rig.outputs));
  }
  if (settings.to_Hz <= settings.from_Hz) faults.At("to_Hz", "must lie above from_Hz");
  if (diagnostics.error_count() != before) return std::nullopt;
  return settings;
}

Result<mechanics::TransferFunction> TransferOf(const Rig& rig, const AnalysisSettings& settings) {
  const auto refuse = [&rig](std::string why) {
    return Failure{.message = std::move(why), .signal = rig.id, .exit_code = 2};
  };
  const Block* plant = rig.FindBlock("plant");
  const mechanics::Network* network = plant == nullptr ? nullptr : plant->component->network();
  if (network == nullptr) return refuse("the plant is no drive line: it has no modes");

  // The way from the input's command through its actuator stages to a torque entry of the plant.
  const InputLine& input = rig.inputs[FindInput(rig, settings.input)];
  std::vector<int> reached = {input.command, input.delayed};
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(network->size());
  for (const Block& block : rig.blocks) {
    for (std::size_t i = 0; i < block.inputs.size(); ++i) {
      if (std::find(reached.begin(), reached.end(), block.inputs[i]) == reached.end()) continue;
      if (&block == plant) {
        const std::vector<double> own = plant->component->TorqueWeights(static_cast<int>(i));
        weights += Eigen::Map<const Eigen::VectorXd>(own.data(), network->size());
      } else if (block.name.starts_with("input." + input.name + ".")) {
        reached.push_back(block.first_output);
      }
    }
  }
  if (weights.isZero()) return refuse(fmt::format("input \"{}\" does not reach the drive line", settings.input));

  // Back from the output through its sensor stages to a port of the plant.
  const OutputLine& output = rig.outputs[FindOutput(rig, settings.output)];
  int slot = output.signal;
  for (auto block = rig.blocks.rbegin(); block != rig.blocks.rend(); ++block) {
    if (block->first_output == slot && block->name.starts_with("output." + output.name + ".")) slot = block->inputs[0];
  }
  const int port = slot - plant->first_output;
  const std::vector<OutputTerm> terms =
      port >= 0 && port < plant->outputs() ? plant->component->OutputTerms(port) : std::vector<OutputTerm>{};
  if (terms.size() != 1)
    return refuse(fmt::format("output \"{}\" is no single signal of the drive line", settings.output));
  mechanics::OutputKind kind;
  switch (terms[0].kind) {
    case OutputTerm::Kind::kTorque:
      kind = mechanics::OutputKind::kEdgeTorque;
      break;
    case OutputTerm::Kind::kSpeed:
      kind = mechanics::OutputKind::kSpeed;
      break;
    case OutputTerm::Kind::kAngle:
      kind = mechanics::OutputKind::kAngle;
      break;
    default:
      return refuse(fmt::format("output \"{}\" is a twist: analyse the torque instead", settings.output));
  }
  return mechanics::TransferFunction::Build(*network, weights, {kind, terms[0].index});
}

namespace {

/// Shafts that the linearised line does not have: a law without a linear part (a clutch, a cubic spring) is open in it.
std::vector<std::string> OpenShafts(const mechanics::Network& network) {
  std::vector<std::string> notes;
  for (const mechanics::Edge& edge : network.edges) {
    if (edge.to == mechanics::kGround || edge.stiffness > 0.0 || edge.damping > 0.0) continue;
    notes.push_back(
        fmt::format("shaft \"{}\" has no linear part: modes and zeros are those of the line with it open, "
                    "as if it transmitted nothing",
                    edge.name));
  }
  return notes;
}

}  // namespace

std::string ElementOf(const std::string& name) { return name.substr(0, name.find_first_of("[(")); }

std::vector<std::pair<std::string, double>> EnergyByElement(const mechanics::Network& network,
                                                            const mechanics::Mode& mode) {
  std::vector<std::pair<std::string, double>> shares;
  const auto add = [&shares](const std::string& element, double share) {
    const auto it = std::find_if(shares.begin(), shares.end(), [&](const auto& one) { return one.first == element; });
    if (it == shares.end()) {
      shares.emplace_back(element, share);
    } else {
      it->second += share;
    }
  };
  for (int i = 0; i < network.size(); ++i) add(ElementOf(network.nodes[i].name), mode.kinetic[i]);
  for (std::size_t e = 0; e < network.edges.size(); ++e) {
    add(ElementOf(network.edges[e].name), mode.strain[static_cast<Eigen::Index>(e)]);
  }
  return shares;
}

Result<LinearAnalysis> Analyse(const Rig& rig, const AnalysisSettings& settings) {
  const Result<mechanics::TransferFunction> transfer = TransferOf(rig, settings);
  if (!transfer.ok()) return transfer.failure();
  const mechanics::Network* network = rig.FindBlock("plant")->component->network();
  Result<mechanics::ModalAnalysis> modal = mechanics::Modes(*network);
  if (!modal.ok()) return modal.failure();
  auto resonances = mechanics::PracticalResonances(*transfer, settings.from_Hz, settings.to_Hz);
  if (!resonances.ok()) return resonances.failure();
  LinearAnalysis analysis{network, std::move(*modal), std::move(*resonances), {}, {}, OpenShafts(*network)};
  auto zeros = mechanics::TransferZeros(*network, transfer->input(), transfer->output());
  if (zeros.ok()) {
    analysis.zeros = std::move(*zeros);
  } else if (zeros.failure().exit_code == 2) {  // the line and its modes are sound: the output is not reached
    analysis.no_zeros = zeros.failure().message;
  } else {
    return zeros.failure();
  }
  return analysis;
}

}  // namespace dynoproof
