#include "fmu/run.h"

namespace dynoproof::fmu {
namespace {

/// A source whose value is set from outside.
class Held : public Component {
 public:
  explicit Held(const double& value) : value_(value) {
    layout_.outputs = {{"value", "1", "value in the unit of the driven input", 1.0}};
  }
  void Output(const View&, std::span<double> outputs) const override { outputs[0] = value_; }

 private:
  const double& value_;
};

}  // namespace

Result<std::unique_ptr<Run>> Run::Of(const Plan& plan, const Registry& registry, std::span<const double> first) {
  Diagnostics diagnostics;
  std::unique_ptr<Run> run(new Run());
  run->scenario_ = Prepare(plan, {}, registry, diagnostics);
  if (run->scenario_ == nullptr) return Failure{.message = diagnostics.Format(), .exit_code = 2};
  Rig& rig = *run->scenario_->rig;
  run->inputs_.reserve(rig.inputs.size());  // sources refer to them
  for (InputLine& line : rig.inputs) {
    if (!line.source) continue;
    double value = 0.0;
    line.source->Output({0.0, {}, {}, {}}, {&value, 1});
    run->inputs_.push_back(run->inputs_.size() < first.size() ? first[run->inputs_.size()] : value);
    line.source = std::make_unique<Held>(run->inputs_.back());
  }
  Result<std::unique_ptr<Solver>> solver = MakeRealtimeSolver(rig);
  if (!solver.ok()) return solver.failure();
  run->solver_ = *std::move(solver);
  run->simulation_ = std::make_unique<Simulation>(rig, *run->solver_);
  if (Status broken = run->simulation_->Start()) return *broken;
  return run;
}

Status Run::Advance(std::int64_t periods) {
  for (std::int64_t i = 0; i < periods; ++i) {
    if (Status broken = simulation_->Tick()) return broken;
    if (Status broken = simulation_->Integrate()) return broken;
  }
  return {};
}

Result<std::vector<double>> Run::Outputs() {
  // A tick takes the samples; what it commands belongs to the next period.
  const Frame now = simulation_->frame();
  if (Status broken = simulation_->Tick()) return *broken;
  std::vector<double> samples;
  for (std::size_t i = 0; i < outputs(); ++i) samples.push_back(simulation_->OutputSample(i));
  simulation_->Restore(now);
  return samples;
}

}  // namespace dynoproof::fmu
