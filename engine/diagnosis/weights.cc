#include "diagnosis/weights.h"

namespace dynoproof::diagnosis {

Weights::Weights(std::span<const Contestant> contestants, const Levels& levels, std::size_t level, RowsCount rows) {
  std::vector<Eigen::VectorXd> left_out;
  const Contestant* leader = LeaderAt(contestants, levels, level);
  for (const Contestant& one : contestants) {
    left_out.push_back(one.Holds(level) ? estimation::LeaveBlocksOut(one.levels[level], levels.data(), one.hypothesis)
                                        : Eigen::VectorXd());
  }
  if (leader == nullptr) {
    weights_.assign(left_out.size(), std::vector<std::optional<estimation::Weight>>(left_out.size()));
    return;
  }
  const auto& scales = leader->levels[level].scales;
  const Eigen::VectorXd w = rows == RowsCount::kByBlock ? estimation::WeightsByBlock(left_out, levels.data(), scales)
                                                        : estimation::WeightsByChannel(levels.data(), scales);
  for (std::size_t a = 0; a < left_out.size(); ++a) {
    weights_.emplace_back(left_out.size());
    for (std::size_t b = 0; b < left_out.size(); ++b) {
      if (a != b && left_out[a].size() > 0 && left_out[b].size() > 0)
        weights_[a][b] = estimation::Encompassing(left_out[a], left_out[b], levels.data(), w);
    }
  }
}

}  // namespace dynoproof::diagnosis
