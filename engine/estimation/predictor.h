// Predictions of a model for a data set: by a run beside each record that is corrected by it (observer.h), or by a free run.
// The only place where an estimator simulates.
#pragma once

#include <Eigen/Dense>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/status.h"
#include "estimation/data_set.h"
#include "estimation/observer.h"
#include "linear/decompositions.h"
#include "model/registry.h"

namespace dynoproof::estimation {

struct Prediction {
  Eigen::VectorXd innovations;  // measured - predicted, by row, before the row's own sample corrects
  Eigen::VectorXd noise_alone;  // RMS by channel that measurement noise alone causes in them
  bool rough = false;           // guards are in the rig, so that small changes are not seen as such
};

/// One way to predict, for all models of a search.
class Predictor {
 public:
  /// `memory_s`: of the correction; nothing: a free run. `model`: of the nominal plan and the first record. The data set,
  /// the registry and the model outlive the predictor. `decompositions`: shared by all predictors of a search.
  Predictor(const DataSet& data, const LinearModel& model, const Registry& registry, std::optional<double> memory_s,
            std::shared_ptr<mechanics::Decompositions> decompositions);
  /// The same from where one with `lead`'s correction has come to at `until_s`: of records that begin in motion.
  Predictor(const Predictor& lead, double until_s, std::optional<double> memory_s);

  const DataSet& data() const { return *data_; }
  /// In the order of the observer's columns.
  const std::vector<std::string>& outputs() const { return model_->outputs; }
  /// That of the rows that are compared. Nothing where these are those of a free run.
  const std::optional<Observer>& observer() const { return observer_; }
  bool free_run() const { return !observer_; }

  /// Innovations e = measured - predicted, by row [rows]: before the row's own sample corrects. `plan`: of the same machine
  /// as the nominal one. Fails where the plan cannot be built or a run breaks.
  Result<Eigen::VectorXd> Innovations(const Plan& plan) const;
  /// The same with the RMS that noise alone causes. A model that is not linear, or has states that the nominal model lacks, gets the
  /// nominal model's.
  Result<Prediction> Predict(const Plan& plan) const;
  /// Innovations of the data where the samples that correct the run are others: what `change` makes of each record.
  Result<Eigen::VectorXd> CorrectedByOthers(const Plan& plan,
                                            const std::function<void(MappedRecord&, std::size_t)>& change) const;
  /// Where the nominal plan is not linear, what noise alone causes is henceforth what its run tells: how far it moves when the record that
  /// corrects it gets as much white noise again. Noise that comes before an impact moves the impact, which no linear model
  /// knows. Not thread-safe.
  void LearnNoise(const Plan& nominal);

  /// How many runs of a record it has made. Thread-safe.
  std::int64_t simulations() const { return simulations_.load(); }

 private:
  /// Corrects the beginning of a record, where nothing is compared.
  struct Lead {
    std::optional<Observer> observer;
    double until_s;
  };

  std::optional<Observer> ObserverOf(std::optional<double> memory_s) const;
  Result<BuiltRun> Build(const Plan& plan, std::size_t record) const;
  Result<Prediction> Predict(const Plan& plan, bool with_noise) const;
  /// `whole`: the plan, built for the first record.
  Eigen::VectorXd NoiseAlone(const Plan& plan, const BuiltRun& whole) const;
  Eigen::VectorXd NoiseBy(const LinearModel& model) const;
  Eigen::VectorXd NoiseOfNominal() const;
  Status RunBeside(const BuiltRun& run, const MappedRecord& record, std::size_t r, Eigen::VectorXd& innovations) const;

  const DataSet* data_;
  const LinearModel* model_;
  const Registry* registry_;
  std::vector<Lead> leads_;  // one after the other
  std::optional<Observer> observer_;
  Eigen::VectorXd learned_;  // by channel, what noise makes of the nominal run; empty: it is linear
  std::shared_ptr<mechanics::Decompositions> decompositions_;
  std::vector<bool> between_;  // by record: rows lie between ticks, where a run is known less well
  mutable std::atomic<std::int64_t> simulations_ = 0;
};

}  // namespace dynoproof::estimation
