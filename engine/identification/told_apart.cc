#include "identification/told_apart.h"

#include <algorithm>
#include <cmath>

#include "linear/dense.h"

namespace dynoproof::identification {

bool ToldApart::Tells(const std::string& key) const {
  return std::ranges::none_of(alike, [&](const auto& set) { return std::ranges::find(set, key) != set.end(); });
}

ToldApart TellApart(const Eigen::MatrixXd& jacobian, double mean_square, const std::vector<std::string>& keys) {
  constexpr double kUnseen = 0.01, kSingular = 1e-9, kRegular = 1e-15, kTakesPart = 0.1;
  const dense::Svd svd = dense::JacobiSvd(jacobian.transpose() * jacobian);
  ToldApart told;
  Eigen::VectorXd inverse_values = svd.values;
  for (Eigen::Index k = 0; k < inverse_values.size(); ++k) {
    const double value = svd.values[k];
    told.singular.push_back(std::sqrt(value));
    inverse_values[k] = value > 0.0 ? 1.0 / std::max(value, kRegular * svd.values[0]) : 0.0;
    if (value > kSingular * svd.values[0] && value > kUnseen * mean_square) continue;
    std::vector<std::string> set;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (std::abs(svd.V(static_cast<Eigen::Index>(i), k)) > kTakesPart) set.push_back(keys[i]);
    }
    told.alike.push_back(std::move(set));
  }
  told.inverse = svd.V * inverse_values.asDiagonal() * svd.V.transpose();
  return told;
}

}  // namespace dynoproof::identification
