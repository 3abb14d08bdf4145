// Every candidate fitted to the same data, beside the record at some levels of correction and in the free run: nobody is
// dropped before it has been fitted once. METHOD of the estimator: engine/estimation/METHOD.md.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/estimator.h"
#include "model/registry.h"

namespace dynoproof::diagnosis {

/// The levels at which models are run beside a data set, the most corrected first; the last one is the free run.
class Levels {
 public:
  /// `compared_from_s`: rows before are not compared, and the free run is corrected until there. 0: from the beginning, a
  /// record in motion from where its start has been forgotten. Fails where the plan cannot be run.
  /// `like`: with the same memories as these, not those that suit the records. `most_s`: of each record.
  static Result<std::unique_ptr<Levels>> Of(const Plan& plan, const std::vector<MappedRecord>& records,
                                            const Registry& registry, double compared_from_s, Eigen::Index most_rows,
                                            const Levels* like = nullptr, double most_s = 1e300);

  const estimation::DataSet& data() const { return *data_; }
  std::size_t size() const { return predictors_.size(); }
  const estimation::Predictor& operator[](std::size_t level) const { return *predictors_[level]; }
  std::size_t free_run() const { return size() - 1; }
  /// The second memory, or the first where that is not well below the record's length: long enough for what accumulates to
  /// show, short enough for forces that no model has.
  std::size_t corrected() const { return corrected_; }
  /// The longest memory that is well below the record's length, or the first.
  std::size_t longest() const { return longest_; }
  /// "memory 0.025 s", "free run".
  std::string Name(std::size_t level) const;
  std::int64_t simulations() const;

 private:
  Levels() = default;
  std::unique_ptr<estimation::DataSet> data_;
  estimation::LinearModel model_;
  std::vector<double> memories_s_;
  std::vector<std::unique_ptr<estimation::Predictor>> predictors_;
  std::size_t corrected_ = 0, longest_ = 0;
};

/// A model and what it was fitted to at each level.
struct Contestant {
  explicit Contestant(estimation::Hypothesis model) : hypothesis(std::move(model)) {}

  estimation::Hypothesis hypothesis;
  std::vector<estimation::Estimate> levels;  // not fitted, or broken: not ok()
  double share = 0.0;                        // of the null's excess that it removes at a first look

  /// The effect that came last; there is none in the nominal model.
  const Effect& effect() const { return *hypothesis.effects().back().effect; }
  const Place& place() const { return hypothesis.effects().back().place; }
  std::string Name() const { return hypothesis.Name(); }
  bool Holds(std::size_t level) const { return level < levels.size() && levels[level].ok(); }
};

/// Whether innovations are no larger than measurement noise makes them, by 1.2 in each channel.
bool IsExact(const estimation::Estimate& estimate);
/// Whether they are larger by so much that an effect may show: a fifth of the noise's power, or five standard errors.
bool HasExcess(const estimation::Estimate& estimate, const estimation::DataSet& data);
/// Mean over channels of the logarithm of the power beyond what noise alone causes. A channel that shows none beside the noise
/// counts with as much as could be seen there.
double LogExcess(const std::vector<estimation::ChannelScale>& scales, const estimation::DataSet& data);

/// The share of the null's excess that a model removes at a level where both hold.
double ShareOf(const Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level);

/// The null, which may have effects already, and the ten candidates on top of it that remove most, each fitted at every
/// level.
struct Contest {
  bool released = false;                // nominal values without priors
  std::size_t first = 0;                // the level of the first look
  std::vector<Contestant> contestants;  // the null first
  std::vector<Contestant> left_behind;  // after the first look, the best first
  struct Cost {
    std::string stage;
    std::int64_t simulations;
  };
  std::vector<Cost> cost;

  const Contestant& null() const { return contestants.front(); }
};

/// The plan without further effects, its nominal values free, fitted at every level.
Contestant NullOf(const Plan& plan, bool released, const Levels& levels, const Registry& registry);

/// `magnitudes`: of the first record. Fails where the null breaks at every level. `progress`: a share of the work.
Result<Contest> Compete(Contestant null, bool released, const Levels& levels, const Magnitudes& magnitudes,
                        const Registry& registry, const std::function<void(double)>& progress);

}  // namespace dynoproof::diagnosis
