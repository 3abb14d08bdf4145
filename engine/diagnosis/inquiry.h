// An inquiry asks contests about the same records, one after the other. It holds what they share: training data and hold-out, the budget, the
// journal, and the verdicts of earlier contests.
#pragma once

#include <ctime>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/answer.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/parts.h"
#include "diagnosis/polish.h"
#include "diagnosis/saved_points.h"

namespace dynoproof::diagnosis {

/// What came before a diagnosis of the same records.
struct Before {
  std::clock_t begun_at = std::clock();
  double simulations = 0.0;
  std::vector<std::string> notes = {};
  Journal journal = {};
  int took_hum_off = 0;  // times: what one tone has hidden may be another one
  int took_drifts_off = 0;
  bool read_again = false;  // inputs of which nobody says what they do between their samples
};

class Inquiry {
 public:
  /// `begun`: the nominal plan, from where the records start. `own_holdout`: the held-out part is records of its own.
  Inquiry(const EstimationProblem& problem, Plan begun, Parts parts, const std::vector<MappedRecord>& data,
          bool own_holdout, const DiagnoseOptions& options, const Before& before);

  const EstimationProblem& problem() const { return problem_; }
  const Registry& registry() const { return problem_.registry(); }
  const Plan& begun() const { return begun_; }
  void Begin(Plan plan) { begun_ = std::move(plan); }
  const Levels& levels() const { return *parts_.training; }
  const Levels& held_out() const { return *parts_.held_out; }
  const Magnitudes& magnitudes() const { return magnitudes_; }
  /// Whether the held-out part is records of its own, which start elsewhere.
  bool own_holdout() const { return own_holdout_; }

  /// Which effect on top of a null explains what that leaves. `admitted`: by another pass.
  Result<Answer> Ask(Contestant null, bool released, const std::string& stage,
                     std::span<const Contestant> admitted = {});
  /// The same on top of a model of the contest before, and which of that contest's models are twins of its effects.
  Result<Answer> AskOnTop(const Contestant& base, const Contest& before);

  /// The verdict of a contest by itself.
  Settled SettledAlone(const Contest& contest) const;
  /// That of the first contest of all, beside the others for a first cause: what is near the best is so over all of them.
  Settled SettledFirst(const Contest& contest) const;
  /// Once more, with what was found later.
  void SettleAgain(Answer& answer);

  /// The nominal model, fitted at every level, and as a hypothesis alone.
  Contestant Null(bool released) const { return NullOf(begun_, released, levels(), registry()); }
  estimation::Hypothesis NullModel(bool released) const {
    return NullHypothesis(begun_, released, levels(), registry());
  }
  bool PolishAt(std::size_t level, Contestant& one, const Contestant& null) const {
    return Polish(one, null, levels(), level, problem_.plan());
  }
  /// The numbers of a model that is named, from all of the data that models are fitted to.
  void FinishAt(std::size_t level, Contestant& one, const Contestant& null);
  Conduct ConductOf(
      const std::string& stage, std::function<void(double)> progress = [](double) {});

  /// Whether the budget is spent; what was not asked for that is told by Cut().
  bool Spent() const;
  void Cut() { complete_ = false; }
  bool complete() const { return complete_; }
  /// Simulations of all the data, those of searches before among them.
  double simulations() const;
  /// Adds some that were made beside the levels.
  void Count(double simulations) { simulations_before_ += simulations; }
  /// Of one search after another, all threads together.
  double cpu_s() const { return static_cast<double>(std::clock() - begun_at_) / CLOCKS_PER_SEC; }

  Journal& journal() { return journal_; }
  const Journal& journal() const { return journal_; }
  /// A contest and its verdict.
  void Enter(const Contest& contest, const Settled& settled, const std::string& stage);

 private:
  std::vector<HeldOut> OnHeldOut(const Contest& contest) const;

  const EstimationProblem& problem_;
  Plan begun_;
  Parts parts_;
  bool own_holdout_;
  const DiagnoseOptions& options_;
  Magnitudes magnitudes_;
  SavedPoints saved_;
  HeldOut given_;                             // what the plan as given leaves on data that took no part
  std::vector<std::vector<HeldOut>> passes_;  // by contest for a first cause
  std::clock_t begun_at_;
  double simulations_before_;
  bool complete_ = true;
  int asked_ = 0;
  Journal journal_;
};

}  // namespace dynoproof::diagnosis
