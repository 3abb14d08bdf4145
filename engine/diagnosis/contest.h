// Hypotheses against each other: each is fitted, effects and doubts together, until their order no longer changes, and
// whoever leads is challenged. None may lose because it had not found its place yet.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/resume.h"

namespace dynoproof::diagnosis {

void BestFirst(std::vector<Fit>& fits);
/// Best first, all under one whitener.
void Sort(const Fitter& fitter, std::vector<Fit>& fits);
/// Takes the other fit where it explains more.
void KeepBetter(Fit& fit, Fit other);
/// Adds a fit, or keeps the better one where there is one of that name.
void TakeUp(std::vector<Fit>& fits, Fit fit);

class Contest {
 public:
  using Progress = std::function<void(const std::string& what, double fraction)>;

  /// On the records of `study`, which outlives it.
  Contest(const Study& study, SavedFits& saved, Progress progress);

  /// Adds to `fits` the effects that say openly what the nominal model needs far outside its doubts, or puts them in
  /// the place of worse ones; whether there was any. They are not fitted yet.
  bool Suggest(const Fitter& fitter, const Fit& null, std::vector<Fit>& fits);
  /// Others that are asked beside whoever leads: they were beaten where nobody was at the noise.
  void Recall(std::vector<Assumed> beaten) { beaten_ = std::move(beaten); }
  /// Sorts `fits`, best first; `entrants`: effects that may still challenge. `null`, the nominal model with all the
  /// freedom of its doubts, gets every chance too.
  void Decide(const std::vector<Assumed>& entrants, std::vector<Fit>& fits, Fit& null);
  /// Carries a hypothesis to the full records over shorter ones; `cold` itself where that breaks.
  Fit Warm(const Fit& cold, const Fitter& last);
  /// The same, but the effects have all their freedom from the beginning, and each part is little longer than the last:
  /// modes and effects stay in step where neither was right.
  Fit Grown(const Fit& cold, const Fitter& last);
  /// Each cause begins anew on the shortest part from all its `starts`, of which it keeps the best; the best causes go
  /// on over parts that grow. The first that comes to the noise, if any.
  std::optional<Hypothesis> FromAnyStart(const std::vector<Assumed>& starts);

  int simulations() const { return simulations_; }

 private:
  std::optional<Assumed> AsEffect(const Doubt& doubt, double z) const;
  void Race(std::vector<Fit>& fits, const Fit& null);
  Fit FromItsOwn(Fit fit, const Fitter& fitter) const;
  bool MovesModes(const Fit& fit) const;
  bool Accounts(const Fit& fit) const;
  bool AtFloor(const Fit& fit) const;
  void Regrow(const std::vector<Assumed>& entrants, std::vector<Fit>& fits);
  void Challenge(const std::vector<Assumed>& entrants, std::vector<Fit>& fits);
  std::vector<Assumed> ChallengersOf(const std::vector<Assumed>& entrants, const std::vector<Fit>& fits) const;
  void Answer(const Fitter& fitter, Fit fit, std::vector<Fit>& fits);
  Hypothesis Beside(const Fit& fit) const;
  /// Fits again those that `fit_again` takes up, best first, and sorts.
  template <class FitAgain>
  void Each(std::vector<Fit>& fits, const std::string& what, double fraction, const FitAgain& fit_again);

  const Study& study_;
  std::vector<Study> rungs_;  // shorter and shorter parts, the shortest first
  std::set<std::string> begun_anew_;
  std::vector<Assumed> beaten_;
  SavedFits& saved_;
  Progress step_;
  int simulations_ = 0;
};

}  // namespace dynoproof::diagnosis
