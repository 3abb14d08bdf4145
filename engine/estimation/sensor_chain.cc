#include "estimation/sensor_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/linear_part.h"

namespace dynoproof::estimation {

SensorChain::SensorChain(const Rig& rig, std::size_t output) {
  const OutputLine& line = rig.outputs[output];
  // A tick changes what controls and commands give, and a sample is of before.
  const bool changes = std::ranges::none_of(rig.blocks, [&](const dynoproof::Block& block) {
    return line.signal >= block.first_output && line.signal < block.first_output + block.outputs();
  });
  end_ = changes && line.ring < 0 ? line.sample : line.signal;
  for (int i = 0;; ++i) {
    const dynoproof::Block* stage = rig.FindBlock(fmt::format("output.{}.sensor.{}", line.name, i));
    if (stage == nullptr) break;
    delay_s_ += stage->component->delay_s();
    const LinearPart* part = stage->component->linear_part();
    if (part == nullptr) {
      if (stage->states() == 0 && !stage->component->sampled()) curved_.push_back(stage);
      continue;
    }
    // G(s) = D + C (s - A)^-1 B has the gain G(0) and the mean delay -G'(0) / G(0).
    const mechanics::LinearSystem& system = part->system;
    double gain = system.D(0, 0), late = 0.0;
    if (system.A.rows() > 0) {
      const auto inverse = system.A.partialPivLu();
      const Eigen::VectorXd once = inverse.solve(system.B.col(0));
      gain -= system.C.row(0).dot(once);
      late = system.C.row(0).dot(inverse.solve(once));
    }
    gain_ *= gain;
    if (gain != 0.0) lag_s_ += late / gain;
  }
}

double SensorChain::SlopeAt(const Frame& frame, double time_s) const {
  constexpr double kStep = 1e-6;  // of the signal's usual size
  double slope = gain_;
  for (const dynoproof::Block* stage : curved_) {
    const double in = frame.signals[static_cast<std::size_t>(stage->inputs[0])];
    const double step = kStep * std::max(std::abs(in), stage->component->layout().inputs[0].nominal);
    double low = in - step, high = in + step, at_low = 0.0, at_high = 0.0;
    stage->component->Output({time_s, {&low, 1}, {}, {}}, {&at_low, 1});
    stage->component->Output({time_s, {&high, 1}, {}, {}}, {&at_high, 1});
    slope *= (at_high - at_low) / (high - low);
  }
  return slope;
}

double LagInverse::operator()(double sample, double since_s) {
  if (lag_s_ == 0.0) return sample;
  const double kept = begun_ ? KeptOver(since_s, lag_s_) : 0.0, last = last_;
  begun_ = true;
  last_ = sample;
  return (sample - kept * last) / (1.0 - kept);
}

bool HasSensors(const Plan& plan) {
  const Value* outputs = plan.root.Find("output");
  return outputs != nullptr && outputs->is_table() &&
         std::ranges::any_of(outputs->table(), [](const Value::Entry& output) {
           return output.value.is_table() && output.value.Find("sensor") != nullptr;
         });
}

Plan WithoutSensors(Plan plan) {
  Value* outputs = plan.root.Find("output");
  if (outputs == nullptr || !outputs->is_table()) return plan;
  for (Value::Entry& output : outputs->table()) {
    if (output.value.is_table()) output.value.Erase("sensor");
  }
  return plan;
}

double KeptOver(double period_s, double lag_s) { return lag_s > 0.0 ? std::exp(-period_s / lag_s) : 0.0; }

}  // namespace dynoproof::estimation
