#include "identification/response_objective.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>

#include "experiment/analysis.h"
#include "experiment/prepare.h"
#include "linear/dense.h"

namespace dynoproof::identification {
namespace {

Result<AnalysisSettings> SettingsOf(const Plan& plan, const Rig& rig) {
  Diagnostics diagnostics;
  const std::optional<AnalysisSettings> settings = ReadAnalysis(plan, rig, diagnostics);
  if (settings) return *settings;
  return Failure{.message = "a frequency response needs [analysis] with an input and an output of a drive line",
                 .signal = plan.id,
                 .exit_code = 2};
}

Failure CannotBuild(const Plan& plan, const Diagnostics& diagnostics) {
  const std::string why = diagnostics.items().empty() ? "" : ": " + diagnostics.items().front().message;
  return {.message = "the model cannot be built with these numbers" + why, .signal = plan.id, .exit_code = 2};
}

/// The model's frequency response, and the band in which it is looked at.
struct Modelled {
  AnalysisSettings settings;
  mechanics::TransferFunction transfer;
};

Result<Modelled> ModelOf(const Plan& plan, const Registry& registry) {
  Diagnostics diagnostics;
  const std::unique_ptr<Prepared> prepared = Prepare(plan, {}, registry, diagnostics);
  if (prepared == nullptr) return CannotBuild(plan, diagnostics);
  const Result<AnalysisSettings> settings = SettingsOf(plan, *prepared->rig);
  if (!settings.ok()) return settings.failure();
  Result<mechanics::TransferFunction> transfer = TransferOf(*prepared->rig, *settings);
  if (!transfer.ok()) return transfer.failure();
  return Modelled{*settings, *std::move(transfer)};
}

/// G(2 pi j f). Small networks by a dense factorisation: it is quick where there are meshes, and what it loses far
/// beyond the modes does not count here.
std::complex<double> ResponseAt(const mechanics::TransferFunction& model, double hz) {
  constexpr int kSmall = 12;
  const mechanics::Network& network = model.network();
  if (network.size() > kSmall) return model.AtFrequency(hz);
  const std::complex<double> s(0.0, 2.0 * std::numbers::pi * hz);
  Eigen::MatrixXcd matrix = network.StiffnessMatrix() + s * network.DampingMatrix();
  matrix.diagonal() += s * s * network.Inertias();
  const Eigen::VectorXcd angles = dense::ComplexSolve(matrix, model.input().cast<std::complex<double>>());
  const int index = model.output().index;
  if (model.output().kind == mechanics::OutputKind::kAngle) return angles[index];
  if (model.output().kind == mechanics::OutputKind::kSpeed) return s * angles[index];
  const mechanics::Edge& edge = network.edges[static_cast<std::size_t>(index)];
  const std::complex<double> twist =
      edge.to == mechanics::kGround ? angles[edge.from] : angles[edge.from] - angles[edge.to];
  return (edge.stiffness + s * edge.damping) * twist;
}

class Curve : public ResponseMisfit {
 public:
  Curve(const EstimationProblem& problem, const score::Response& measured) : ResponseMisfit(problem) {
    constexpr double kApart = 0.005;
    for (std::size_t i = 0; i < measured.gain.size(); ++i) {
      const double hz = measured.frequency_hz[i];
      if (measured.coherence[i] < kCoherent || measured.gain[i] == 0.0) continue;
      if (points_.empty() || hz > points_.back().first * (1.0 + kApart)) points_.emplace_back(hz, measured.gain[i]);
    }
  }
  Eigen::Index size() const override { return 2 * static_cast<Eigen::Index>(points_.size()); }

 protected:
  Eigen::VectorXd ErrorOf(const mechanics::TransferFunction& model, double) const override {
    Eigen::VectorXd error(size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const std::complex<double> ratio = points_[i].second / ResponseAt(model, points_[i].first);
      error.segment<2>(2 * static_cast<Eigen::Index>(i)) << LogGain(std::abs(ratio)), std::arg(ratio);
    }
    return error;
  }

 private:
  std::vector<std::pair<double, std::complex<double>>> points_;  // Hz, response
};

/// An input that is held from sample to sample reaches the plant smaller and half a sample late.
void TakeOutHold(score::Response& response, double step_s) {
  for (std::size_t i = 0; i < response.gain.size(); ++i) {
    const std::complex<double> phase(0.0, 2.0 * std::numbers::pi * response.frequency_hz[i] * step_s);
    if (phase != 0.0) response.gain[i] *= phase / (1.0 - std::exp(-phase));
  }
}

/// But noise.
bool HasStages(const Plan& plan, const std::string& path) {
  const Value* stages = plan.root.FindPath(path);
  for (std::size_t i = 0; stages != nullptr && stages->is_array() && i < stages->array().size(); ++i) {
    const Value* type = stages->array()[i].Find("type");
    if (type != nullptr && type->is_string() && type->string() != "noise") return true;
  }
  return false;
}

}  // namespace

Result<MeasuredCurve> MeasuredResponse(const EstimationProblem& problem) {
  const Plan& plan = problem.plan();
  const auto refuse = [&plan](std::string why) {
    return Failure{.message = std::move(why), .signal = plan.id, .exit_code = 2};
  };
  const Result<Modelled> model = ModelOf(plan, problem.registry());
  if (!model.ok()) return model.failure();
  const AnalysisSettings& settings = model->settings;
  for (const std::string& stages : {"input." + settings.input + ".actuator", "output." + settings.output + ".sensor"}) {
    if (HasStages(plan, stages))
      return refuse(stages + " is no part of the line's frequency response; take spectrum or free_run");
  }
  std::string why = "no record has both " + settings.input + " and " + settings.output;
  for (const MappedRecord& record : problem.records()) {
    const auto input = record.inputs.find(settings.input), output = record.outputs.find(settings.output);
    if (input == record.inputs.end() || output == record.outputs.end()) continue;
    if (*input->second.time != *output->second.time) {
      why = "input and output have time stamps of their own";
      continue;
    }
    const std::vector<double>& time = *input->second.time;
    MeasuredCurve seen = {score::EstimateResponse(time, *input->second.values, *output->second.values,
                                                  {settings.from_Hz, settings.to_Hz, 0.0}),
                          output->second.values, 0.0};
    why = seen.response.reason + "; analysis.from_Hz and analysis.to_Hz bound it";
    if (seen.response.verdict != score::Verdict::kPass) continue;
    seen.step_s = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
    TakeOutHold(seen.response, seen.step_s);
    return seen;
  }
  return refuse("no frequency response: " + why);
}

double LogGain(double ratio) {
  constexpr double kMost = 5.0;
  return std::clamp(std::log(ratio), -kMost, kMost);
}

Result<Eigen::VectorXd> ResponseMisfit::Of(const Plan& plan) const {
  const Result<Modelled> model = ModelOf(plan, problem_.registry());
  if (!model.ok()) return model.failure();
  return ErrorOf(model->transfer, model->settings.to_Hz);
}

std::unique_ptr<Objective> ResponseObjective(const EstimationProblem& problem, const score::Response& measured) {
  return std::make_unique<Curve>(problem, measured);
}
}  // namespace dynoproof::identification
