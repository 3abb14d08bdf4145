#include "plugins/actuator/linear_stages/linear_stages.h"

namespace dynoproof::stages {
namespace {

/// x' = a x + b in, out = c x + d in, with `states` = 0 or 1; without integrators.
LinearPart Scalar(int states, double a, double b, double c, double d) {
  LinearPart part;
  part.system.A = Eigen::MatrixXd::Constant(states, states, a);
  part.system.B = Eigen::MatrixXd::Constant(states, 1, b);
  part.system.P = Eigen::MatrixXd(0, states);
  part.system.C = Eigen::MatrixXd::Constant(1, states, c);
  part.system.E = Eigen::MatrixXd(1, 0);
  part.system.D = Eigen::MatrixXd::Constant(1, 1, d);
  part.x_from_state = part.state_from_x = Eigen::MatrixXd::Identity(states, states);
  part.p_from_state = Eigen::MatrixXd(0, states);
  part.state_from_p = Eigen::MatrixXd(states, 0);
  return part;
}

}  // namespace

PluginInfo Gain::Describe(const char* kind) { return {kind, "gain", "a factor", "out = gain in", "definition", {}}; }

PluginInfo FirstOrderLag::Describe(const char* kind) {
  return {kind, "first_order_lag", "first-order lag", "tau d(out)/dt = in - out", "thesis Sec. 5.1 (actuator lag)", {}};
}

PluginInfo Delay::Describe(const char* kind) {
  return {kind, "delay", "pure delay", "out(t) = in(t - delay)", "definition", {}};
}

Gain::Gain(const Params& params, const BuildContext& context)
    : StaticStage(context.nominal), gain_(params.gain), linear_part_(Scalar(0, 0.0, 0.0, 0.0, params.gain)) {}

FirstOrderLag::FirstOrderLag(const Params& params, const BuildContext& context)
    : Stage(context.nominal), tau_(params.tau_s) {
  if (tau_ == 0.0) {
    linear_part_ = Scalar(0, 0.0, 0.0, 0.0, 1.0);
    return;
  }
  layout_.states = {{"out", "1", "lagged signal, in its own unit", context.nominal}};
  linear_part_ = Scalar(1, -1.0 / tau_, 1.0 / tau_, 1.0, 0.0);
}

void FirstOrderLag::Start(std::span<const double> inputs, std::span<double> states, std::span<int>) const {
  if (tau_ > 0.0) states[0] = inputs[0];
}

void FirstOrderLag::Output(const View& view, std::span<double> outputs) const {
  outputs[0] = tau_ > 0.0 ? view.states[0] : view.inputs[0];
}

void FirstOrderLag::Derivative(const View& view, std::span<double> rates) const {
  if (tau_ > 0.0) rates[0] = (view.inputs[0] - view.states[0]) / tau_;
}

Delay::Delay(const Params& params, const BuildContext& context)
    : StaticStage(context.nominal), delay_(params.delay_s), linear_part_(Scalar(0, 0.0, 0.0, 0.0, 1.0)) {}

}  // namespace dynoproof::stages
