// Plant `equations`: a plant that a scenario writes down itself, as ordinary differential equations in named states.
//
//   x_i' = rate_i(t, x, u, p, f),   y_k = value_k(t, x, u, p, f)
//
// with inputs u, parameters p, and for each body the force or torque f = load_NAME of the laws that act on it: minus the
// sum of their torques at the body's position and speed. Definitions name what several equations share. Friction slips
// wherever a body moves; its force passes through zero along tanh(|v|/v_t). Expressions are read by muParser.
// Inputs and outputs are those that the scenario names; each state is an output as well.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/component.h"
#include "model/registry.h"
#include "plugins/plant/sliding_loads.h"

namespace dynoproof {

class Expression;  // equations.cc

class Equations : public Component {
 public:
  struct InputParams {
    std::string unit, description;
    double nominal = 1.0;
    void Visit(auto& v) {
      v.Optional("unit", unit, Any(), "unit");
      v.Optional("nominal", nominal, Positive(), "usual magnitude");
      v.Optional("description", description, Any(), "what it is");
    }
  };
  struct StateParams : InputParams {
    std::string rate;
    double start = 0.0;
    void Visit(auto& v) {
      v.Required("rate", rate, Any(), "expression of its time derivative");
      v.Optional("start", start, Any(), "value at t = 0");
      InputParams::Visit(v);
    }
  };
  struct OutputParams : InputParams {
    std::string value;
    void Visit(auto& v) {
      v.Required("value", value, Any(), "expression");
      InputParams::Visit(v);
    }
  };
  struct BodyParams {
    std::string position, speed;
    double transition_speed = 1e-3, nominal_load = 1.0;
    void Visit(auto& v) {
      v.Required("speed", speed, Any(), "expression of its speed, in states and parameters");
      v.Optional("position", position, Any(), "the same of its position or angle, for laws that need one");
      v.Optional("transition_speed", transition_speed, Positive(),
                 "v_t: friction turns its sign along tanh(v / v_t), at standstill a body creeps that fast");
      v.Optional("nominal_load", nominal_load, Positive(), "usual force or torque on it");
    }
  };
  struct Params {
    std::vector<std::pair<std::string, double>> parameter;
    std::vector<std::pair<std::string, std::string>> define;
    std::vector<std::pair<std::string, InputParams>> input;
    std::vector<std::pair<std::string, StateParams>> state;
    std::vector<std::pair<std::string, OutputParams>> output;
    std::vector<std::pair<std::string, BodyParams>> body;
    std::vector<std::pair<std::string, Value>> load;
    std::string motion = "rotation";
    void Visit(auto& v) {
      v.Required("state", state, Any(), "states by name: rate, start, unit, nominal");
      v.Optional("parameter", parameter, Any(), "numbers by name; effects and fits change them");
      v.Optional("input", input, Any(), "inputs by name: unit, nominal");
      v.Optional("define", define, Any(), "expressions by name, of which others make use");
      v.Optional("output", output, Any(), "outputs by name beside the states: value, unit, nominal");
      v.Optional("body", body, Any(),
                 "places of loads, inertia:NAME: speed, position; load_NAME stands in the equations");
      v.Optional("load", load, Any(), "laws by name: on = a body, law and its parameters");
      v.Optional("motion", motion, std::vector<std::string>{"rotation", "translation"},
                 "whether bodies turn or slide: the units of their loads");
    }
  };

  static PluginInfo Info();
  static PlantTraits Traits();
  /// Null, with diagnostics, where an expression or load is faulty.
  static std::unique_ptr<Equations> Create(const Params& params, const Value& table, BuildContext& context);
  ~Equations() override;

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int in, int out) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  class Builder;
  struct Body {
    std::unique_ptr<Expression> position, speed;  // position may be null
    std::size_t slot = 0;                         // of its load
  };

  Equations();
  /// Writes time, inputs, states, loads and definitions of an instant where the expressions read them.
  void Look(const View& view) const;
  double PositionOf(const Body& body) const;

  /// What expressions read: time, inputs, states, parameters, loads, definitions. A component is built and run by one thread.
  mutable std::vector<double> values_;
  std::vector<double> starts_;
  std::size_t inputs_ = 0, states_ = 0;  // how many; states of laws come behind
  std::vector<std::unique_ptr<Expression>> rates_, outputs_;
  std::vector<std::pair<std::size_t, std::unique_ptr<Expression>>> definitions_;  // slot, in the order of their need
  std::vector<Body> bodies_;
  SlidingLoads loads_;
  std::vector<std::vector<bool>> feeds_;  // [output][input]
};

}  // namespace dynoproof
