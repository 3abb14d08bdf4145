// Decompositions that were made before. Whoever simulates one machine many times under changed loads, sensors or inputs
// asks for the same one each time; for 200 states it takes longer than a second of simulation.
#pragma once

#include <Eigen/Dense>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "linear/block_diagonal.h"

namespace dynoproof::mechanics {

/// For any number of threads. What it gives is what BlockDiagonalise() would give, to the bit.
class Decompositions {
 public:
  /// Keeps those asked for last, up to some `megabytes`.
  explicit Decompositions(double megabytes = 64.0) : limit_(megabytes * 1e6) {}

  std::shared_ptr<const BlockDiagonal> Of(const Eigen::MatrixXd& A);

 private:
  struct Known {
    Eigen::MatrixXd A;
    std::shared_ptr<const BlockDiagonal> form;
    std::size_t key;  // of A's bytes

    double bytes() const { return 8.0 * (static_cast<double>(A.size()) + 3.0 * static_cast<double>(form->T.size())); }
  };

  std::mutex guard_;
  std::list<Known> known_;                                                  // last asked for first
  std::unordered_multimap<std::size_t, std::list<Known>::iterator> place_;  // by key
  double limit_, bytes_ = 0.0;
};

}  // namespace dynoproof::mechanics
