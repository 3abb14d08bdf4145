// A linear system in real block-diagonal coordinates, with the layout of its state in memory and, where wanted, without
// its fastest modes. All Propagators of one form (other intervals) share this state.
#pragma once

#include <Eigen/Dense>
#include <limits>
#include <span>
#include <vector>

#include "linear/block_diagonal.h"
#include "linear/linear_system.h"

namespace dynoproof::mechanics {

/// Where the state's parts lie, in doubles. Every part is padded with zeros (which stay zero) to whole groups of
/// kGroup, whatever the machine:
///   [0, larger_begin)                the pairs: kGroup first coordinates, their kGroup second ones, the next group ..
///   [larger_begin, real_begin)       the larger blocks, each padded
///   [real_begin, integrator_begin)   real eigenvalues
///   [integrator_begin, size)         the integrators p
struct StateLayout {
  static constexpr int kGroup = 8;
  static constexpr int Padded(int count) { return (count + kGroup - 1) / kGroup * kGroup; }

  int pairs = 0;
  int larger_begin = 0;
  int real_begin = 0, reals = 0;
  int integrator_begin = 0, integrators = 0;
  int size = 0;
  std::vector<int> place;  // of each modal coordinate, in the order of the form's blocks
};

/// Modal coordinates z (k <= n kept): z' = L z + B u, p' = P z + F u, y = C z + E p + D u. The two coordinates of each
/// pair are turned so that the first output does not see the second: its sum is half as long.
struct ModalForm {
  std::vector<BlockDiagonal::Block> blocks;
  Eigen::MatrixXd L, B;          // k x k, k x m
  Eigen::MatrixXd P, F;          // q x k, q x m; F is zero before a truncation
  Eigen::MatrixXd C, E, D;       // r x k, r x q, r x m
  Eigen::MatrixXd T, T_inverse;  // n x k, k x n: x = T z, z = T_inverse x
  StateLayout layout;
  double condition = 1.0;  // of the full T
  bool dense_fallback = false;
  int dropped_states = 0;

  /// Decomposes the system (BlockDiagonalise), or takes the decomposition of its A as given.
  static ModalForm Build(const LinearSystem& system) { return Build(system, BlockDiagonalise(system.A)); }
  static ModalForm Build(const LinearSystem& system, BlockDiagonal diagonal);

  /// Without the pairs beyond the `count` slowest (by |eigenvalue|). What a dropped mode does to a constant input is
  /// kept: its static gain goes to D (and F). (A correction of the next order gains no more than one further pair.)
  /// Larger blocks and real eigenvalues all stay.
  ModalForm KeepPairs(int count) const;
  /// Without all blocks whose eigenvalues all exceed `limit` [rad/s], static gain kept likewise.
  ModalForm KeepBelow(double limit) const;

  /// For a system of n states of which these k were kept: T and T_inverse lead to and from all n. `follows` [n x k]: all
  /// states by those kept.
  void Expand(const Eigen::MatrixXd& follows, const std::vector<int>& kept);

  int inputs() const { return static_cast<int>(B.cols()); }
  int outputs() const { return static_cast<int>(C.rows()); }
  int integrators() const { return static_cast<int>(P.rows()); }
  /// Doubles a caller provides for a state; 64-byte alignment (AlignedVector) is faster, not required.
  int state_size() const { return layout.size; }

  /// Writes the state of x [n] and p [q], padding included; and back (a truncated form returns the kept modes' share).
  void SetState(const Eigen::VectorXd& x, const Eigen::VectorXd& p, std::span<double> state) const;
  void GetState(std::span<const double> state, Eigen::VectorXd& x, Eigen::VectorXd& p) const;

 private:
  ModalForm Keep(const std::vector<bool>& keep) const;
  void SetLayout();
};

}  // namespace dynoproof::mechanics
