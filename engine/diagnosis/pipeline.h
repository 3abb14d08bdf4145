// One search for what explains records: the nominal model, contests on top of it and of each other, and what is told at the end.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "diagnosis/course.h"
#include "diagnosis/drift.h"
#include "diagnosis/hum.h"
#include "diagnosis/inquiry.h"

namespace dynoproof::diagnosis {

/// Searches of which each ends with hum that it has found, and with drifts.
inline constexpr int kMostHum = 3, kMostDrifts = 1;

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
  const Journal& journal() const { return inquiry_.journal(); }
  /// What inputs of which nobody says it do between their samples, where a model leaves clearly less with that than with what was guessed
  /// beside the nominal one.
  const std::optional<Course>& course() const { return course_; }
  /// The drifts in the hold-out, where that is records of its own: beside the model that was best here.
  std::vector<Drift> DriftsInHoldout() const;

  /// Everything that is told of an answer; once.
  Result<Diagnosis> Report(Answer answer);

  /// The simulations of all the data, those of searches before among them.
  double simulations() const { return inquiry_.simulations(); }

 private:
  Pipeline(std::unique_ptr<EstimationProblem> problem, Plan begun, Parts parts, const std::vector<MappedRecord>& data,
           const std::vector<MappedRecord>& holdout, const DiagnoseOptions& options, const Before& before);

  /// The second pass, of nominal values let go: a model that was fitted naively has swallowed its missing effect, and gives it back only
  /// then. `first`: the answer under the priors; `further`: with what was found on top of it.
  Answer WithNumbersReleased(Answer first, Answer further);

  /// The hum in what a model leaves in the free run; motion through a gap has no free run worth looking at.
  std::vector<Hum> HumBesides(const Contestant& one);

  /// Sensors that drift, where they take most of what the best model of a contest leaves; entered in the journal.
  std::optional<Drifts> DriftsBesides(const Contest& contest);

  std::unique_ptr<EstimationProblem> problem_;
  const std::vector<MappedRecord>& data_;
  const std::vector<MappedRecord>& holdout_;
  const DiagnoseOptions& options_;
  Before before_;
  Inquiry inquiry_;
  std::optional<Contestant> released_;
  std::vector<Hum> hum_;
  std::optional<Drifts> drifts_;
  std::optional<Course> course_;
  std::optional<Plan> left_by_;  // the model beside which hum was looked for
};

}  // namespace dynoproof::diagnosis
