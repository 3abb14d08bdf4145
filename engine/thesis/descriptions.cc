#include "thesis/descriptions.h"

#include <string>

#include "linear/check.h"
#include "linear/dense.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Differences of neighbours, m - 1 x m: twists = D phi.
MatrixXd Differences(int m) {
  MatrixXd d = MatrixXd::Zero(m - 1, m);
  for (int i = 0; i + 1 < m; ++i) {
    d(i, i) = 1.0;
    d(i, i + 1) = -1.0;
  }
  return d;
}

/// Mixed state [twist_1, w_1, ..., twist_(m-1), w_(m-1), w_m] from [phi_1, w_1, phi_2, w_2, ...], 2 m - 1 x 2 m.
MatrixXd AbsoluteToMixed(int m) {
  MatrixXd t = MatrixXd::Zero(2 * m - 1, 2 * m);
  for (int i = 0; i + 1 < m; ++i) {
    t(2 * i, 2 * i) = 1.0;
    t(2 * i, 2 * i + 2) = -1.0;
    t(2 * i + 1, 2 * i + 1) = 1.0;
  }
  t(2 * m - 2, 2 * m - 1) = 1.0;
  return t;
}

}  // namespace

Result<Chain> ChainOf(const Network& network) {
  if (Status status = CheckNetwork(network)) return *status;
  const int m = network.size();
  if (m < 2 || std::ssize(network.edges) != m - 1) return Failure{"a chain of m nodes has m - 1 edges", "", {}, 2};
  Chain chain{network.Inertias(), VectorXd(m - 1), VectorXd(m - 1)};
  for (int i = 0; i + 1 < m; ++i) {
    const Edge& edge = network.edges[i];
    if (edge.from != i || edge.to != i + 1 || edge.stiffness <= 0.0) {
      return Failure{"a chain needs here a spring from node " + std::to_string(i) + " to the next", edge.name, {}, 2};
    }
    chain.stiffness[i] = edge.stiffness;
    chain.damping[i] = edge.damping;
  }
  return chain;
}

Network NetworkOf(const Chain& chain) {
  Network network;
  for (int i = 0; i < chain.size(); ++i) network.nodes.push_back({"I" + std::to_string(i + 1), chain.inertia[i]});
  for (int i = 0; i + 1 < chain.size(); ++i) {
    network.edges.push_back({"k" + std::to_string(i + 1), i, i + 1, chain.stiffness[i], chain.damping[i]});
  }
  return network;
}

SecondOrder Angles(const Chain& chain, ChainPorts ports) {
  const int m = chain.size();
  const MatrixXd d = Differences(m), inverse = chain.inertia.cwiseInverse().asDiagonal();
  SecondOrder s{-inverse * d.transpose() * chain.stiffness.asDiagonal() * d,
                -inverse * d.transpose() * chain.damping.asDiagonal() * d, VectorXd::Zero(m), d.row(ports.shaft),
                d.row(ports.shaft)};
  s.b[ports.input] = 1.0 / chain.inertia[ports.input];
  s.position *= chain.stiffness[ports.shaft];
  s.rate *= chain.damping[ports.shaft];
  return s;
}

// With x_Delta = D phi and phi'' = -M^-1 D^T (k x_Delta + c x_Delta') + M^-1 b: K_Delta = -D M^-1 D^T diag(k).
SecondOrder Twists(const Chain& chain, ChainPorts ports) {
  const int m = chain.size();
  const MatrixXd d = Differences(m);
  const MatrixXd coupling = -d * chain.inertia.cwiseInverse().asDiagonal() * d.transpose();
  SecondOrder s{coupling * chain.stiffness.asDiagonal(), coupling * chain.damping.asDiagonal(),
                d.col(ports.input) / chain.inertia[ports.input], RowVectorXd::Zero(m - 1), RowVectorXd::Zero(m - 1)};
  s.position[ports.shaft] = chain.stiffness[ports.shaft];
  s.rate[ports.shaft] = chain.damping[ports.shaft];
  return s;
}

FirstOrder Absolute(const Chain& chain, ChainPorts ports) {
  const int m = chain.size();
  const SecondOrder angles = Angles(chain, ports);
  FirstOrder f{MatrixXd::Zero(2 * m, 2 * m), VectorXd::Zero(2 * m), RowVectorXd::Zero(2 * m)};
  for (int i = 0; i < m; ++i) {
    f.A(2 * i, 2 * i + 1) = 1.0;
    for (int j = 0; j < m; ++j) {
      f.A(2 * i + 1, 2 * j) = angles.K(i, j);
      f.A(2 * i + 1, 2 * j + 1) = angles.C(i, j);
    }
    f.b[2 * i + 1] = angles.b[i];
    f.c[2 * i] = angles.position[i];
    f.c[2 * i + 1] = angles.rate[i];
  }
  return f;
}

FirstOrder Differential(const Chain& chain, ChainPorts ports) {
  const int n = chain.size() - 1;
  const SecondOrder twists = Twists(chain, ports);
  FirstOrder f{MatrixXd::Zero(2 * n, 2 * n), VectorXd::Zero(2 * n), RowVectorXd::Zero(2 * n)};
  for (int i = 0; i < n; ++i) {
    f.A(2 * i, 2 * i + 1) = 1.0;
    for (int j = 0; j < n; ++j) {
      f.A(2 * i + 1, 2 * j) = twists.K(i, j);
      f.A(2 * i + 1, 2 * j + 1) = twists.C(i, j);
    }
    f.b[2 * i + 1] = twists.b[i];
    f.c[2 * i] = twists.position[i];
    f.c[2 * i + 1] = twists.rate[i];
  }
  return f;
}

FirstOrder Mixed(const Chain& chain, ChainPorts ports) {
  const int m = chain.size(), n = 2 * m - 1;
  const auto speed = [m](int i) { return i + 1 < m ? 2 * i + 1 : 2 * m - 2; };
  FirstOrder f{MatrixXd::Zero(n, n), VectorXd::Zero(n), RowVectorXd::Zero(n)};
  for (int i = 0; i + 1 < m; ++i) {
    const double k = chain.stiffness[i], c = chain.damping[i];
    f.A(2 * i, speed(i)) = 1.0;
    f.A(2 * i, speed(i + 1)) = -1.0;
    // The shaft brakes node i and drives node i + 1.
    for (const int node : {i, i + 1}) {
      const double sign = (node == i ? -1.0 : 1.0) / chain.inertia[node];
      f.A(speed(node), 2 * i) += sign * k;
      f.A(speed(node), speed(i)) += sign * c;
      f.A(speed(node), speed(i + 1)) -= sign * c;
    }
  }
  f.b[speed(ports.input)] = 1.0 / chain.inertia[ports.input];
  f.c[2 * ports.shaft] = chain.stiffness[ports.shaft];
  f.c[speed(ports.shaft)] = chain.damping[ports.shaft];
  f.c[speed(ports.shaft + 1)] = -chain.damping[ports.shaft];
  return f;
}

MatrixXd AbsoluteToDifferential(int m) {
  MatrixXd t = MatrixXd::Zero(2 * m, 2 * m);
  t.topLeftCorner(2, 2).setIdentity();
  const int n = 2 * m - 2;
  t.bottomLeftCorner(n, n).setIdentity();
  t.bottomRightCorner(n, n) -= MatrixXd::Identity(n, n);
  return t;
}

// With x_m = S x_a and [w_1, x_d] = T' x_a, Z S = T' has the solution Z = T' S^+: neither sees a common angle, so both
// have the same null space.
MatrixXd MixedToDifferential(int m) {
  const int n = 2 * m - 1;
  const MatrixXd t = AbsoluteToDifferential(m), s = AbsoluteToMixed(m);
  return t.bottomRows(n) * dense::PseudoInverse(s);
}

MatrixXd SortAnglesFirst(int m) {
  MatrixXd p = MatrixXd::Zero(2 * m, 2 * m);
  for (int i = 0; i < m; ++i) {
    p(i, 2 * i) = 1.0;
    p(m + i, 2 * i + 1) = 1.0;
  }
  return p;
}

MatrixXd Companion(const SecondOrder& description) {
  const Eigen::Index n = description.K.rows();
  MatrixXd a = MatrixXd::Zero(2 * n, 2 * n);
  a.topRightCorner(n, n).setIdentity();
  a.bottomLeftCorner(n, n) = description.K;
  a.bottomRightCorner(n, n) = description.C;
  return a;
}

}  // namespace dynoproof::mechanics
