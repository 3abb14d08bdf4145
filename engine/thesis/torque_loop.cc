#include "thesis/torque_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "linear/dense.h"
#include "linear/frequency_response.h"
#include "linear/modes.h"
#include "linear/state_space.h"

namespace dynoproof::mechanics {

using Eigen::MatrixXd;

Result<std::vector<LoopMode>> TorqueLoopModes(const Network& network, const Eigen::VectorXd& input, int shaft,
                                              const TorqueLoop& loop) {
  const Output output{OutputKind::kEdgeTorque, shaft};
  const Result<TransferFunction> checked = TransferFunction::Build(network, input, output);
  if (!checked.ok()) return checked.failure();
  const bool sound = loop.tau_a > 0.0 && loop.period_s > 0.0 && loop.delay_samples >= 0 && std::isfinite(loop.tau_a) &&
                     std::isfinite(loop.period_s) && std::isfinite(loop.feedthrough);
  if (!sound) return Failure{"the loop needs a positive lag and period and a delay that is not negative", "", {}, 2};
  const Result<ModalAnalysis> modal = Modes(network);
  if (!modal.ok()) return modal.failure();
  const EnergyStateSpace plant = AssembleStateSpace(network, input, output, *modal);

  // States x, T_airgap and the held reference, over one period.
  const Eigen::Index n = plant.h.size(), delay = loop.delay_samples;
  MatrixXd rates = MatrixXd::Zero(n + 2, n + 2);
  rates.topLeftCorner(n, n) = plant.a;
  rates.col(n).head(n) = plant.b;
  rates(n, n) = -1.0 / loop.tau_a;
  rates(n, n + 1) = 1.0 / loop.tau_a;
  const MatrixXd propagated = dense::Exponential(MatrixXd(rates * loop.period_s));
  const MatrixXd step = propagated.topLeftCorner(n + 1, n + 1);
  const Eigen::VectorXd held = propagated.col(n + 1).head(n + 1);

  // Behind them the delay line of the output, newest first; without delay the output is fed back at once.
  Eigen::RowVectorXd shaft_torque = Eigen::RowVectorXd::Zero(n + 1);
  shaft_torque.head(n) = plant.h;
  MatrixXd period = MatrixXd::Zero(n + 1 + delay, n + 1 + delay);
  period.topLeftCorner(n + 1, n + 1) = step;
  if (delay == 0) {
    period += loop.feedthrough * held * shaft_torque;
  } else {
    period.col(n + delay).head(n + 1) = loop.feedthrough * held;
    period.row(n + 1).head(n + 1) = shaft_torque;
    for (Eigen::Index i = 1; i < delay; ++i) period(n + 1 + i, n + i) = 1.0;
  }
  const Eigen::VectorXcd values = dense::Eigenvalues(period);
  if (!values.allFinite()) return Failure{"the loop's eigenvalue problem did not converge", "", {}, 3};
  std::vector<LoopMode> modes;
  for (const std::complex<double>& z : values) {
    if (z.imag() < 0.0 || z == 0.0) continue;
    const std::complex<double> s = std::log(z) / loop.period_s;
    modes.push_back({s.imag() / (2.0 * std::numbers::pi), s.real(), z});
  }
  std::sort(modes.begin(), modes.end(),
            [](const LoopMode& a, const LoopMode& b) { return a.growth_per_s > b.growth_per_s; });
  return modes;
}

}  // namespace dynoproof::mechanics
