#include "plugins/effect/stage_effects.h"

#include <algorithm>
#include <utility>

#include "plugins/effect/plan_edit.h"

namespace dynoproof::effects {
namespace {

// Signals are torques (1 ... 2e4 N m), speeds (1 ... 1e3 rad/s), pressures (1e5 ... 1e6 Pa), flaps (0 ... 100 %):
// bounds in the signal's own unit span them all.
constexpr double kLargestSignal = 1e7;

bool IsSampled(const Value& stage) {
  const Value* type = stage.Find("type");
  return type != nullptr && type->is_string() && (type->string() == "noise" || type->string() == "quantisation");
}

class StageEffect : public Effect {
 public:
  /// Starts from the name of the input or output; null: the parameters' own.
  using StartsOf = Points (*)(const std::string& signal, const Magnitudes& m);

  /// `section`: "input" or "output"; `keys`: the stage's key for each parameter of the effect.
  StageEffect(std::string section, EffectInfo info, std::string type, std::vector<std::string> keys, StartsOf starts)
      : section_(std::move(section)), type_(std::move(type)), keys_(std::move(keys)), starts_(starts) {
    info_ = std::move(info);
  }

  Points Starts(const Plan& plan, const Place& place, const Magnitudes& magnitudes) const override {
    return starts_ != nullptr ? starts_(place.name, magnitudes) : Effect::Starts(plan, place, magnitudes);
  }

  std::vector<Place> Places(const Plan& plan) const override {
    std::vector<Place> places;
    const Value* ports = plan.root.Find(section_);
    for (const Value::Entry& entry : ports != nullptr && ports->is_table() ? ports->table() : Value::Table{}) {
      if (entry.value.is_table()) places.push_back({section_, entry.key, ""});
    }
    return places;
  }

  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value stage = {{"type", type_}};
    for (std::size_t i = 0; i < keys_.size(); ++i) stage[keys_[i]] = Value(parameters[i]);
    Value& port = plan.root[section_][place.name];
    const char* chain_key = section_ == "input" ? "actuator" : "sensor";
    Value::Array chain = ListOf(port.Find(chain_key));
    chain.insert(std::find_if(chain.begin(), chain.end(), IsSampled), std::move(stage));
    Replace(port[chain_key], Value(std::move(chain)));
  }

 private:
  std::string section_, type_;
  std::vector<std::string> keys_;
  StartsOf starts_;
};

std::unique_ptr<Effect> Make(const char* section, EffectInfo info, const char* type, std::vector<std::string> keys,
                             StageEffect::StartsOf starts = nullptr) {
  return std::make_unique<StageEffect>(section, std::move(info), type, std::move(keys), starts);
}

Points LagStarts(const std::string&, const Magnitudes& m) {
  return {{m.step_s}, {4.0 * m.step_s}, {16.0 * m.step_s}, {64.0 * m.step_s}};
}

/// The screening adds how late a signal comes: a delay beyond the signal's own width has no slope back to one sample.
Points DelayStarts(const std::string&, const Magnitudes& m) { return {{m.step_s}}; }

Points Multiples(double of, std::initializer_list<double> factors) {
  Points starts;
  for (const double factor : factors) starts.push_back({factor * of});
  return starts;
}

// Fast torque actuators lag by 0.1 ... 4 ms (thesis Sec. 5.1), valves and flaps by up to a second; the start is the
// thesis' 1 ms.
EffectParameter Lag() { return {"tau", "s", "time constant", 0.0, 1.0, 0.0, 1e-3}; }

// A few samples of 0.1 ms on a real-time bus, up to some 100 ms on a slow data logger.
EffectParameter Delay() { return {"t_d", "s", "delay", 0.0, 0.5, 0.0, 2e-4}; }

// Wrong ranges and units are found by check-data before; what is left are errors of up to a factor of a few.
EffectParameter Gain() { return {"g", "1", "factor, 1: none", 0.1, 10.0, 1.0, 1.02}; }

}  // namespace

std::unique_ptr<Effect> ActuatorLag() {
  return Make("input", {"actuator_lag", "tau dy/dt = u - y", "first-order lag of an input", {Lag()}}, "first_order_lag",
              {"tau_s"}, LagStarts);
}

std::unique_ptr<Effect> ActuatorDelay() {
  return Make("input", {"actuator_delay", "y(t) = u(t - t_d)", "pure delay of an input", {Delay()}}, "delay",
              {"delay_s"}, DelayStarts);
}

std::unique_ptr<Effect> ActuatorGain() {
  return Make("input", {"actuator_gain", "y = g u", "an input is off by a factor", {Gain()}}, "gain", {"gain"});
}

std::unique_ptr<Effect> ActuatorSaturation() {
  return Make("input",
              {"actuator_saturation",
               "y = u limited to abs(y) <= limit",
               "an input is limited",
               // The start bites on inputs of the drive lines (nominal 1000 N m); a fit should rather begin below the
               // largest value of the record, as a limit above it changes nothing.
               {{"limit", "1", "largest magnitude, in the unit of the input", 1e-3, kLargestSignal, kLargestSignal,
                 500.0, true}}},
              "saturation", {"limit"}, [](const std::string& input, const Magnitudes& m) {
                return Multiples(Magnitudes::Of(m.input_peak, input), {0.5, 0.7, 0.85, 0.95});
              });
}

std::unique_ptr<Effect> ActuatorDeadZone() {
  return Make("input",
              {"actuator_dead_zone",
               "y = 0 within +-width/2, shifted outside",
               "an input does nothing near zero",
               {{"width", "1", "total width, in the unit of the input", 0.0, kLargestSignal, 0.0, 1.0, true}}},
              "dead_zone", {"width"}, [](const std::string& input, const Magnitudes& m) {
                // A wide one lets only peaks through: from a narrow one no slope leads there.
                return Multiples(Magnitudes::Of(m.input_rms, input), {0.05, 0.5, 1.5, 5.0});
              });
}

std::unique_ptr<Effect> ActuatorHarmonic() {
  // Beyond +-0.5 the characteristic would fall within the nominal range.
  return Make("input",
              {"actuator_harmonic",
               "y = u + h2 u^2/u_n + h3 u^3/u_n^2, u_n the nominal of the input",
               "a sine gains a second and a third harmonic",
               {{"h2", "1", "share of the square", -0.5, 0.5, 0.0, 0.02},
                {"h3", "1", "share of the cube", -0.5, 0.5, 0.0, 0.02}}},
              "harmonic", {"h2", "h3"});
}

std::unique_ptr<Effect> SensorGain() {
  return Make("output", {"sensor_gain", "y = g x", "an output is off by a factor", {Gain()}}, "gain", {"gain"});
}

std::unique_ptr<Effect> SensorOffset() {
  return Make("output",
              {"sensor_offset",
               "y = x + o",
               "an output is off by a constant",
               {{"o", "1", "offset, in the unit of the output", -kLargestSignal, kLargestSignal, 0.0, 0.0, true}}},
              "offset", {"offset"}, [](const std::string& output, const Magnitudes& m) {
                return Multiples(Magnitudes::Of(m.output_spread, output), {0.05});
              });
}

std::unique_ptr<Effect> SensorDelay() {
  return Make("output", {"sensor_delay", "y(t) = x(t - t_d)", "pure delay of an output", {Delay()}}, "delay",
              {"delay_s"}, DelayStarts);
}

std::unique_ptr<Effect> SensorLag() {
  return Make("output", {"sensor_lag", "tau dy/dt = x - y", "first-order lag of an output", {Lag()}}, "first_order_lag",
              {"tau_s"}, LagStarts);
}

std::unique_ptr<Effect> SensorDrift() {
  return Make("output",
              {"sensor_drift",
               "y = x + slope t",
               "an output drifts away",
               // The whole range within a second at most.
               {{"slope", "1/s", "growth, in the unit of the output per second", -kLargestSignal, kLargestSignal, 0.0,
                 0.0, true}}},
              "drift", {"slope_per_s"}, [](const std::string& output, const Magnitudes& m) {
                return Points{{0.05 * Magnitudes::Of(m.output_spread, output) / m.duration_s}};
              });
}

std::unique_ptr<Effect> SensorRectified() {
  return Make("output", {"sensor_rectified", "y = abs(x)", "an output shows the magnitude only", {}}, "rectified", {});
}

}  // namespace dynoproof::effects
