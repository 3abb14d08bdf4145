// Which numbers of a fit the data tell, and of which they see a combination alone.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

namespace dynoproof::identification {

struct ToldApart {
  std::vector<double> singular;                 // of the Jacobian, largest first
  std::vector<std::vector<std::string>> alike;  // keys that only a combination of is seen, or none
  Eigen::MatrixXd inverse;                      // (J'J)^-1 [keys x keys], as far as it is regular

  bool Tells(const std::string& key) const;
};

/// By the Jacobian of the errors at an optimum [rows x keys] and the mean square of these: a direction counts as unseen if a
/// change of 1 in it moves all errors together by less than a tenth of one of them.
ToldApart TellApart(const Eigen::MatrixXd& jacobian, double mean_square, const std::vector<std::string>& keys);

}  // namespace dynoproof::identification
