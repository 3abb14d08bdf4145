// The data of a diagnosis, and the ways in which models are run beside them. METHOD of the estimator: engine/estimation/METHOD.md.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/predictor.h"
#include "model/registry.h"

namespace dynoproof::diagnosis {

/// The levels at which models are run beside a data set, the most corrected first; the last one is the free run, or, where the
/// scenario says that motion is chaotic (prediction_window_s), a memory as long as it can be predicted.
class Levels {
 public:
  /// `compared_from`, a share of each record: rows before are not compared, and the free run is corrected until there. 0: from the beginning, a
  /// record in motion from where its start has been forgotten. Fails where the plan cannot be run.
  /// `like`: with the same memories as these, not those that suit the records; where these are an earlier part of the same records, with their
  /// noise as well, so that a level corrects both parts alike. `most_s`: of each record.
  static Result<std::unique_ptr<Levels>> Of(const Plan& plan, const std::vector<MappedRecord>& records,
                                            const Registry& registry, double compared_from, Eigen::Index most_rows,
                                            const Levels* like = nullptr, double most_s = 1e300);

  const estimation::DataSet& data() const { return *data_; }
  std::size_t size() const { return predictors_.size(); }
  const estimation::Predictor& operator[](std::size_t level) const { return *predictors_[level]; }
  /// The last level.
  std::size_t free_run() const { return size() - 1; }
  /// The second memory, or the first where that is not well below the record's length: long enough for what accumulates to
  /// show, short enough for forces that no model has.
  std::size_t corrected() const { return corrected_; }
  /// The longest memory that is well below the record's length, or the first.
  std::size_t longest() const { return longest_; }
  /// Whether a level only leads on to the free run: its memory is longer than that, and no verdict is given there.
  bool IsSteppingStone(std::size_t level) const { return level > longest_ && level < free_run(); }
  /// The free run from where the records begin, though it is compared later; null where the last level is that itself, or no
  /// free run. Which of the two suits a model depends on whether it knows the start better, or an output accumulates.
  const estimation::Predictor* from_the_start() const { return from_the_start_.get(); }
  /// "memory 0.025 s", "free run".
  std::string Name(std::size_t level) const;
  std::int64_t simulations() const;

 private:
  Levels() = default;
  std::unique_ptr<estimation::DataSet> data_;
  estimation::LinearModel model_;
  std::vector<double> memories_s_;
  std::vector<std::unique_ptr<estimation::Predictor>> predictors_;
  std::unique_ptr<estimation::Predictor> from_the_start_;
  std::size_t corrected_ = 0, longest_ = 0;
};

}  // namespace dynoproof::diagnosis
