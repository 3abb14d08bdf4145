// The one interface of everything that takes part in a run: plants, machines, actuators, sensors, sources, controllers.
// A component is const; its states live in a frame that the solver owns, so that save, rewind, repeat and compare work
// for every plugin. Only spans cross this border.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace dynoproof {

// Matrices stay behind these names, so that what only knows components does not read Eigen.
struct LinearPart;  // model/linear_part.h
namespace mechanics {
struct Network;  // linear/network.h
}

/// A scalar input, output or state.
struct Port {
  std::string name, unit, description;
  double nominal = 1.0;  // a usual magnitude, > 0; scales tolerances
};

/// What a component has; fixed after construction.
struct Layout {
  std::vector<Port> inputs, outputs, states;
  int modes = 0;   // integers that only events and ticks change: stick or slip, side of a contact
  int guards = 0;  // functions of time and state whose sign change is an event
  /// Of each mode, where another model of the same machine may have more or fewer of them; empty: their numbers.
  std::vector<std::string> mode_names;
};

/// The values a component may look at.
struct View {
  double time_s;
  std::span<const double> inputs;
  std::span<const double> states;
  std::span<const int> modes;
};

/// One term of an output in terms of a network: the torque, twist or rate of an edge, or the angle or speed of a node.
struct OutputTerm {
  enum class Kind { kTorque, kTwist, kRate, kAngle, kSpeed } kind;
  int index;  // of the edge or node
};

class Component {
 public:
  virtual ~Component() = default;

  const Layout& layout() const { return layout_; }

  /// States and modes at t = 0, for the first inputs. Spans arrive filled with zeros.
  virtual void Start(std::span<const double> /*inputs*/, std::span<double> /*states*/, std::span<int> /*modes*/) const {
  }

  /// True when output `out` depends on input `in` at the same instant. Decides the order of evaluation.
  virtual bool FeedsThrough(int /*in*/, int /*out*/) const { return false; }

  /// Outputs at an instant. Inputs that do not feed through may be stale here.
  virtual void Output(const View& view, std::span<double> outputs) const = 0;

  /// Continuous components: time derivative of the states.
  virtual void Derivative(const View&, std::span<double> /*rates*/) const {}
  /// Values whose sign change is an event, and what it changes; modes without guards: guard -1 as an interval ends.
  virtual void Guards(const View&, std::span<double> /*values*/) const {}
  /// Whether a guard is that of a mode: >= 0 as long as the mode holds, and only its falling below 0 is an event. Else
  /// it is a kink that a solver is not to step over, in either direction.
  virtual bool IsOfAMode(int /*guard*/) const { return layout_.modes > 0; }
  virtual void OnEvent(const View&, int /*guard*/, std::span<double> /*states*/, std::span<int> /*modes*/) const {}

  /// Discrete components (kind control): one tick; `states` holds the old values and takes the new ones.
  virtual void Tick(const View&, std::span<double> /*states*/, std::span<double> /*outputs*/) const {}

  /// Actuators and sensors: a pure delay in seconds that the engine realises in front of the chain they belong to.
  virtual double delay_s() const { return 0.0; }
  /// True when the output jumps from sample to sample (noise, quantisation): only allowed after the last continuous
  /// stage.
  virtual bool sampled() const { return false; }
  /// False for a component that is an energy source or whose energy is not defined; the conformance tests ask it.
  virtual bool passive() const { return false; }

  /// The part that `realtime` may propagate exactly, or null.
  virtual const LinearPart* linear_part() const { return nullptr; }
  /// The linearised drive line for modes, zeros and resonances, or null; and in its terms the torque weights (n) of an
  /// input and the terms of an output.
  virtual const mechanics::Network* network() const { return nullptr; }
  virtual std::vector<double> TorqueWeights(int /*input*/) const { return {}; }
  virtual std::vector<OutputTerm> OutputTerms(int /*output*/) const { return {}; }

 protected:
  Layout layout_;
};

}  // namespace dynoproof
