// The independent reference for exact propagation: one dense matrix exponential in extended precision.
#pragma once

#include <Eigen/Dense>
#include <algorithm>

#include "linear/dense.h"
#include "linear/linear_system.h"
#include "linear/network.h"

namespace dynoproof::support {

using dense::MatrixXld;
using VectorXld = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// s' = A s + B u over one interval: s+ = phi s + held u0 + ramp du, all in long double.
struct HeldReference {
  MatrixXld phi, held, ramp;

  HeldReference(const MatrixXld& A, const MatrixXld& B, long double h) {
    const Eigen::Index n = A.rows(), m = B.cols();
    // exp [A B 0; 0 0 I/h; 0 0 0] h: the last block column integrates an input that rises to 1 over the interval.
    MatrixXld augmented = MatrixXld::Zero(n + 2 * m, n + 2 * m);
    augmented.topLeftCorner(n, n) = A * h;
    augmented.block(0, n, n, m) = B * h;
    augmented.bottomRightCorner(2 * m, 2 * m).topRightCorner(m, m).setIdentity();
    const MatrixXld exponential = dense::Exponential(augmented);
    phi = exponential.topLeftCorner(n, n);
    held = exponential.block(0, n, n, m);
    ramp = exponential.block(0, n + m, n, m);
  }
};

/// A linear system with its integrators as ordinary states s = (x, p), in long double.
struct ReferenceSystem {
  MatrixXld A, B, C, D;  // y = C s + D u

  explicit ReferenceSystem(const mechanics::LinearSystem& system) {
    const int n = system.states(), q = system.integrators(), m = system.inputs(), r = system.outputs();
    A = MatrixXld::Zero(n + q, n + q);
    A.topLeftCorner(n, n) = system.A.cast<long double>();
    A.bottomLeftCorner(q, n) = system.P.cast<long double>();
    B = MatrixXld::Zero(n + q, m);
    B.topRows(n) = system.B.cast<long double>();
    C.resize(r, n + q);
    C << system.C.cast<long double>(), system.E.cast<long double>();
    D = system.D.cast<long double>();
  }

  /// A network straight from its equations of motion, s = (w0 M^1/2 phi, M^1/2 w): scaled, so that the exponential
  /// stays well conditioned, and nothing of EnergyCoordinates in it. Outputs are the torques of the edges.
  ReferenceSystem(const mechanics::Network& network, const Eigen::MatrixXd& torque_weights) {
    const int n = network.size(), edges = static_cast<int>(network.edges.size());
    const VectorXld root = network.Inertias().cast<long double>().cwiseSqrt();
    const MatrixXld incidence = network.Incidence().cast<long double>();
    VectorXld k(edges), c(edges);
    for (int e = 0; e < edges; ++e) {
      k[e] = network.edges[e].stiffness;
      c[e] = network.edges[e].damping;
    }
    const MatrixXld strain = incidence * root.cwiseInverse().asDiagonal();
    const MatrixXld stiffness = strain.transpose() * k.asDiagonal() * strain;
    const long double w0 = std::max(1.0L, std::sqrt(stiffness.diagonal().maxCoeff()));
    A = MatrixXld::Zero(2 * n, 2 * n);
    A.topRightCorner(n, n) = w0 * MatrixXld::Identity(n, n);
    A.bottomLeftCorner(n, n) = -stiffness / w0;
    A.bottomRightCorner(n, n) = -(strain.transpose() * c.asDiagonal() * strain);
    B = MatrixXld::Zero(2 * n, torque_weights.cols());
    B.bottomRows(n) = root.cwiseInverse().asDiagonal() * torque_weights.cast<long double>();
    C.resize(edges, 2 * n);
    C << k.asDiagonal() * strain / w0, c.asDiagonal() * strain;
    D = MatrixXld::Zero(edges, torque_weights.cols());
  }
};

}  // namespace dynoproof::support
