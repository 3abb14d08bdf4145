// What one part of the records says: who accounts for it, whether that is enough for a cause to be named, and what the
// cause gains on the hold-out.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "diagnosis/decide.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/search.h"

namespace dynoproof::diagnosis {

inline constexpr double kTrainingShare = 0.7;  // of records without a hold-out of their own

class Judgement {
 public:
  /// `problem`: made of `data` cut at `training`, out of a share `until` of the records that is looked at. `given`: the
  /// same records as they were given, by which the gain is measured.
  Judgement(const EstimationProblem& problem, double training, double until, const std::vector<MappedRecord>& data,
            const std::vector<MappedRecord>& given, const std::vector<MappedRecord>& holdout,
            const DiagnoseOptions& options);

  /// Who accounts for the data; `suspects` are candidates from elsewhere. `saved`: file of the fits in the output
  /// folder. Fails where the nominal run breaks.
  Status Decide(const char* saved, const std::vector<Hypothesis>& suspects = {});

  bool LeavesStructure() const { return result_.verdict == Verdict::kUnexplained && !result_.at_noise_floor; }
  /// Those that account for the data, best first; none: nothing does, or nothing has to.
  std::vector<Hypothesis> Causes() const;
  /// The best effect's intervals are wider by so much to either side, by parameter.
  void Widen(std::vector<double> drift) { drift_ = std::move(drift); }
  void Note(std::string note) { result_.notes.push_back(std::move(note)); }

  /// The verdict with what it gains, and the files. Last call.
  Result<Diagnosis> Report();

 private:
  void Judge();
  /// Sets verdict and reason by the decision table.
  void Rule();
  void JournalScreening();
  void JournalCandidate(const Standing& s, const Estimate& fit, bool within, bool beyond, bool nothing,
                        const std::string& outcome);
  void JournalResidual();
  /// Nominal values that no effect stands for, which the nominal model needs far outside their priors.
  std::vector<std::string> Strained(const Estimate& null) const;
  Status Conclude();
  void ReportEffects(const std::vector<Estimate>& fits);
  /// The floor by channel: white noise as the highest frequencies show it, or, where the noise has a colour of its own
  /// and nothing but noise is left, the residual itself.
  void AskIntervals(const Estimate& best);
  void NoiseFloor(const Estimate& best);
  /// Opened once, after the choice.
  Status MeasureGain(const Estimate& best);

  const EstimationProblem& problem_;  // all that is for training
  const double training_;
  const std::vector<MappedRecord>& data_;
  const std::vector<MappedRecord>& given_;
  const std::vector<MappedRecord>& holdout_;
  const DiagnoseOptions& options_;
  Found found_;
  Diagnosis result_;
  VerdictEvidence evidence_;
  std::string rule_;  // the row of the decision table that applied
  std::vector<std::size_t> alike_;
  std::vector<std::string> also_;  // nominal values that account for the data alike
  std::vector<double> floor_;
  std::vector<double> drift_;  // of the best effect's parameters, see Widen()
};

}  // namespace dynoproof::diagnosis
