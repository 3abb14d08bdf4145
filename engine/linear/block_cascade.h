// Sets of states that act on each other in one direction only: an actuator's lag before a network, a sensor's behind
// it.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "linear/block_diagonal.h"

namespace dynoproof::mechanics {

/// An order of the states in which A is block upper triangular, one strongly connected set of states a block.
struct Cascade {
  std::vector<int> order;
  std::vector<int> starts;  // first place of each set in `order`, and n at the end

  int sets() const { return static_cast<int>(starts.size()) - 1; }
};
Cascade FindCascade(const Eigen::MatrixXd& A);

/// Decomposes each set by itself and then frees the sets of each other: a large network keeps its fast way
/// (FromPairs), whatever stands before or behind it. Nothing where no set is large, where one has no small blocks, or
/// where two sets share an eigenvalue, nearly.
std::optional<BlockDiagonal> FromSets(const Eigen::MatrixXd& A);

}  // namespace dynoproof::mechanics
