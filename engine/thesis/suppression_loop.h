// The loop of chapter 5, closed as fast as it goes: a drive line carried exactly in modal coordinates, a first-order
// actuator, and the 10 kHz core. What the robustness campaign, the benchmarks and the studies of the ledger step
// through; scenarios run the same core through the engine.
//
// A step is a period: sample shaft torque and speed, core, command held (after `delay_samples` periods), plant.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <memory>
#include <vector>

#include "base/status.h"
#include "control10k/core.h"
#include "linear/aligned_vector.h"
#include "linear/energy_coordinates.h"
#include "linear/network.h"
#include "linear/propagator.h"

namespace dynoproof {

/// A drive line with an airgap torque, a load torque that brakes, a measured shaft and a measured speed.
struct SuppressionPlant {
  mechanics::Network network;
  Eigen::VectorXd airgap;  // weights over the nodes
  int load_node = 0, shaft_edge = 0, speed_node = 0;
  double tau_a = 1e-3;  // [s], > 0: T_airgap = direct T_ref + (1 - direct) x, tau_a x' = T_ref - x
  double direct = 0.0;  // 0: the plain lag (2.4); above: a part of the torque follows at once
};

/// Table A.7 of the thesis: the R2R soft rotor of 70 slices, the airgap torque on slices 5 to 67, the load on I5, whose
/// inertia is 0.081 kg m^2 in the first setup, 0.171 and 0.311 with the test flanges.
SuppressionPlant R2RPlant(double I5 = 0.081, double tau_a = 1e-3);

class SuppressionLoop {
 public:
  static Result<SuppressionLoop> Create(const SuppressionPlant& plant, const control10k::CoreConfig& core,
                                        int delay_samples = 0);

  /// One period with these held: load torque, noise on the measured torque, gain, adaptation.
  void Step(double T_load_Nm, double noise_Nm, double k_V, bool adapt);

  /// Goes on with another plant of the same structure: angles and speeds stay, whatever carried them.
  Status ChangePlant(const SuppressionPlant& plant);

  double T_shaft_Nm() const { return y_[0]; }  // as it was sampled in the last step, without noise
  double omega_rad_per_s() const { return y_[1]; }
  double T_ref_Nm() const { return state_.T_ref_Nm; }
  double omega_ref_rad_per_s = 0.0;
  const control10k::CoreState& core_state() const { return state_; }
  control10k::CoreState& core_state() { return state_; }
  const control10k::Core& core() const { return core_; }
  const mechanics::Propagator& propagator() const { return *propagator_; }

 private:
  explicit SuppressionLoop(const control10k::CoreConfig& core) : core_(core) {}
  Status Carry(const SuppressionPlant& plant);

  control10k::Core core_;
  control10k::CoreState state_;
  std::unique_ptr<mechanics::EnergyCoordinates> coordinates_;
  mechanics::ModalForm form_;
  std::unique_ptr<mechanics::Propagator> propagator_;
  mechanics::AlignedVector x_;
  std::vector<double> delayed_;  // commands under way, oldest at `oldest_`
  std::size_t oldest_ = 0;
  double u_[2] = {0.0, 0.0}, y_[2] = {0.0, 0.0};
};

/// One mode of the sampled loop with filters in the feedback: s = log(z) / T_d.
struct FilteredLoopMode {
  double frequency_hz, growth_per_s;
};
/// The modes of a step x+ = S x of 100 us, the fastest growing first.
Result<std::vector<FilteredLoopMode>> ModesOfStep(const Eigen::MatrixXd& step);

/// Leads a signal, a row over all states, through notch filters (transposed form: y = b0 u + s1) whose states begin at
/// `first`: writes their rows of the step and returns what leaves them.
Eigen::RowVectorXd ThroughNotches(const std::vector<control10k::NotchCoefficients>& notches, Eigen::Index first,
                                  Eigen::RowVectorXd signal, Eigen::MatrixXd& step);

/// All oscillatory modes of the loop T_ref = -k_V H_1 .. H_n T_shaft, the fastest growing first; without speed control.
/// An eigenvalue problem of its own, not the simulation.
Result<std::vector<FilteredLoopMode>> FilteredLoopModes(const SuppressionPlant& plant, double k_V, int delay_samples,
                                                        const std::vector<control10k::NotchCoefficients>& notches);

/// The open loop from T_ref to k_V T_shaft at a frequency, sampled and held: L(e^(j 2 pi f T_d)), filters included. The
/// loop closes with a minus, so it oscillates where L = -1.
Result<std::vector<std::complex<double>>> OpenLoop(const SuppressionPlant& plant, double k_V, int delay_samples,
                                                   const std::vector<control10k::NotchCoefficients>& notches,
                                                   const std::vector<double>& frequencies_Hz);

}  // namespace dynoproof
