#include "linear/zero_dynamics.h"

#include <cmath>
#include <optional>

#include "linear/dense.h"
#include "linear/modes.h"
#include "linear/state_space.h"

namespace dynoproof::mechanics {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Confines the state to output = 0 until the input acts on the output directly, then closes the zeroing feedback;
/// returns the number of differentiations (the relative degree), or nothing when the input never arrives.
std::optional<int> ZeroDynamics(EnergyStateSpace& system) {
  const double scale = system.a.norm();
  int degree = 1;
  while (true) {
    const double norm = system.h.norm();
    if (!(norm > 0.0) || system.b.norm() == 0.0 || system.h.size() == 0) return std::nullopt;
    system.h /= norm;
    const Eigen::Index m = system.h.size();
    // Reflection that turns h into the first axis: the other axes span output = 0.
    VectorXd v = system.h.transpose();
    v[0] += v[0] >= 0.0 ? 1.0 : -1.0;
    const double factor = 2.0 / v.squaredNorm();
    const auto reflect_rows = [&](auto& matrix) { matrix -= (factor * v) * (v.transpose() * matrix).eval(); };
    const auto reflect_columns = [&](auto& matrix) { matrix -= (matrix * v).eval() * (factor * v.transpose()); };
    const double gain = system.h.dot(system.b);
    RowVectorXd derivative = system.h * system.a;
    reflect_columns(derivative);
    reflect_rows(system.a);
    reflect_columns(system.a);
    reflect_rows(system.b);
    const RowVectorXd rest = derivative.tail(m - 1);
    const VectorXd b = system.b.tail(m - 1);
    MatrixXd a = system.a.bottomRightCorner(m - 1, m - 1);
    if (std::abs(gain) > kDirectTerm * system.b.norm()) {
      system = {a - b * (rest / gain), b, rest, system.left_out};
      return degree;
    }
    if (!(rest.norm() > 1e-12 * scale)) return std::nullopt;  // round-off of products of size `scale`
    system = {std::move(a), b, rest, system.left_out};
    ++degree;
  }
}

/// Newton steps on G; kept while they are small and G shrinks.
Complex Polish(const TransferFunction& transfer, Complex s) {
  Complex value = transfer.At(s);
  for (int i = 0; i < 8; ++i) {
    const double h = 1e-6 * std::abs(s);
    const Complex slope = (transfer.At(s + h) - transfer.At(s - h)) / (2.0 * h);
    const Complex next = s - value / slope;
    if (!(std::abs(next - s) <= 1e-4 * std::abs(s))) break;
    const Complex next_value = transfer.At(next);
    if (!(std::abs(next_value) < std::abs(value))) break;
    s = next;
    value = next_value;
  }
  return s;
}

}  // namespace

Status ProjectedRoots(const Network& network, const VectorXd& input, const Output& output,
                      std::vector<Complex>& roots) {
  const Result<TransferFunction> transfer = TransferFunction::Build(network, input, output);
  if (!transfer.ok()) return transfer.failure();
  const Result<ModalAnalysis> modal = Modes(network);
  if (!modal.ok()) return modal.failure();
  EnergyStateSpace system = AssembleStateSpace(network, input, output, *modal);
  // The state space has det / s^rigid as its characteristic polynomial, less another s for each state left out.
  int at_origin = modal->rigid + system.left_out;
  if (output.kind == OutputKind::kAngle && modal->rigid > 0) --at_origin;  // the speed's own s
  if (!ZeroDynamics(system)) return Failure{"the input does not reach the output", "", {}, 2};
  roots.insert(roots.end(), static_cast<std::size_t>(at_origin), 0.0);
  if (system.a.size() == 0) return std::nullopt;
  const Eigen::VectorXcd values = dense::Eigenvalues(system.a);
  if (!values.allFinite()) {
    return Failure{"the eigenvalue problem of the zeros did not converge", "", {}, 3};
  }
  for (const Complex& s : values) {
    if (s.imag() == 0.0) roots.push_back(s);
    if (s.imag() <= 0.0) continue;
    const Complex polished = Polish(*transfer, s);
    roots.push_back(polished);
    roots.push_back(std::conj(polished));
  }
  return std::nullopt;
}

}  // namespace dynoproof::mechanics
