// The transfer function of a network from a torque, spread over the nodes by weights, to a shaft torque, a speed or an
// angle; its practical resonances (thesis Sec. 2.2.2).
#pragma once

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <complex>
#include <optional>
#include <vector>

#include "base/status.h"
#include "linear/forest.h"
#include "linear/network.h"

namespace dynoproof::mechanics {

enum class OutputKind { kEdgeTorque, kSpeed, kAngle };

/// What is looked at: the torque k twist + c rate of an edge [N m], or the speed [rad/s] or angle [rad] of a node.
struct Output {
  OutputKind kind;
  int index;  // of the edge or node
};

/// G(s) = output / input, s in rad/s. Build once, evaluate often; a network without meshes costs O(n) for each s.
class TransferFunction {
 public:
  /// `input`: n weights, the torque on each node per unit of the input [-]. Fails (exit code 2) as CheckNetwork does,
  /// on a wrong number of weights, weights that are not finite, and an output that does not exist.
  static Result<TransferFunction> Build(const Network& network, const Eigen::VectorXd& input, const Output& output);

  /// G(s). Exact also for small s, where a free network turns as a whole; without meshes shaft torques have a value at
  /// s = 0, too. Infinity or NaN at poles: speeds and angles at s = 0, undamped modes met exactly.
  std::complex<double> At(std::complex<double> s) const;
  std::complex<double> AtFrequency(double frequency_hz) const;
  Eigen::VectorXcd AtFrequencies(const Eigen::VectorXd& frequencies_hz) const;

  /// The same by a sparse LU factorisation with pivoting for any network: the reference of the tree recursion, used
  /// for meshes and wherever the recursion would lose digits.
  std::complex<double> BySparseLu(std::complex<double> s) const;

  const Network& network() const { return network_; }
  const Eigen::VectorXd& input() const { return input_; }
  const Output& output() const { return output_; }

 private:
  TransferFunction(Network network, Eigen::VectorXd input, Output output);
  std::complex<double> Pick(const Eigen::VectorXcd& acceleration, std::complex<double> s) const;

  Network network_;
  Eigen::VectorXd input_;
  Output output_;
  Eigen::VectorXd inertias_;
  std::optional<Forest> forest_;
};

/// One practical resonance: a local maximum of abs(G(2 pi j f)).
struct Resonance {
  double frequency_hz;
  double gain;     // abs(G) there; what the search met next to the pole where `unbounded`
  bool unbounded;  // an undamped mode (damping ratio below 1e-9): the maximum is a pole
};

/// All practical resonances strictly between two frequencies, rising, to 1e-6 relative or better in frequency. Found on
/// a grid that is dense around every damped eigenvalue (in steps of a part of its distance from the axis), then refined
/// by bracketed minimisation of -log abs(G). Fails as Modes does and (2) on an empty or non-finite range.
Result<std::vector<Resonance>> PracticalResonances(const TransferFunction& transfer, double from_hz, double to_hz);

}  // namespace dynoproof::mechanics
