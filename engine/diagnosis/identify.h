// Fits any positive or negative numbers of a scenario to records by the free-run simulation error: values, intervals,
// and which of them the data cannot tell apart.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "diagnosis/study.h"

namespace dynoproof::diagnosis {

struct IdentifiedValue {
  std::string key;
  double nominal = 0.0, value = 0.0, lower = 0.0, upper = 0.0;  // 95 % interval
  bool on_bound = false;                                        // then there is no interval
};
struct Identified {
  std::vector<IdentifiedValue> values;
  Eigen::MatrixXd covariance;                   // of the values, corrected for the colour of the residual (sandwich)
  std::vector<double> singular;                 // of the Jacobian per relative change of each value, largest first
  std::vector<std::vector<std::string>> alike;  // keys that only a combination of is seen
  int starts = 0, converged = 0;                // starts that reached the best cost within 0.1 %
  double nrmse_before = 0.0, nrmse_after = 0.0;
};

/// Each value may become a tenth to ten times its nominal; starts lie within +-10 % of it, the first at it. Fails where
/// the nominal run breaks.
Result<Identified> Identify(const Plan& plan, const std::vector<MappedRecord>& data, const Registry& registry,
                            const std::vector<std::string>& keys, int starts,
                            const std::function<void(double)>& progress);

nlohmann::json ToJson(const Identified& identified);
std::string ToTable(const Identified& identified);

}  // namespace dynoproof::diagnosis
