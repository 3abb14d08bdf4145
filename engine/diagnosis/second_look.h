// Where one effect does not account for a record: on top of which of the single ones a second leaves least. What removes most
// alone may stand for both of two others, and a search that goes on from there never comes to them.
#pragma once

#include <optional>

#include "diagnosis/contest.h"

namespace dynoproof::diagnosis {

struct Base {
  std::size_t contestant;
  Contestant pair;  // with the second effect that leaves least beside it, fitted cheaply at one level
  std::size_t level;

  const estimation::Estimate& fit() const { return pair.levels[level]; }
};

/// Of the contestants that remove a share, each with those effects that have shown one at the first look: the best pair by base, the
/// one that leaves least first. Empty where none holds at the level, the longest memory within the record.
std::vector<Base> BasesOfPairs(const Contest& contest, const Levels& levels, const Magnitudes& magnitudes,
                               const Registry& registry, const Conduct& conduct);

}  // namespace dynoproof::diagnosis
