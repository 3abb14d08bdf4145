#include "thesis/machine_loop.h"

#include <algorithm>
#include <cmath>

#include "linear/dense.h"
#include "linear/energy_coordinates.h"
#include "plugins/plant/induction_machine/rating.h"
#include "thesis/constants.h"

namespace dynoproof {
namespace {

/// The states (W q, q', w_rigid) of a line up to a frequency.
std::vector<Eigen::Index> StatesUpTo(const mechanics::EnergyCoordinates& coordinates, double highest_Hz) {
  std::vector<Eigen::Index> kept;
  const Eigen::Index modes = coordinates.elastic_modes();
  for (Eigen::Index half = 0; half < 2; ++half) {
    for (Eigen::Index i = 0; i < modes; ++i) {
      if (coordinates.frequencies()[i] <= kTurn * highest_Hz) kept.push_back(half * modes + i);
    }
  }
  for (Eigen::Index i = 2 * modes; i < coordinates.states(); ++i) kept.push_back(i);
  return kept;
}

}  // namespace

control10k::TorqueConfig VascatDrive(double current_bandwidth_Hz) {
  Rating plate;
  plate.rated_torque_Nm = 3200.0;
  plate.rated_speed_rad_per_s = 117.6;
  plate.rated_voltage_V = 400.0;
  plate.rated_current_A = 715.0;
  plate.pole_pairs = 3;
  plate.slip = 0.01;
  plate.efficiency = 0.95;
  plate.magnetising_share = 0.35;
  control10k::TorqueConfig drive;
  plate.Derive(drive.machine);
  drive.current_bandwidth_Hz = current_bandwidth_Hz;
  drive.dc_link_V = 630.0;
  return drive;
}

Result<MachineLoop> MachineLoop::Create(const SuppressionPlant& plant, const control10k::TorqueConfig& drive,
                                        int delay_samples, double highest_Hz, bool at_once) {
  if (!control10k::IsUsable(drive) || drive.period_s != kPeriod_s || delay_samples < 0) {
    return Failure{"needs a usable drive with a period of 100 us and a delay >= 0", "loop", {}, 2};
  }
  const Result<mechanics::EnergyCoordinates> coordinates =
      mechanics::EnergyCoordinates::Build(plant.network, plant.airgap);
  if (!coordinates.ok()) return coordinates.failure();
  const mechanics::LinearSystem line =
      coordinates->System({coordinates->EdgeTorque(plant.shaft_edge), coordinates->Speed(plant.speed_node)});
  const std::vector<Eigen::Index> kept = StatesUpTo(*coordinates, highest_Hz);
  const auto n = static_cast<Eigen::Index>(kept.size());
  const control10k::MachineModel& m = drive.machine;
  const double p = m.pole_pairs, psi = m.rated_flux, i_d = m.rated_i_d;

  // States: line, i, psi_b; then the held voltage.
  const Eigen::Index i = n, psi_b = n + 1, u = n + 2;
  const Eigen::MatrixXd C = line.C(Eigen::all, kept);
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(n + 3, n + 3);
  rates.topLeftCorner(n, n) = line.A(kept, kept);
  rates.col(i).head(n) = 1.5 * p * psi * line.B(kept, 0);
  rates.col(psi_b).head(n) = -1.5 * p * i_d * line.B(kept, 0);
  rates.row(psi_b).head(n) = p * psi * C.row(1);
  rates(psi_b, i) = m.R_R;
  rates(psi_b, psi_b) = -m.rotor_rate();
  rates.row(i) = -rates.row(psi_b);
  rates(i, i) -= m.R_s;
  rates(i, u) = 1.0;
  rates.row(i) /= m.L_sigma;
  const Eigen::MatrixXd propagated = dense::Exponential(Eigen::MatrixXd(rates * drive.period_s));

  MachineLoop loop;
  loop.F_ = propagated.topLeftCorner(n + 2, n + 2);
  loop.g_ = propagated.col(u).head(n + 2);
  loop.shaft_ = loop.speed_ = Eigen::RowVectorXd::Zero(n + 2);
  loop.shaft_.head(n) = C.row(0);
  loop.speed_.head(n) = C.row(1);
  loop.drive_ = drive;
  loop.delay_samples_ = delay_samples;
  loop.at_once_ = at_once;
  return loop;
}

Result<std::vector<FilteredLoopMode>> MachineLoop::Modes(
    double k_V, const std::vector<control10k::NotchCoefficients>& notches) const {
  const control10k::MachineModel& m = drive_.machine;
  const double T_d = drive_.period_s, W = kTurn * drive_.current_bandwidth_Hz, psi = m.rated_flux, i_d = m.rated_i_d;
  // States: line with machine, two per filter, the control's integral, next voltage and angle, the commands under way.
  const Eigen::Index n = F_.rows(), integral = n + 2 * static_cast<Eigen::Index>(notches.size());
  const Eigen::Index next = integral + 1, theta = integral + 2, delay = integral + 3, size = delay + delay_samples_;
  const auto state = [size](Eigen::Index index) { return Eigen::RowVectorXd::Unit(size, index); };
  Eigen::MatrixXd step = Eigen::MatrixXd::Zero(size, size);
  step.topLeftCorner(n, n) = F_;
  Eigen::RowVectorXd signal = Eigen::RowVectorXd::Zero(size), w = signal;
  signal.head(n) = shaft_;
  w.head(n) = speed_;
  Eigen::RowVectorXd T_ref = -k_V * ThroughNotches(notches, n, signal, step);
  for (int d = 0; d < delay_samples_; ++d) {
    step.row(delay + d) = T_ref;
    T_ref = state(delay + d);
  }
  const Eigen::RowVectorXd i_q = state(n - 2) - i_d * state(theta);
  const Eigen::RowVectorXd nu = m.pole_pairs * w + m.R_R / psi * i_q;
  const Eigen::RowVectorXd error = T_ref / m.TorquePerAmpere(psi) - i_q;
  const Eigen::RowVectorXd u_q = W * m.L_sigma * error + state(integral) + (psi + m.L_sigma * i_d) * nu;
  step.row(integral) = state(integral) + T_d * W * m.R_s * error;
  const Eigen::RowVectorXd u = u_q + m.R_s * i_d * (state(theta) + (at_once_ ? 0.5 : 1.5) * T_d * nu);
  step.topRows(n) += g_ * (at_once_ ? u : state(next));
  step.row(next) = u;
  step.row(theta) = state(theta) + T_d * nu;
  Result<std::vector<FilteredLoopMode>> modes = ModesOfStep(step);
  // The angles of the line and of the frame are free: a double eigenvalue 1, which round-off may part into a pair.
  if (modes.ok()) std::erase_if(*modes, [](const FilteredLoopMode& mode) { return mode.frequency_hz < 1.0; });
  return modes;
}

Result<SteadiestFilters> FindSteadiestFilters(const MachineLoop& loop, double k_V, std::vector<double> start_Hz,
                                              double radius) {
  const auto growth = [&](const std::vector<double>& f_Hz) -> Result<double> {
    std::vector<control10k::NotchCoefficients> notches;
    for (const double f : f_Hz) {
      control10k::NotchCoefficients c;
      if (!control10k::DesignNotch(kTurn * f * kPeriod_s, radius, c)) return std::numeric_limits<double>::infinity();
      notches.push_back(c);
    }
    const auto modes = loop.Modes(k_V, notches);
    if (!modes.ok()) return modes.failure();
    return modes->front().growth_per_s;
  };
  Result<double> least = growth(start_Hz);
  if (!least.ok()) return least.failure();
  SteadiestFilters best{std::move(start_Hz), *least};
  // The largest of several rates has creases, along which few directions lead down: every filter moves by up to two steps.
  for (double step_Hz = 4.0; step_Hz >= 0.125; step_Hz *= 0.5) {
    for (bool moved = true; moved;) {
      moved = false;
      int directions = 1;
      for (std::size_t i = 0; i < best.f_Hz.size(); ++i) directions *= 5;
      for (int direction = 0; direction < directions; ++direction) {
        std::vector<double> tried = best.f_Hz;
        int digits = direction;  // to the base of five
        for (double& f : tried) {
          f += step_Hz * (digits % 5 - 2);
          digits /= 5;
        }
        const Result<double> now = growth(tried);
        if (!now.ok()) return now.failure();
        if (*now < best.growth_per_s - 1e-9) {
          best = {std::move(tried), *now};
          moved = true;
        }
      }
    }
  }
  return best;
}

}  // namespace dynoproof
