// The decision table: from evidence to a verdict. The one place that sets a verdict.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dynoproof::diagnosis {

enum class Verdict { kEffectFound, kMainCause, kNoEffect, kAmbiguous, kUnexplained };
std::string ToString(Verdict verdict);

/// What a verdict rests on, without the fits themselves.
struct VerdictEvidence {
  std::string best;                   // the best candidate that is significant; empty: none is
  double deviation = 0.0;             // largest of the nuisance parameters beside it [prior standard deviations]
  std::size_t alike = 0;              // candidates that the data cannot tell from it, and itself
  bool structure = false;             // the residual of the best candidate, else of the null model, is more than noise
  std::string found;                  // what the residual tests say of it; may be empty
  std::string pairs;                  // what became of pairs of effects; empty: none was tried
  std::vector<std::string> strained;  // nominal values without an effect of their own that the null model moves too far
  double null_deviation = 0.0;        // largest of the null model's nuisance parameters [prior standard deviations]
  // Whether the best candidate gains on the hold-out, on the scenario as written and on the nominal model with the values
  // that were fitted to it alone; nothing: not opened yet.
  std::optional<bool> holdout_gains;
  bool includes_neutral = false;  // the interval that is printed says that the best candidate may be none
};

struct Ruling {
  Verdict verdict = Verdict::kUnexplained;
  std::string rule;    // the row of the table
  std::string reason;  // one sentence for the user
};
/// The first row of the table that applies.
Ruling VerdictOf(const VerdictEvidence& evidence);

}  // namespace dynoproof::diagnosis
