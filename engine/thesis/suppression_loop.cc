#include "thesis/suppression_loop.h"

#include <algorithm>
#include <cmath>

#include "linear/dense.h"
#include "linear/modal_form.h"
#include "thesis/constants.h"

namespace dynoproof {
namespace {

Result<mechanics::EnergyCoordinates> CoordinatesOf(const SuppressionPlant& plant) {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(plant.network.size(), 2);
  weights.col(0) = plant.airgap;
  weights(plant.load_node, 1) = -1.0;
  return mechanics::EnergyCoordinates::Build(plant.network, weights);
}

/// Inputs T_ref and T_load, outputs T_shaft and omega; the actuator's lag is the last state.
mechanics::LinearSystem WithActuator(const SuppressionPlant& plant, const mechanics::EnergyCoordinates& coordinates) {
  const mechanics::LinearSystem line =
      coordinates.System({coordinates.EdgeTorque(plant.shaft_edge), coordinates.Speed(plant.speed_node)});
  const Eigen::Index n = line.states();
  mechanics::LinearSystem system;
  system.A = Eigen::MatrixXd::Zero(n + 1, n + 1);
  system.A.topLeftCorner(n, n) = line.A;
  system.A.col(n).head(n) = (1.0 - plant.direct) * line.B.col(0);
  system.A(n, n) = -1.0 / plant.tau_a;
  system.B = Eigen::MatrixXd::Zero(n + 1, 2);
  system.B.col(0).head(n) = plant.direct * line.B.col(0);
  system.B.col(1).head(n) = line.B.col(1);
  system.B(n, 0) = 1.0 / plant.tau_a;
  system.C = Eigen::MatrixXd::Zero(2, n + 1);
  system.C.leftCols(n) = line.C;
  system.D = Eigen::MatrixXd::Zero(2, 2);
  system.P = Eigen::MatrixXd::Zero(line.integrators(), n + 1);
  system.P.leftCols(n) = line.P;
  system.E = line.E;
  return system;
}

/// The sampled plant with actuator: x+ = F x + g T_ref, T_shaft = h x.
struct SampledPlant {
  Eigen::MatrixXd F;
  Eigen::VectorXd g;
  Eigen::RowVectorXd h;
};
Result<SampledPlant> Sample(const SuppressionPlant& plant) {
  const Result<mechanics::EnergyCoordinates> coordinates = CoordinatesOf(plant);
  if (!coordinates.ok()) return coordinates.failure();
  const mechanics::LinearSystem system = WithActuator(plant, *coordinates);
  const Eigen::Index n = system.states();
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(n + 1, n + 1);
  rates.topLeftCorner(n, n) = system.A;
  rates.col(n).head(n) = system.B.col(0);
  const Eigen::MatrixXd propagated = dense::Exponential(Eigen::MatrixXd(rates * kPeriod_s));
  return SampledPlant{propagated.topLeftCorner(n, n), propagated.col(n).head(n), system.C.row(0)};
}

/// Solves (z 1 - H) x = g for an upper Hessenberg H, by elimination with row exchanges.
Eigen::VectorXcd SolveShifted(const Eigen::MatrixXd& H, std::complex<double> z, Eigen::VectorXcd g) {
  const Eigen::Index n = H.rows();
  Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> A =
      (-H).cast<std::complex<double>>();
  A.diagonal().array() += z;
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    if (std::abs(A(k + 1, k)) > std::abs(A(k, k))) {
      A.row(k).tail(n - k).swap(A.row(k + 1).tail(n - k));
      std::swap(g[k], g[k + 1]);
    }
    const std::complex<double> factor = A(k + 1, k) / A(k, k);
    A.row(k + 1).tail(n - k) -= factor * A.row(k).tail(n - k);
    g[k + 1] -= factor * g[k];
  }
  return A.triangularView<Eigen::Upper>().solve(g);
}

}  // namespace

SuppressionPlant R2RPlant(double I5, double tau_a) {
  SuppressionPlant plant;
  AddSoftRotor(plant.network, {"I1", 4.813, 8.90e6, 28.4, 70});
  plant.network.nodes.push_back({"I4", 0.137});
  plant.network.nodes.push_back({"I5", I5});
  plant.network.edges.push_back({"k3", 69, 70, 5.76e6, 5.5});
  plant.network.edges.push_back({"k4", 70, 71, 6.37e6, 125.1});
  plant.airgap = Eigen::VectorXd::Zero(72);
  plant.airgap.segment(4, 63).setConstant(1.0 / 63.0);
  plant.load_node = 71;
  plant.shaft_edge = plant.network.FindEdge("k4");
  plant.speed_node = 0;
  plant.tau_a = tau_a;
  return plant;
}

Status SuppressionLoop::Carry(const SuppressionPlant& plant) {
  Result<mechanics::EnergyCoordinates> coordinates = CoordinatesOf(plant);
  if (!coordinates.ok()) return coordinates.failure();
  form_ = mechanics::ModalForm::Build(WithActuator(plant, *coordinates));
  Result<mechanics::Propagator> propagator = mechanics::Propagator::Create(form_, kPeriod_s);
  if (!propagator.ok()) return propagator.failure();
  coordinates_ = std::make_unique<mechanics::EnergyCoordinates>(std::move(*coordinates));
  propagator_ = std::make_unique<mechanics::Propagator>(std::move(*propagator));
  return {};
}

Result<SuppressionLoop> SuppressionLoop::Create(const SuppressionPlant& plant, const control10k::CoreConfig& core,
                                                int delay_samples) {
  if (!control10k::IsUsable(core)) return Failure{"the core's configuration is not usable", "core", {}, 2};
  if (!(plant.tau_a > 0.0) || delay_samples < 0) return Failure{"needs a positive lag and a delay >= 0", "loop", {}, 2};
  SuppressionLoop loop(core);
  if (Status failed = loop.Carry(plant)) return *failed;
  loop.core_.Start(loop.state_);
  loop.x_.assign(static_cast<std::size_t>(loop.form_.state_size()), 0.0);
  loop.delayed_.assign(static_cast<std::size_t>(delay_samples), 0.0);
  return loop;
}

Status SuppressionLoop::ChangePlant(const SuppressionPlant& plant) {
  Eigen::VectorXd x, p;
  form_.GetState(x_, x, p);
  const double lag = x[x.size() - 1];
  Eigen::MatrixXd angles, speeds, next, angles_of_parts;
  coordinates_->ToPhysical(x.head(x.size() - 1), p, angles, speeds);
  if (Status failed = Carry(plant)) return failed;
  coordinates_->FromPhysical(angles, speeds, next, angles_of_parts);
  p = angles_of_parts;
  x.resize(next.size() + 1);
  x << next, lag;
  x_.assign(static_cast<std::size_t>(form_.state_size()), 0.0);
  form_.SetState(x, p, x_);
  return {};
}

void SuppressionLoop::Step(double T_load_Nm, double noise_Nm, double k_V, bool adapt) {
  propagator_->Output(x_, u_, y_);
  double command = core_.Step(state_, {omega_ref_rad_per_s, y_[1], y_[0] + noise_Nm, k_V, adapt});
  if (!delayed_.empty()) {
    std::swap(command, delayed_[oldest_]);
    oldest_ = (oldest_ + 1) % delayed_.size();
  }
  u_[0] = command;
  u_[1] = T_load_Nm;
  propagator_->Advance(x_, u_);
}

Result<std::vector<FilteredLoopMode>> ModesOfStep(const Eigen::MatrixXd& step) {
  const Eigen::VectorXcd values = dense::Eigenvalues(step);
  if (!values.allFinite()) return Failure{"the loop's eigenvalue problem did not converge", "", {}, 3};
  std::vector<FilteredLoopMode> modes;
  for (const std::complex<double>& z : values) {
    if (z.imag() <= 0.0) continue;
    const std::complex<double> s = std::log(z) / kPeriod_s;
    modes.push_back({s.imag() / (kTurn), s.real()});
  }
  std::sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) { return a.growth_per_s > b.growth_per_s; });
  return modes;
}

Eigen::RowVectorXd ThroughNotches(const std::vector<control10k::NotchCoefficients>& notches, Eigen::Index first,
                                  Eigen::RowVectorXd signal, Eigen::MatrixXd& step) {
  for (std::size_t i = 0; i < notches.size(); ++i) {
    const control10k::NotchCoefficients& c = notches[i];
    const Eigen::Index s1 = first + 2 * static_cast<Eigen::Index>(i), s2 = s1 + 1;
    Eigen::RowVectorXd y = c.b0 * signal;
    y[s1] += 1.0;
    step.row(s1) = c.b1 * signal - c.a1 * y;
    step(s1, s2) += 1.0;
    step.row(s2) = c.b2 * signal - c.a2 * y;
    signal = y;
  }
  return signal;
}

Result<std::vector<FilteredLoopMode>> FilteredLoopModes(const SuppressionPlant& plant, double k_V, int delay_samples,
                                                        const std::vector<control10k::NotchCoefficients>& notches) {
  const Result<SampledPlant> sampled = Sample(plant);
  if (!sampled.ok()) return sampled.failure();
  // States: plant, two per filter, then the commands under way. Rows by what feeds them: the filtered torque of this
  // period is a row vector over all states.
  const Eigen::Index n = sampled->F.rows(), f = 2 * static_cast<Eigen::Index>(notches.size()), d = delay_samples;
  const Eigen::Index size = n + f + d;
  Eigen::MatrixXd step = Eigen::MatrixXd::Zero(size, size);
  step.topLeftCorner(n, n) = sampled->F;
  Eigen::RowVectorXd signal = Eigen::RowVectorXd::Zero(size);
  signal.head(n) = sampled->h;
  signal = ThroughNotches(notches, n, signal, step);
  const Eigen::RowVectorXd command = -k_V * signal;
  if (d == 0) {
    step.topRows(n) += sampled->g * command;
  } else {
    step.row(n + f) = command;
    for (Eigen::Index i = 1; i < d; ++i) step(n + f + i, n + f + i - 1) = 1.0;
    step.col(size - 1).head(n) += sampled->g;
  }
  return ModesOfStep(step);
}

Result<std::vector<std::complex<double>>> OpenLoop(const SuppressionPlant& plant, double k_V, int delay_samples,
                                                   const std::vector<control10k::NotchCoefficients>& notches,
                                                   const std::vector<double>& frequencies_Hz) {
  const Result<SampledPlant> sampled = Sample(plant);
  if (!sampled.ok()) return sampled.failure();
  // In Hessenberg coordinates a frequency costs n^2, not n^3.
  const Eigen::HessenbergDecomposition<Eigen::MatrixXd> hessenberg(sampled->F);
  const Eigen::MatrixXd H = hessenberg.matrixH(), Q = hessenberg.matrixQ();
  const Eigen::VectorXcd g = (Q.transpose() * sampled->g).cast<std::complex<double>>();
  const Eigen::RowVectorXcd h = (sampled->h * Q).cast<std::complex<double>>();
  std::vector<std::complex<double>> loop;
  for (const double f : frequencies_Hz) {
    const std::complex<double> z = std::polar(1.0, kTurn * f * kPeriod_s);
    std::complex<double> gain = k_V * (h * SolveShifted(H, z, g))[0] * std::pow(z, -delay_samples);
    for (const control10k::NotchCoefficients& c : notches) {
      gain *= (c.b0 + c.b1 / z + c.b2 / (z * z)) / (1.0 + c.a1 / z + c.a2 / (z * z));
    }
    loop.push_back(gain);
  }
  return loop;
}

}  // namespace dynoproof
