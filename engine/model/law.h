// A law maps the twist and the twist rate of a shaft to the torque that it transmits. A law between a node and the
// ground maps angle and speed of the node to the torque that brakes it; friction and loads are such laws.
#pragma once

#include <span>
#include <vector>

#include "model/component.h"

namespace dynoproof {

/// The part of a law that a network takes into K and C.
struct SpringDamper {
  double stiffness = 0.0, damping = 0.0;
};

/// What a law may look at. In a translational network read stretch, speed and force.
struct LawView {
  double time_s;
  double twist;  // d = phi_from - phi_to [rad]; to the ground: the angle
  double rate;   // w = its time derivative [rad/s]; to the ground: the speed
  /// The transmitted torque that would keep the rate as it is: what a stick must hold [N m].
  double holding_torque;
  std::span<const double> states;
  std::span<const int> modes;
};

class Law {
 public:
  virtual ~Law() = default;

  /// Own states, modes and guards; inputs and outputs stay empty.
  const Layout& layout() const { return layout_; }

  /// The linear part; Torque() includes it.
  virtual SpringDamper linear() const { return {}; }
  /// The same values seen by linear analysis (modes, zeros) where the law is linearised about rest; usually linear().
  virtual SpringDamper linearised() const { return linear(); }

  virtual void Start(double /*twist*/, double /*rate*/, std::span<double> /*states*/, std::span<int> /*modes*/) const {}
  /// Transmitted torque T [N m]: acts with -T on the first node and +T on the second. T * rate > 0 takes energy up.
  virtual double Torque(const LawView& view) const = 0;
  virtual void Derivative(const LawView&, std::span<double> /*rates*/) const {}
  /// With modes, each is >= 0 as long as the mode holds; without, each is a kink. See Component::IsOfAMode().
  virtual void Guards(const LawView&, std::span<double> /*values*/) const {}
  virtual void OnEvent(const LawView&, int /*guard*/, std::span<double> /*states*/, std::span<int> /*modes*/) const {}

  /// True for a law that is linear for good: Torque() and Derivative() are sums of constant multiples of twist, rate
  /// and own states, at any size and time; without states Torque() is linear() and nothing else; no modes, no guards.
  /// A drive line takes such a law into its linear part, which is carried exactly, and asks it nothing during a run. A
  /// law that does not say so is carried as a nonlinear one: as right, but slower.
  virtual bool is_linear() const { return false; }
  /// True for a law whose torque never changes: to a solver it is an input that is held.
  virtual bool constant() const { return false; }

  /// True for laws with friction: their torque depends on holding_torque, and `realtime` solves them by SlipTorque().
  virtual bool sticks() const { return false; }
  /// Realtime, laws that stick: the torque of slipping at view.rate in the direction of `sign` (+1 or -1: the sign that
  /// the torque has). The solver finds the torque that stops the motion within the step; what exceeds this, slips.
  virtual double SlipTorque(const LawView&, int /*sign*/) const { return 0.0; }

 protected:
  Layout layout_;
};

}  // namespace dynoproof
