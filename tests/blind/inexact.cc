#include "tests/blind/inexact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "plugins/stage.h"
#include "score/series.h"

namespace dynoproof::blind {
namespace {

/// Friction as lubricated contacts have it: T = T_c (1 + e sin phi) tanh(w / w_c). It creeps under any torque, and
/// changes with the angle.
class Creeping : public Law {
 public:
  struct Params {
    double T_c_Nm = 0.0, w_c_rad_per_s = 1.0, e = 0.0;
    void Visit(auto& v) {
      v.Required("T_c_Nm", T_c_Nm, NonNegative(), "friction torque at speed");
      v.Required("w_c_rad_per_s", w_c_rad_per_s, Positive(), "speed below which it creeps");
      v.Optional("e", e, Any(), "share that changes with the angle");
    }
  };
  static PluginInfo Info() {
    return {"law", "creeping", "friction that creeps", "T = T_c (1 + e sin phi) tanh(w / w_c)", "made up", {}};
  }
  explicit Creeping(const Params& params) : p_(params) {}
  double Torque(const LawView& view) const override {
    return p_.T_c_Nm * (1.0 + p_.e * std::sin(view.twist)) * std::tanh(view.rate / p_.w_c_rad_per_s);
  }

 private:
  Params p_;
};

/// A drive that gives less and less towards its limit: out = limit tanh(in / limit).
class SoftStop : public stages::StaticStage {
 public:
  struct Params {
    double limit = 1.0;
    void Visit(auto& v) { v.Required("limit", limit, Positive(), "largest magnitude, in the signal's unit"); }
  };
  static PluginInfo Info() {
    return {"actuator", "soft_stop", "a limit that is reached softly", "out = limit tanh(in / limit)", "made up", {}};
  }
  SoftStop(const Params& params, const BuildContext& context) : StaticStage(context.nominal), limit_(params.limit) {}
  double Map(double, double in) const override { return limit_ * std::tanh(in / limit_); }

 private:
  double limit_;
};

std::string OneOf(const std::vector<std::string>& names, Dice& dice) { return names.at(dice.Index(names.size())); }

std::vector<std::string> KeysAt(const Plan& plan, const std::string& path) {
  const Value* table = plan.root.FindPath(path);
  return table != nullptr ? KeysOf(*table) : std::vector<std::string>{};
}

void HangOn(Plan& plan, const std::string& body, Dice& dice) {
  // A twentieth of the body or so, tuned to where drive lines have their modes, as lightly damped as brackets are.
  const double inertia = plan.root.FindPath("plant.inertia." + body)->number() * dice.Uniform(0.03, 0.08),
               omega = 2.0 * std::numbers::pi * std::exp(dice.Uniform(std::log(30.0), std::log(300.0)));
  plan.root["plant"]["inertia"]["absorber"] = Value(inertia);
  plan.root["plant"]["shaft"]["absorber"] = {{"between", Value::Array{Value(body), Value("absorber")}},
                                             {"stiffness_Nm_per_rad", inertia * omega * omega},
                                             {"damping_Nms_per_rad", 0.06 * inertia * omega}};
}

/// A Butterworth low-pass of second order with its cut-off at `cutoff` times the sampling rate (bilinear transform).
void LowPass(std::vector<double>& values, double cutoff) {
  const double w = std::tan(std::numbers::pi * cutoff), q = std::numbers::sqrt2 * w, norm = 1.0 / (1.0 + q + w * w);
  double x1 = values.front(), x2 = x1, y1 = x1, y2 = x1;
  for (double& v : values) {
    const double y = norm * (w * w * (v + 2.0 * x1 + x2) - 2.0 * (w * w - 1.0) * y1 - (1.0 - q + w * w) * y2);
    x2 = std::exchange(x1, v);
    y2 = std::exchange(y1, y);
    v = y;
  }
}

/// Every `rows`-th value, or the mean of as many.
std::vector<double> Thinned(const std::vector<double>& values, std::size_t rows, bool mean) {
  std::vector<double> thinned;
  for (std::size_t i = 0; i + rows <= values.size(); i += rows) {
    const std::size_t end = mean ? i + rows : i + 1;
    double sum = 0.0;
    for (std::size_t k = i; k < end; ++k) sum += values[k];
    thinned.push_back(sum / static_cast<double>(end - i));
  }
  return thinned;
}

/// What sensors add to one output; `sigma` is its noise.
void Sense(const std::string& name, std::vector<double>& values, double sigma, const std::vector<double>& time,
           Case& hidden, Dice& dice) {
  const double period_s = time[1] - time[0];
  if (hidden.IsInexactBy("filtered")) {
    LowPass(values, dice.Uniform(0.05, 0.15));
    hidden.near.insert("output:" + name);
  }
  if (hidden.IsInexactBy("hum")) {
    const double amplitude = sigma * dice.Uniform(1.0, 5.0), phase = dice.Uniform(-3.0, 3.0),
                 omega = 2.0 * std::numbers::pi * std::min(50.0, 0.2 / period_s) * dice.Uniform(0.99, 1.01);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += amplitude * std::sin(omega * time[i] + phase);
  }
  if (hidden.IsInexactBy("drifting")) {
    const double height = sigma * dice.Uniform(3.0, 10.0) * dice.Sign(), warm_s = time.back() * dice.Uniform(0.1, 0.5);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] -= height * std::expm1(-time[i] / warm_s);
    hidden.near.insert("output:" + name);
  }
  if (hidden.IsInexactBy("coloured")) {
    const double pole = dice.Uniform(0.9, 0.99), share = sigma * dice.Uniform(1.0, 2.0);
    double state = 0.0;
    for (double& v : values) {
      state = pole * state + std::sqrt(1.0 - pole * pole) * dice.Normal();
      v += share * state;
    }
  }
}

}  // namespace

void RegisterInexact(Registry& registry) {
  registry.Add<Creeping>();
  registry.Add<SoftStop>();
}

void DrawInexact(Case& hidden, Dice& dice) {
  const bool line = hidden.scenario != "diagnose/charge_air" && hidden.scenario != "diagnose/fuel_gas";
  std::vector<std::string> possible = {"hum",      "filtered",    "quantised", "drifting",
                                       "coloured", "noisy_input", "decimated", "fitted"};
  if (line) possible.insert(possible.end(), {"absorber", "soft_stop"});
  if (line && hidden.kind == "effect") possible.push_back("creeping");
  for (std::size_t left = 1 + dice.Index(2); left > 0; --left) {
    hidden.inexact.push_back(OneOf(possible, dice));
    std::erase(possible, hidden.inexact.back());
  }
}

bool MakeInexact(Plan& plan, const Columns& healthy, Case& hidden, Dice& dice) {
  if (hidden.IsInexactBy("absorber")) {
    const std::string body = OneOf(KeysAt(plan, "plant.inertia"), dice);
    HangOn(plan, body, dice);
    hidden.near.insert("inertia:" + body);
  }
  if (hidden.IsInexactBy("soft_stop")) {
    const std::string input = OneOf(KeysAt(plan, "input"), dice);
    double peak = 0.0;
    for (const double v : healthy.inputs.at(input)) peak = std::max(peak, std::abs(v));
    plan.root["input"][input]["actuator"] =
        Value::Array{Value({{"type", "soft_stop"}, {"limit", peak * dice.Uniform(1.5, 3.0)}})};
    hidden.near.insert("input:" + input);
  }
  return hidden.IsInexactBy("absorber") || hidden.IsInexactBy("soft_stop");
}

void LetCreep(Plan& plan, Case& hidden, Dice& dice) {
  const double limit = hidden.causes.at(0).parameters.at(0);
  const double speed = plan.root.FindPath("plant.nominal_torque_Nm")->number() > 2000.0 ? 1.0 : 5.0;
  Value& load = plan.root["plant"]["load"]["coulomb_friction"];
  load = {{"on", load["on"].string()},
          {"law", "creeping"},
          {"T_c_Nm", limit},
          {"w_c_rad_per_s", speed * dice.Uniform(0.01, 0.1)},
          {"e", dice.Uniform(0.0, 0.3)}};
  hidden.any_friction = true;
}

void RecordInexactly(Columns& columns, Case& hidden, Dice& dice) {
  const Columns before = columns;
  for (auto& [name, values] : columns.outputs)
    Sense(name, values, hidden.noise * score::StandardDeviation(values), columns.time, hidden, dice);
  hidden.inexact_size = std::max(hidden.inexact_size, SizeOf(columns, before, hidden.noise));
  if (hidden.IsInexactBy("noisy_input")) {
    for (auto& [name, values] : columns.inputs) {
      const double sigma = dice.Uniform(0.01, 0.03) * score::StandardDeviation(values);
      for (double& v : values) v += sigma * dice.Normal();
    }
  }
  if (hidden.IsInexactBy("decimated")) {
    const std::size_t rows = 2 + 2 * dice.Index(2);
    // What was held is best known by its mean over the time until the next row.
    for (auto& [name, values] : columns.inputs) values = Thinned(values, rows, true);
    for (auto& [name, values] : columns.outputs) values = Thinned(values, rows, false);
    columns.time = Thinned(columns.time, rows, false);
  }
}

void Quantise(Columns& columns, const Case& hidden, Dice& dice) {
  if (!hidden.IsInexactBy("quantised")) return;
  for (auto& [name, values] : columns.outputs) {
    const double step = hidden.noise * score::StandardDeviation(values) * dice.Uniform(2.0, 6.0);
    for (double& v : values) v = step * std::round(v / step);
  }
}

std::vector<std::string> FittedNumbers(const Plan& plan, Dice& dice) {
  std::vector<std::string> paths;
  for (const char* key : {"plant.mass_kg", "plant.stiffness_N_per_m"}) {
    if (plan.root.FindPath(key) != nullptr) paths.emplace_back(key);
  }
  for (const auto& [section, key] : {std::pair{"plant.inertia", ""},
                                     {"plant.rotor", ".inertia_kg_m2"},
                                     {"plant.shaft", ".stiffness_Nm_per_rad"},
                                     {"plant.volume", ".volume_m3"},
                                     {"plant.volume", ""}}) {
    for (const std::string& name : KeysAt(plan, section)) {
      const std::string path = fmt::format("{}.{}{}", section, name, key);
      const Value* value = plan.root.FindPath(path);
      if (value != nullptr && value->is_number()) paths.push_back(path);
    }
  }
  while (paths.size() > 3) paths.erase(paths.begin() + static_cast<std::ptrdiff_t>(dice.Index(paths.size())));
  return paths;
}

}  // namespace dynoproof::blind
