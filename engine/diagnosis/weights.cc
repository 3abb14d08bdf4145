#include "diagnosis/weights.h"

namespace dynoproof::diagnosis {

Weights::Weights(std::span<const Contestant> contestants, const Levels& levels, std::size_t level) {
  std::vector<Eigen::VectorXd> left_out;
  const Contestant* leader = LeaderAt(contestants, levels, level);
  for (const Contestant& one : contestants) {
    left_out.push_back(one.Holds(level) ? estimation::LeaveBlocksOut(one.levels[level], levels.data(), one.hypothesis)
                                        : Eigen::VectorXd());
  }
  const Eigen::VectorXd rows =
      leader ? estimation::RowWeights(left_out, levels.data(), leader->levels[level].scales) : Eigen::VectorXd();
  for (std::size_t a = 0; a < left_out.size(); ++a) {
    weights_.emplace_back(left_out.size());
    for (std::size_t b = 0; b < left_out.size(); ++b) {
      if (a != b && left_out[a].size() > 0 && left_out[b].size() > 0)
        weights_[a][b] = estimation::Encompassing(left_out[a], left_out[b], levels.data(), rows);
    }
  }
}

}  // namespace dynoproof::diagnosis
