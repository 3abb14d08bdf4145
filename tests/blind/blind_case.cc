#include "tests/blind/blind_case.h"

#include <limits>

#include "score/series.h"

namespace dynoproof::blind {

double SizeOf(const Columns& with, const Columns& without, double noise) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair{0.0, 0.7}, {0.7, 1.0}}) {
    double largest = 0.0;
    for (const auto& [name, values] : with.outputs) {
      const auto rows = static_cast<double>(values.size());
      std::vector<double> difference;
      for (auto i = static_cast<std::size_t>(from * rows); i < static_cast<std::size_t>(to * rows); ++i)
        difference.push_back(values[i] - without.outputs.at(name)[i]);
      largest = std::max(largest, score::RootMeanSquare(difference) / (noise * score::StandardDeviation(values)));
    }
    smallest = std::min(smallest, largest);
  }
  return smallest;
}

}  // namespace dynoproof::blind
