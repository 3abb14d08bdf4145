// A scenario, the records to explain, and what the scenario predicts for them under any hypothesis: the one place where
// a diagnosis simulates. All outputs of all records form one vector, channel behind channel.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "experiment/prediction_windows.h"
#include "experiment/records.h"
#include "identification/nuisance.h"
#include "linear/decompositions.h"
#include "model/registry.h"

namespace dynoproof::identification {

/// An effect at a place with its parameters, in the effect's order.
struct EffectInstance {
  const Effect* effect = nullptr;
  Place place;
  std::vector<double> parameters;

  std::string ToString() const { return effect->info().name + "@" + place.ToString(); }
};

/// A hypothesis: nuisance parameters (in prior standard deviations), and effects on top of them.
struct Hypothesis {
  std::vector<double> z;
  std::vector<EffectInstance> effects;
};

/// One measured output of one record: rows [begin, begin + count) of the vector.
struct ComparedOutput {
  std::size_t record = 0;
  std::string name, unit;
  double nominal = 1.0, step_s = 0.0, spread = 0.0;  // spread: standard deviation of the measured signal
  Eigen::Index begin = 0, count = 0;
};

/// Keeps the first share `until` of a record.
void CutRecord(MappedRecord& record, double until);

/// What all problems of one search share, on whichever part of the records.
struct SearchContext {
  std::shared_ptr<mechanics::Decompositions> decompositions = std::make_shared<mechanics::Decompositions>();
  bool released = false;  // nominal values that are let go are nuisances, too
};

class EstimationProblem {
 public:
  /// `plan`: the nominal scenario, its own effects applied. Records are cut at share `until` of their length.
  EstimationProblem(Plan plan, std::vector<MappedRecord> records, const Registry& registry, double until = 1.0,
                    SearchContext context = {});

  const Plan& plan() const { return plan_; }
  const Registry& registry() const { return *registry_; }
  /// Of outputs the rows that are compared.
  const std::vector<MappedRecord>& records() const { return records_; }
  const std::vector<Nuisance>& nuisances() const { return nuisances_; }
  const std::vector<ComparedOutput>& channels() const { return channels_; }
  const Eigen::VectorXd& measured() const { return measured_; }
  /// Time of each row [s].
  const std::vector<double>& time_s() const { return time_s_; }
  const SearchContext& context() const { return context_; }

  /// The plan of a hypothesis: nuisance parameters first, then the effects in order, with substeps as fine as they ask
  /// for.
  Plan PlanOf(const Hypothesis& hypothesis) const;
  /// What that plan predicts for every row: a free run from each record's start, or in the windows of the plan's
  /// prediction_window_s, whose first is then no part of the vector. Fails where a run breaks.
  Result<Eigen::VectorXd> Predict(const Hypothesis& hypothesis) const;
  Result<Eigen::VectorXd> PredictPlan(const Plan& plan) const;
  /// Whether a hypothesis is run with four substeps at least, where a rough search takes one. Dry friction is held over
  /// a substep where it may stick, which undamped modes remember and damped ones forget.
  bool NeedsFinerSteps(const Hypothesis& hypothesis) const;
  Hypothesis Nominal() const { return {std::vector<double>(nuisances_.size(), 0.0), {}}; }

 private:
  void Observe(double window_s);

  Plan plan_;
  const Registry* registry_;
  std::vector<MappedRecord> records_;  // outputs: the rows that are compared
  std::vector<Observer> observers_;    // by record, where predictions go in windows
  Status unobserved_;                  // why there are none
  std::vector<Nuisance> nuisances_;
  std::vector<ComparedOutput> channels_;
  Eigen::VectorXd measured_;
  std::vector<double> time_s_;
  SearchContext context_;
};

}  // namespace dynoproof::identification
