// One search for what explains records: the nominal model, contests on top of it and of each other, and what is told at the end.
#pragma once

#include <ctime>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/answer.h"
#include "diagnosis/course.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/drift.h"
#include "diagnosis/hum.h"
#include "diagnosis/parts.h"
#include "diagnosis/saved_points.h"

namespace dynoproof::diagnosis {

/// Searches of which each ends with hum that it has found, and with drifts.
inline constexpr int kMostHum = 3, kMostDrifts = 1;

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

class Pipeline {
 public:
  /// Fails where the nominal run breaks.
  static Result<std::unique_ptr<Pipeline>> Of(const Plan& plan, const std::vector<MappedRecord>& data,
                                              const std::vector<MappedRecord>& holdout, const Registry& registry,
                                              const DiagnoseOptions& options, const Before& before);

  /// What explains the records; not told yet.
  Result<Answer> Decide();
  /// An answer as plain as another one: by no more effects, and with nominal values let go only where that needed it. Where none leaves
  /// nothing but noise, the last one that was found.
  Result<Answer> DecideAsPlainlyAs(const Answer& other);

  /// The hum in what the nominal model leaves, before any effect was asked for, or in what the best one leaves, where that is not noise
  /// alone and the budget lasts for another search.
  const std::vector<Hum>& hum() const { return hum_; }
  /// The hum in other records of the machine, beside the model with which it was found here.
  std::vector<Hum> HumIn(const std::vector<MappedRecord>& others) const;

  /// Sensors that drift beside the best model, where that leaves more than noise and the budget lasts for another search.
  const std::optional<Drifts>& drifts() const { return drifts_; }
  /// How it came to what it has found, so far.
  const Journal& journal() const { return result_.journal; }
  /// What inputs of which nobody says it do between their samples, where a model leaves clearly less with that than with what was guessed
  /// beside the nominal one.
  const std::optional<Course>& course() const { return course_; }
  /// The drifts in the hold-out, where that is records of its own: beside the model that was best here.
  std::vector<Drift> DriftsInHoldout() const;

  /// Everything that is told of an answer; once.
  Result<Diagnosis> Report(Answer answer);

  /// The simulations of all the data, those of searches before among them.
  double simulations() const;

 private:
  Pipeline(std::unique_ptr<identification::EstimationProblem> problem, Plan begun, Parts parts,
           const std::vector<MappedRecord>& data, const std::vector<MappedRecord>& holdout,
           const DiagnoseOptions& options, const Before& before);

  bool Spent() const;

  /// The hum in what a model leaves in the free run; motion through a gap has no free run worth looking at.
  std::vector<Hum> HumBesides(const Contestant& one);

  /// Sensors that drift, where they take most of what the best model of a contest leaves; entered in the journal.
  std::optional<Drifts> DriftsBesides(const Contest& contest);

  /// The verdict of a contest; of one for a first cause, beside the others for it: what is near the best is so over all of them.
  Settled SettledOn(const Contest& contest, bool first);

  /// Which effect on top of a null explains what that leaves. `admitted`: by another pass.
  Result<Answer> Ask(Contestant null, bool released, const std::string& stage,
                     std::span<const Contestant> admitted = {});

  /// The same on top of a model of the contest before, and which of that contest's models are twins of its effects.
  Result<Answer> AskOnTop(const Contestant& base, const Contest& before);

  /// The answer where the model's own numbers, let go together, leave nothing but noise: which of them are wrong.
  std::optional<Answer> SeveralNumbers(const Contest& under_priors, const Contestant& released);

  /// A model that leaves nothing but noise by numbers that its priors rule out is not right as it is, and lacks no effect.
  static void TellNumbers(const std::vector<std::pair<std::string, double>>& far, Settled& settled);

  /// The answer where records may begin otherwise than the plan by what no first sample shows: asked where a cause leaves nothing but
  /// noise, and where such a start does so too and is not beaten. Every record has some start, so that this is the plainer story.
  std::optional<Answer> BegunOtherwise(const Answer& answer);

  /// Once more with the cause in the model, for there may be several.
  Answer WithFurtherCauses(Answer answer);

  /// Whether one effect fewer leaves nothing but noise, too: one that comes to nothing once all are fitted to the minimum itself has
  /// only led the others there. The model without it then stands in the contest before, in which it may have been left behind.
  bool DoesWithout(Answer& answer, Answer& before);

  /// The null with its nominal values let go. Where it is far from the noise, starts that were found with the nominal values are found once
  /// more with what these have come to.
  Contestant ReleasedNull() const;
  /// Of several effects that leave nothing but noise, but with nominal values far off, one may be right and the others stand for what is missing.
  /// On top of each of them alone a further one is asked for; the answer is taken that leaves nothing but noise and is plausible. Effects on
  /// top of which the answer was found are passed over. `alone`: effects fitted alone.
  std::optional<Answer> FromItsHalves(const Answer& answer, const Contest& alone);
  /// The same answer as one that names nothing: the budget ended before its halves were asked.
  Answer Unasked(Answer answer);
  /// The model with one of its effects, as it was fitted alone.
  Contestant HalfOf(const Contestant& all, const estimation::Hypothesis::Applied& effect, std::size_t level,
                    const Contest& alone) const;

  bool PolishAt(std::size_t level, Contestant& one, const Contestant& null);

  /// A contest on top of a model may have found its minimum only now, from the values of one with an effect more, which adds nothing then.
  bool FoundLater(const Contest& later, std::size_t model, Answer& answer);

  void SettleAgain(Answer& answer);

  void Enter(const Contest& contest, const Settled& settled, const std::string& stage);

  void StandBeside(const Answer& answer, const std::vector<std::string>& alike);

  std::unique_ptr<identification::EstimationProblem> owned_;
  const identification::EstimationProblem& problem_;
  Plan begun_;
  Parts parts_;
  const Levels& levels_;
  const std::vector<MappedRecord>& data_;
  const std::vector<MappedRecord>& holdout_;
  const DiagnoseOptions& options_;
  Magnitudes magnitudes_;
  SavedPoints saved_;
  HeldOut given_;  // what the plan as given leaves on data that took no part
  std::vector<std::vector<HeldOut>>
      passes_;  // by contest for a first cause, of which one alone is near the best or far from it
  std::optional<Contestant> released_;
  std::vector<Hum> hum_;
  std::optional<Drifts> drifts_;
  std::optional<Course> course_;
  std::optional<Plan> left_by_;  // the model beside which hum was looked for
  Before before_;
  int asked_ = 0;
  Diagnosis result_;
};

}  // namespace dynoproof::diagnosis
