#pragma once

#include <span>
#include <vector>

namespace dynoproof::score {

/// Ranks from 1; equal values share their mean rank.
std::vector<double> Ranks(std::span<const double> values);

}  // namespace dynoproof::score
