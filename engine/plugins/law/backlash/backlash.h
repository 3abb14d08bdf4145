// Laws of shafts with play (thesis Chapter 3): `dead_zone`, `revised_dead_zone`, `phase_plane`, the same three with
// contact-free damping, `damped_...`, and `full_state_backlash`, which integrates the angle at the gap. The derivation
// of every equation is in README.md.
//
// Mode 0 is free, +1 and -1 touch at the side with twist > 0 and twist < 0. One guard, >= 0 as long as the mode holds.
// A change of mode waits for kMargin beyond its boundary, so that no event is found twice.
#pragma once

#include <cmath>

#include "model/registry.h"

namespace dynoproof::laws {

/// k, c: the shaft; alpha: half of the play; c_f: damping while the sides do not touch.
struct BacklashNumbers {
  double k = 0.0, c = 0.0, alpha = 0.0, c_f = 0.0;
};

/// What all of them share: torque of a touching shaft, modes and guard.
class Backlash : public Law {
 public:
  explicit Backlash(const BacklashNumbers& numbers) : n_(numbers) {
    layout_.modes = 1;
    layout_.guards = 1;
  }
  /// Modes, zeros and resonances are those of the closed line, both sides touching under load.
  SpringDamper linearised() const override { return {n_.k, n_.c}; }

 protected:
  static constexpr double kMargin = 1e-12;  // [rad]: at k = 15 kN m/rad a torque of 15 nN m
  /// Torque while touching at that side.
  double Contact(int side, double twist, double rate) const { return n_.k * (twist - side * n_.alpha) + n_.c * rate; }

  const BacklashNumbers n_;
};

/// A law whose mode follows from twist and rate alone.
class PlaneBacklash : public Backlash {
 public:
  using Backlash::Backlash;
  void Start(double twist, double rate, std::span<double> states, std::span<int> modes) const final;
  double Torque(const LawView& view) const final;
  void Guards(const LawView& view, std::span<double> values) const final;
  void OnEvent(const LawView& view, int guard, std::span<double> states, std::span<int> modes) const final;

 protected:
  /// >= 0 where the sides touch at twist > 0 (that side only: the law is odd), continuous [rad].
  virtual double Margin(double twist, double rate) const = 0;
  /// Torque while free.
  virtual double Free(double twist, double rate) const = 0;

 private:
  double MarginAt(int side, double twist, double rate) const { return Margin(side * twist, side * rate); }
};

/// (3.1), (3.5): touches where |twist| > alpha. It can pull.
class DeadZoneLaw : public PlaneBacklash {
 public:
  using PlaneBacklash::PlaneBacklash;

 protected:
  double Margin(double twist, double) const override { return twist - n_.alpha; }
  double Free(double, double rate) const override { return n_.c_f * rate; }
};

/// (3.2), and with c_f: touches where the shaft presses more than the damping in the gap does. Continuous.
class RevisedDeadZoneLaw : public PlaneBacklash {
 public:
  using PlaneBacklash::PlaneBacklash;

 protected:
  double Margin(double twist, double rate) const override { return twist - n_.alpha + (n_.c - n_.c_f) / n_.k * rate; }
  double Free(double, double rate) const override { return n_.c_f * rate; }
};

/// (3.3), (3.4), (3.13)-(3.15): touches where the angle at the gap, estimated from twist and rate, has come to its
/// side.
class PhasePlaneLaw : public PlaneBacklash {
 public:
  explicit PhasePlaneLaw(const BacklashNumbers& numbers) : PlaneBacklash(numbers), p_(n_.k / (n_.c + n_.c_f)) {}

 protected:
  double Margin(double twist, double rate) const override;
  double Free(double twist, double rate) const override;

 private:
  /// exp(-p t), t the time since contact was lost at the other side, (3.12).
  double Decay(double twist, double rate) const;
  double p_;
};

/// (3.6), (3.7) with the angle at the gap as state: no assumption on the twist rate.
class FullStateLaw : public Backlash {
 public:
  explicit FullStateLaw(const BacklashNumbers& numbers);
  void Start(double twist, double rate, std::span<double> states, std::span<int> modes) const override;
  double Torque(const LawView& view) const override;
  void Derivative(const LawView& view, std::span<double> rates) const override;
  void Guards(const LawView& view, std::span<double> values) const override;
  void OnEvent(const LawView& view, int guard, std::span<double> states, std::span<int> modes) const override;

 private:
  /// Speed of the gap's angle while free.
  double FreeSpeed(const LawView& view) const {
    return (n_.k * (view.twist - view.states[0]) + n_.c * view.rate) / (n_.c + n_.c_f);
  }
};

/// How a law is written in a scenario. `kDivides`: it divides by c + c_f.
struct BacklashParams {
  double stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0, half_gap_rad = 0.0;
  BacklashNumbers Numbers() const { return {stiffness_Nm_per_rad, damping_Nms_per_rad, half_gap_rad, 0.0}; }
  void Visit(auto& v) {
    v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, Positive(), "shaft stiffness k");
    v.Optional("damping_Nms_per_rad", damping_Nms_per_rad, NonNegative(), "shaft damping c");
    v.Required("half_gap_rad", half_gap_rad, NonNegative(), "alpha, half of the total play");
  }
};
struct DampedBacklashParams : BacklashParams {
  double contact_free_damping_Nms_per_rad = 0.0;
  BacklashNumbers Numbers() const {
    return {stiffness_Nm_per_rad, damping_Nms_per_rad, half_gap_rad, contact_free_damping_Nms_per_rad};
  }
  void Visit(auto& v) {
    BacklashParams::Visit(v);
    v.Required("contact_free_damping_Nms_per_rad", contact_free_damping_Nms_per_rad, NonNegative(),
               "c_f, damping while the sides do not touch");
  }
};

/// Laws that divide by c or by c + c_f.
struct PhasePlaneParams : BacklashParams {
  void Check(Faults& faults) const;
};
struct DampedPhasePlaneParams : DampedBacklashParams {
  void Check(Faults& faults) const;
};

class DeadZone : public DeadZoneLaw {
 public:
  using Params = BacklashParams;
  static PluginInfo Info();
  explicit DeadZone(const Params& params) : DeadZoneLaw(params.Numbers()) {}
};
class RevisedDeadZone : public RevisedDeadZoneLaw {
 public:
  using Params = BacklashParams;
  static PluginInfo Info();
  explicit RevisedDeadZone(const Params& params) : RevisedDeadZoneLaw(params.Numbers()) {}
};
class PhasePlane : public PhasePlaneLaw {
 public:
  using Params = PhasePlaneParams;
  static PluginInfo Info();
  explicit PhasePlane(const Params& params) : PhasePlaneLaw(params.Numbers()) {}
};
class DampedDeadZone : public DeadZoneLaw {
 public:
  using Params = DampedBacklashParams;
  static PluginInfo Info();
  explicit DampedDeadZone(const Params& params) : DeadZoneLaw(params.Numbers()) {}
};
class DampedRevisedDeadZone : public RevisedDeadZoneLaw {
 public:
  using Params = DampedBacklashParams;
  static PluginInfo Info();
  explicit DampedRevisedDeadZone(const Params& params) : RevisedDeadZoneLaw(params.Numbers()) {}
};
class DampedPhasePlane : public PhasePlaneLaw {
 public:
  using Params = DampedPhasePlaneParams;
  static PluginInfo Info();
  explicit DampedPhasePlane(const Params& params) : PhasePlaneLaw(params.Numbers()) {}
};
class FullStateBacklash : public FullStateLaw {
 public:
  using Params = DampedPhasePlaneParams;
  static PluginInfo Info();
  explicit FullStateBacklash(const Params& params) : FullStateLaw(params.Numbers()) {}
};

}  // namespace dynoproof::laws
