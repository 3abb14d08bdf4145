// Models against each other at one level: which of two predicts what the other does not (estimation/encompassing.h).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnosis/contestant.h"
#include "estimation/encompassing.h"

namespace dynoproof::diagnosis {

/// What rows count by: where a model leaves nothing but noise, by what the best leaves in their block; where none does, by what it leaves
/// in their channel, for blocks in which little is wrong would outweigh those that tell models apart.
enum class RowsCount { kByBlock, kByChannel };

/// Of all pairs. Innovations are those of leaving blocks out.
class Weights {
 public:
  Weights(std::span<const Contestant> contestants, const Levels& levels, std::size_t level, RowsCount rows);

  /// Nothing where one of both has no estimate here.
  const std::optional<estimation::Weight>& Of(std::size_t a, std::size_t b) const { return weights_[a][b]; }
  /// Whether b adds nothing to a.
  bool Beats(std::size_t a, std::size_t b) const {
    return weights_[a][b] && estimation::Compare(*weights_[a][b]) == estimation::Comparison::kFirst;
  }

 private:
  std::vector<std::vector<std::optional<estimation::Weight>>> weights_;
};

}  // namespace dynoproof::diagnosis
