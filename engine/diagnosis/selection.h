// Hypotheses against each other: each is fitted, effects and nuisance parameters together, until their order no longer
// changes, and whoever leads is challenged. None may lose because it had not found its place yet.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/checkpoint.h"
#include "diagnosis/terms.h"
#include "identification/estimator.h"

namespace dynoproof::diagnosis {

void BestFirst(std::vector<Estimate>& fits);
/// Best first, all under one whitener.
void Sort(const Estimator& estimator, std::vector<Estimate>& fits);
/// Takes the other fit where it explains more.
void KeepBetter(Estimate& fit, Estimate other);
/// Adds a fit, or keeps the better one where there is one of that name.
void TakeUp(std::vector<Estimate>& fits, Estimate fit);

class Selection {
 public:
  using Progress = std::function<void(const std::string& what, double fraction)>;

  /// On the records of `study`, which outlives it.
  Selection(const EstimationProblem& problem, SavedFits& saved, Progress progress);

  /// Adds to `fits` the effects that say openly what the nominal model needs far outside its priors, or
  /// puts them in the place of worse ones; whether there was any. They are not fitted yet.
  bool Suggest(const Estimator& estimator, const Estimate& null, std::vector<Estimate>& fits);
  /// Others that are asked beside whoever leads: they were beaten where nobody was at the noise.
  void Recall(std::vector<EffectInstance> beaten) { beaten_ = std::move(beaten); }
  /// Sorts `fits`, best first; `entrants`: effects that may still challenge. `null`, the nominal model with all the
  /// freedom of its nuisance parameters, gets every chance too.
  void Decide(const std::vector<EffectInstance>& entrants, std::vector<Estimate>& fits, Estimate& null);
  /// Carries a hypothesis to the full records over shorter ones; `cold` itself where that breaks.
  Estimate FromShortHorizons(const Estimate& cold, const Estimator& last);
  /// The same, but the effects have all their freedom from the beginning, and each part is little longer than the last:
  /// modes and effects stay in step where neither was right.
  Estimate OverGrowingHorizons(const Estimate& cold, const Estimator& last);
  /// Each cause begins anew on the shortest part from all its `starts`, of which it keeps the best; the best causes go
  /// on over parts that grow. The first that comes to the noise, if any.
  std::optional<Hypothesis> FromAnyStart(const std::vector<EffectInstance>& starts);

 private:
  std::optional<EffectInstance> AsEffect(const Nuisance& nuisance, double z) const;
  /// The nuisance parameters about the nominal model, on all rows; without columns where a run breaks.
  const NuisanceModel& AtNominal() const;
  void Race(std::vector<Estimate>& fits, const Estimate& null);
  Estimate FromItsOwn(Estimate fit, const Estimator& estimator) const;
  bool MovesModes(const Estimate& fit) const;
  bool Accounts(const Estimate& fit) const;
  bool AtFloor(const Estimate& fit) const;
  void Regrow(const std::vector<EffectInstance>& entrants, std::vector<Estimate>& fits);
  void ConditionalRefits(const std::vector<EffectInstance>& entrants, std::vector<Estimate>& fits);
  std::vector<EffectInstance> AlternativesTo(const std::vector<EffectInstance>& entrants,
                                             const std::vector<Estimate>& fits) const;
  bool MayAnswer(const EffectInstance& alternative, const Hypothesis& leader);
  void Answer(const Estimator& estimator, Estimate fit, std::vector<Estimate>& fits);
  Hypothesis Beside(const Estimate& fit) const;
  /// Fits again those that `fit_again` takes up, best first, and sorts.
  template <class FitAgain>
  void Each(std::vector<Estimate>& fits, const std::string& what, double fraction, const FitAgain& fit_again);

  const EstimationProblem& problem_;
  std::vector<EstimationProblem> rungs_;  // shorter and shorter parts, the shortest first
  mutable std::optional<NuisanceModel> at_nominal_;
  std::set<std::string> begun_anew_;
  std::map<std::string, std::vector<double>> asked_;  // beside which leader, and its numbers then
  std::vector<EffectInstance> beaten_;
  SavedFits& saved_;
  Progress step_;
};

}  // namespace dynoproof::diagnosis
