// The loop of chapter 5 with the induction machine and its field-oriented control in the place of the lag, linear about
// standstill without torque: an eigenvalue problem of its own, not the simulation. With rated flux psi along alpha and
// the current i_d, what makes torque is a matter of the imaginary parts (machine: README of induction_machine):
//
//   L_sigma di/dt = u - R_s i - dpsi_b/dt,  dpsi_b/dt = R_R i - (R_R/L_M) psi_b + p w psi,  T = 1.5 p (psi i - i_d psi_b)
//
// A period of the control (control10k/torque_control.h), theta the small angle of its frame, i_q = i - i_d theta:
//
//   nu = p w + R_R i_q/psi,  e = T_ref/(1.5 p psi) - i_q,  u_q = W L_sigma e + I + nu (psi + L_sigma i_d)
//   I+ = I + T_d W R_s e,  theta+ = theta + T_d nu,  u+ = u_q + R_s i_d (theta + 1.5 T_d nu)
//
// u acts over the period after; with `at_once` it acts over this one, and the angle is turned on by half a period only.
// The flux-forming current is no part of it: at standstill it neither sees nor makes torque to first order.
#pragma once

#include <Eigen/Dense>
#include <limits>
#include <vector>

#include "control10k/torque_control.h"
#include "thesis/suppression_loop.h"

namespace dynoproof {

/// The Vascat MAC-QI 250P of Table 2.7 on the DC link of Table 2.8, as scenarios/suppression/_machine.toml has it.
control10k::TorqueConfig VascatDrive(double current_bandwidth_Hz);

/// A third above the highest mode that takes part; those above move a growth rate by less than 0.01 1/s (MachineLoop's test).
inline constexpr double kHighest_Hz = 3000.0;

class MachineLoop {
 public:
  /// `delay_samples`: between the core and the current control. `at_once`: the voltage acts in the period in which it is
  /// computed, which the engine's control leaves to the next. Modes of the line above `highest_Hz` are left out, which
  /// makes searches cheap. The field turns with the plant's speed_node; its lag counts for nothing.
  static Result<MachineLoop> Create(const SuppressionPlant& plant, const control10k::TorqueConfig& drive,
                                    int delay_samples = 0, double highest_Hz = std::numeric_limits<double>::infinity(),
                                    bool at_once = false);

  /// All modes of T_ref = -k_V H_1 .. H_n T_shaft that oscillate, from 1 Hz on, the fastest growing first; without speed
  /// control.
  Result<std::vector<FilteredLoopMode>> Modes(double k_V,
                                              const std::vector<control10k::NotchCoefficients>& notches) const;

 private:
  MachineLoop() = default;

  Eigen::MatrixXd F_;         // line, i, psi_b over a period
  Eigen::VectorXd g_;         // of the held voltage
  Eigen::RowVectorXd shaft_;  // T_shaft
  Eigen::RowVectorXd speed_;  // w, as measured
  control10k::TorqueConfig drive_;
  int delay_samples_ = 0;
  bool at_once_ = false;
};

/// The filters with which the loop is steadiest, as far as a search by steps of 4 to 0.125 Hz from `start_Hz` finds them.
struct SteadiestFilters {
  std::vector<double> f_Hz;
  double growth_per_s;
};
Result<SteadiestFilters> FindSteadiestFilters(const MachineLoop& loop, double k_V, std::vector<double> start_Hz,
                                              double radius = 0.995);

}  // namespace dynoproof
