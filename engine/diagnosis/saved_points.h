// The points to which the fits of a diagnosis have come, in a file of the output folder: one that was stopped goes on from
// them. They are points to start from only; every figure of a result is computed anew.
#pragma once

#include <Eigen/Dense>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "experiment/records.h"
#include "model/plan.h"

namespace dynoproof::diagnosis {

class SavedPoints {
 public:
  /// Reads what is there if `resume`, and it belongs to the same plan and records. Another version's file counts as none.
  SavedPoints(std::string file, bool resume, const Plan& plan, const std::vector<MappedRecord>& records);

  /// The coordinates that were kept under this name, if there are `count`. Thread-safe.
  std::optional<Eigen::VectorXd> Recall(const std::string& name, Eigen::Index count) const;
  /// Writes the file unless it was written a moment ago. A file that cannot be written costs time later, not a result now.
  /// Thread-safe.
  void Keep(const std::string& name, const Eigen::VectorXd& q);

 private:
  std::string file_, fingerprint_;
  mutable std::mutex own_;
  std::map<std::string, std::vector<double>> points_;
  std::chrono::steady_clock::time_point written_;
};

}  // namespace dynoproof::diagnosis
