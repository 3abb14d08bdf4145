#include "linear/block_diagonal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <random>
#include <vector>

#include "linear/block_cascade.h"
#include "linear/block_newton.h"
#include "linear/decompositions.h"
#include "linear/dense.h"
#include "linear/energy_coordinates.h"
#include "tests/support/plants.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;

MatrixXd NetworkMatrix(const Network& network) {
  const auto coordinates = EnergyCoordinates::Build(network, MatrixXd::Zero(network.size(), 1));
  EXPECT_TRUE(coordinates.ok());
  return coordinates->System({}).A;
}

/// A T = T L and T^-1 T = 1, to round-off of the condition that the form claims.
void ExpectDecomposes(const MatrixXd& A, const BlockDiagonal& form) {
  const double round_off = 1e-13 * form.condition;
  EXPECT_LE((A * form.T - form.T * form.L).norm(), round_off * A.norm() * form.T.norm()) << form.Summary();
  EXPECT_LE((form.T_inverse * form.T - MatrixXd::Identity(A.rows(), A.cols())).norm(),
            round_off * static_cast<double>(form.T.rows()));
  MatrixXd outside = form.L;
  int states = 0;
  for (const auto& block : form.blocks) {
    EXPECT_EQ(block.first, states);
    states += block.size;
    const MatrixXd own = form.L.block(block.first, block.first, block.size, block.size);
    outside.block(block.first, block.first, block.size, block.size).setZero();
    if (!block.pair) continue;
    EXPECT_EQ(own(0, 0), own(1, 1));
    EXPECT_EQ(own(0, 1), -own(1, 0));
    EXPECT_GT(own(0, 1), 0.0);
  }
  EXPECT_EQ(states, A.rows());
  EXPECT_EQ(outside.cwiseAbs().maxCoeff(), 0.0);
}

TEST(BlockDiagonal, SoftRotorHas71PairsAndAnExactlyFreeBody) {
  const MatrixXd A = NetworkMatrix(support::SoftRotorR2R());
  const BlockDiagonal form = BlockDiagonalise(A);
  ExpectDecomposes(A, form);
  EXPECT_EQ(form.pairs(), 71);
  ASSERT_EQ(form.blocks.size(), 72u);
  EXPECT_EQ(form.L(142, 142), 0.0);
  EXPECT_FALSE(form.dense_fallback);
  EXPECT_LT(form.condition, 5.0);  // damping turns the undamped modes a little only
}

/// x with M x = b, by Gaussian elimination with pivoting by columns. Eigen's decompositions of long double would take a quarter of
/// a minute to compile.
std::vector<std::complex<long double>> Solve(std::vector<std::vector<std::complex<long double>>> M,
                                             std::vector<std::complex<long double>> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i) pivot = std::abs(M[i][k]) > std::abs(M[pivot][k]) ? i : pivot;
    std::swap(M[k], M[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const std::complex<long double> factor = M[i][k] / M[k][k];
      for (std::size_t j = k; j < n; ++j) M[i][j] -= factor * M[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= M[k][j] * b[j];
    b[k] /= M[k][k];
  }
  return b;
}

/// The eigenvalue of A next to `near`, by inverse iteration in extended precision.
std::complex<long double> EigenvalueNear(const MatrixXd& A, std::complex<double> near) {
  const auto n = static_cast<std::size_t>(A.rows());
  std::complex<long double> value = near;
  value *= 1.0L + 1e-9L;  // off the value itself, where the matrix would be singular
  std::vector<std::vector<std::complex<long double>>> shifted(n, std::vector<std::complex<long double>>(n));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) shifted[i][j] = A(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    shifted[i][i] -= value;
  }
  std::vector<std::complex<long double>> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = std::polar(1.0L, static_cast<long double>(i));
  std::complex<long double> found = 0.0L;
  for (int pass = 0; pass < 6; ++pass) {
    const std::vector<std::complex<long double>> y = Solve(shifted, x);
    const auto largest = static_cast<std::size_t>(
        std::max_element(y.begin(), y.end(), [](auto a, auto b) { return std::abs(a) < std::abs(b); }) - y.begin());
    found = value + x[largest] / y[largest];
    for (std::size_t i = 0; i < n; ++i) x[i] = y[i] / y[largest];
  }
  return found;
}

TEST(BlockDiagonal, RefinementReachesTheLastBits) {
  const MatrixXd A = NetworkMatrix(support::SoftRotorR2R(20));
  const BlockDiagonal form = BlockDiagonalise(A);
  double worst = 0.0;
  for (const auto& block : form.blocks) {
    if (!block.pair) continue;
    const std::complex<double> value(form.L(block.first, block.first), form.L(block.first, block.first + 1));
    const std::complex<long double> exact = EigenvalueNear(A, value);
    worst = std::max(worst, static_cast<double>(std::abs(exact - std::complex<long double>(value)) / std::abs(exact)));
  }
  EXPECT_LE(worst, 5e-16);  // storing a and b rounds by 1.1e-16; measured 0.9e-16, 2.5e-15 without the refinement
}

TEST(BlockDiagonal, ANetworksPairsAreFoundWithoutASchurForm) {
  const MatrixXd A = NetworkMatrix(support::SoftRotorR2R());
  const std::optional<BlockDiagonal> near = FromPairs(A);
  ASSERT_TRUE(near);
  ExpectDecomposes(A, *near);
  // The eigenvalues by another way; each to its last bits, though they span five decades.
  Eigen::VectorXcd other = dense::Eigenvalues(A);
  for (const auto& block : near->blocks) {
    const std::complex<double> own(near->L(block.first, block.first),
                                   block.pair ? near->L(block.first, block.first + 1) : 0.0);
    EXPECT_LT((other.array() - own).abs().minCoeff(), 1e-13 * A.norm());
  }
}

TEST(Decompositions, GivesWhatItMadeBeforeAndForgetsTheOldest) {
  const MatrixXd A = NetworkMatrix(support::StraightChain()), B = 2.0 * A;
  Decompositions known(0.0);  // room for one
  const auto first = known.Of(A);
  EXPECT_EQ(known.Of(MatrixXd(A)), first);
  EXPECT_EQ(first->T, BlockDiagonalise(A).T);
  EXPECT_NE(known.Of(B), first);
  EXPECT_NE(known.Of(A), first) << "made anew";
  EXPECT_EQ(known.Of(A)->L, first->L);
}

TEST(BlockDiagonal, WhatIsNoNetworkOrDampedTooStronglyIsNoMatterOfPairs) {
  MatrixXd A(4, 4);  // two pairs, one acting on the other only
  A << 0, 10, 0, 0, -10, -1, 0, 0, 0, 0, 0, 30, 1, 0, -30, -1;
  EXPECT_FALSE(FromPairs(A));
  A << 0, 10, 0, 0, -10, -9, 0, -9, 0, 0, 0, 12, 0, -9, -12, -9;  // damping couples them as strongly as they turn
  EXPECT_FALSE(FromPairs(A));
  ExpectDecomposes(A, BlockDiagonalise(A));
}

TEST(BlockDiagonal, OverdampedPairsAreReal) {
  Network network;
  network.nodes = {{"a", 1.0}, {"b", 2.0}};
  network.edges = {{"k", 0, 1, 100.0, 400.0}};
  const MatrixXd A = NetworkMatrix(network);
  const BlockDiagonal form = BlockDiagonalise(A);
  ExpectDecomposes(A, form);
  EXPECT_EQ(form.pairs(), 0);
  EXPECT_EQ(form.blocks.size(), 3u);
}

TEST(BlockDiagonal, RepeatedEigenvaluesOfEqualBranchesSeparate) {
  Network network;
  network.nodes = {{"hub", 1.0}};
  for (int i = 1; i <= 5; ++i) {
    network.nodes.push_back({"branch", 0.2});
    network.edges.push_back({"k", 0, i, 1e5, 0.7});
  }
  const MatrixXd A = NetworkMatrix(network);
  const BlockDiagonal form = BlockDiagonalise(A);
  ExpectDecomposes(A, form);
  EXPECT_EQ(form.pairs(), 5) << form.Summary();  // four of them equal
  EXPECT_LT(form.condition, 10.0);
}

TEST(BlockDiagonal, CriticallyDampedStaysOneBlock) {
  MatrixXd A(2, 2);
  A << 0.0, 300.0, -300.0, -600.0;
  const BlockDiagonal form = BlockDiagonalise(A);
  ExpectDecomposes(A, form);
  ASSERT_EQ(form.blocks.size(), 1u);
  EXPECT_FALSE(form.blocks[0].pair);
  EXPECT_LT(form.condition, 10.0);
}

TEST(BlockDiagonal, LagWithThePoleOfItsPlantStaysTogether) {
  // x1' = -500 x1 + u (lag), x2' = -p x2 + x1, and an oscillator beside them.
  for (const double pole : {500.0, 500.0 * (1.0 + 1e-9), 500.0 * (1.0 + 1e-5)}) {
    MatrixXd A = MatrixXd::Zero(4, 4);
    A(0, 0) = -500.0;
    A(1, 0) = 500.0;
    A(1, 1) = -pole;
    A.bottomRightCorner(2, 2) << 0.0, 900.0, -900.0, -1.0;
    A(3, 0) = 500.0;
    const BlockDiagonal form = BlockDiagonalise(A);
    ExpectDecomposes(A, form);
    EXPECT_EQ(form.pairs(), 1);
    ASSERT_EQ(form.blocks.size(), 2u) << form.Summary();
    EXPECT_EQ(form.blocks[1].size, 2);
    EXPECT_FALSE(form.dense_fallback);
  }
}

TEST(BlockDiagonal, CascadeKeepsEachMembersEigenvaluesExactly) {
  // Lag -> rotor: the lag's pole and the rigid body's zero survive to the bit.
  const MatrixXd plant = NetworkMatrix(support::StraightChain());
  const int n = static_cast<int>(plant.rows());
  MatrixXd A = MatrixXd::Zero(n + 1, n + 1);
  A.topLeftCorner(n, n) = plant;
  A.col(n).head(n).setConstant(1000.0);
  A(n, n) = -1000.0;
  const BlockDiagonal form = BlockDiagonalise(A);
  ExpectDecomposes(A, form);
  bool zero = false, lag = false;
  for (int i = 0; i <= n; ++i) zero = zero || form.L(i, i) == 0.0;
  for (int i = 0; i <= n; ++i) lag = lag || std::abs(form.L(i, i) + 1000.0) <= 1e-12;  // refined by an ulp at most
  EXPECT_TRUE(zero);
  EXPECT_TRUE(lag);
}

TEST(BlockDiagonal, ALargeNetworkKeepsItsFastWayBehindALagAndBeforeAnother) {
  const MatrixXd plant = NetworkMatrix(support::SoftRotorR2R());
  const int n = static_cast<int>(plant.rows());
  MatrixXd A = MatrixXd::Zero(n + 2, n + 2);
  A.block(1, 1, n, n) = plant;
  A(0, 0) = -1000.0;  // an actuator's lag, in N m
  A.col(0).segment(1, n).setConstant(0.05);
  A(n + 1, n + 1) = -300.0;  // a sensor's, in rad/s
  A.row(n + 1).segment(1, n).setConstant(20.0);
  const std::optional<BlockDiagonal> form = FromSets(A);
  ASSERT_TRUE(form);
  ExpectDecomposes(A, *form);
  EXPECT_EQ(form->pairs(), 71);
  EXPECT_EQ(form->blocks.size(), 74u);
  EXPECT_LT(form->condition, 1e3);
  // The members' own values, to the bit.
  const BlockDiagonal alone = BlockDiagonalise(plant);
  for (int i = 0; i < alone.pairs(); ++i) EXPECT_EQ(form->L(2 * i, 2 * i + 1), alone.L(2 * i, 2 * i + 1));
  A(n + 1, n + 1) = -1000.0;  // two lags alike, one acting on the other through the network: no business of sets
  EXPECT_FALSE(FromSets(A));
  ExpectDecomposes(A, BlockDiagonalise(A));
}

TEST(BlockDiagonal, ChainOfIntegratorsIsOneBlock) {
  MatrixXd A = MatrixXd::Zero(4, 4);
  A(0, 1) = 1.0;
  A(1, 2) = 1.0;
  A(3, 3) = -7.0;
  A(3, 0) = 1.0;
  const BlockDiagonal form = BlockDiagonalise(A);
  ExpectDecomposes(A, form);
  ASSERT_EQ(form.blocks.size(), 2u);
  EXPECT_EQ(form.blocks[0].size, 3);
}

TEST(BlockDiagonal, WhatCannotBeSeparatedFallsBackToDenseAndSaysSo) {
  // A Jordan block with every eigenvalue a little off, turned so that no structure shows.
  const int n = 12;
  MatrixXd A = MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) A(i, i) = -100.0 - 1e-3 * i;
  for (int i = 0; i + 1 < n; ++i) A(i, i + 1) = 100.0;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const MatrixXd turn = dense::Qr(MatrixXd::NullaryExpr(n, n, [&] { return normal(random); })).Q;
  A = turn * A * turn.transpose();
  const BlockDiagonal form = BlockDiagonalise(A);
  EXPECT_TRUE(form.dense_fallback);
  EXPECT_EQ(form.blocks.size(), 1u);
  EXPECT_EQ(form.L, A);
  EXPECT_THAT(form.Summary(), HasSubstr("dense (n = 12)"));
}

TEST(BlockDiagonal, RandomMatricesAlwaysDecompose) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const int n = 3 + static_cast<int>(seed) % 20;
    MatrixXd A = MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
    const Eigen::VectorXd scale = Eigen::VectorXd::NullaryExpr(n, [&] { return std::exp(5.0 * normal(random)); });
    A = (scale.cwiseInverse().asDiagonal() * A * scale.asDiagonal()).eval();  // as badly chosen units would
    const BlockDiagonal form = BlockDiagonalise(A);
    EXPECT_FALSE(form.dense_fallback) << seed << form.Summary();
    // Units are undone first: they must not show in the condition.
    const MatrixXd residual = scale.asDiagonal() * (A * form.T - form.T * form.L);
    const MatrixXd size = scale.asDiagonal() * form.T;
    EXPECT_LE(residual.norm(), 1e-12 * form.condition * size.norm() * std::sqrt(n)) << seed;
    EXPECT_LT(form.condition, 1e4) << seed;
  }
}

}  // namespace
}  // namespace dynoproof::mechanics
