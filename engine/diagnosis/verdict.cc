#include "diagnosis/verdict.h"

#include <fmt/format.h>

#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {
namespace {

struct Row {
  const char* rule;
  bool (*applies)(const VerdictEvidence&);
  Verdict verdict;
  std::string (*reason)(const VerdictEvidence&);
};

// From top to bottom; the first row that applies rules.
const Row kTable[] = {
    {"no significant candidate, structure in the residual",
     [](const VerdictEvidence& e) { return e.best.empty() && e.structure; }, Verdict::kUnexplained,
     [](const VerdictEvidence& e) { return fmt::format("no candidate accounts for the residual: {}", e.found); }},
    {"no significant candidate, nominal values without an effect beyond their prior",
     [](const VerdictEvidence& e) { return e.best.empty() && !e.strained.empty(); }, Verdict::kUnexplained,
     [](const VerdictEvidence& e) {
       return fmt::format("the data agree with the model only where {} lies far outside its prior",
                          fmt::join(e.strained, ", "));
     }},
    {"no significant candidate, a nominal value beyond its prior",
     [](const VerdictEvidence& e) { return e.best.empty() && !(e.null_deviation < policy::kBeyondPrior); },
     Verdict::kUnexplained,
     [](const VerdictEvidence& e) {
       return fmt::format(
           "the data agree with the model only where a nominal value lies {:.1f} prior standard deviations off",
           e.null_deviation);
     }},
    {"no significant candidate, noise alone in the residual", [](const VerdictEvidence& e) { return e.best.empty(); },
     Verdict::kNoEffect,
     [](const VerdictEvidence&) {
       return std::string("the data agree with the model within the prior of its nominal values");
     }},
    {"structure in the residual of the best candidate", [](const VerdictEvidence& e) { return e.structure; },
     Verdict::kUnexplained,
     [](const VerdictEvidence& e) {
       return fmt::format("the best candidate, {}, leaves structure in the residual{}{}{}{}", e.best,
                          e.found.empty() ? "" : ": ", e.found, e.pairs.empty() ? "" : "; ", e.pairs);
     }},
    {"a nominal value beyond its prior beside the best candidate",
     [](const VerdictEvidence& e) { return !(e.deviation <= policy::kWithinPrior); }, Verdict::kUnexplained,
     [](const VerdictEvidence& e) {
       return fmt::format("the best candidate, {}, needs another nominal value {:.1f} prior standard deviations off",
                          e.best, e.deviation);
     }},
    {"more candidates alike than can be named", [](const VerdictEvidence& e) { return e.alike > policy::kMostAlike; },
     Verdict::kUnexplained,
     [](const VerdictEvidence& e) { return fmt::format("{} candidates account for the data alike", e.alike); }},
    {"no gain on the hold-out", [](const VerdictEvidence& e) { return !e.holdout_gains.value_or(true); },
     Verdict::kUnexplained,
     [](const VerdictEvidence&) {
       return std::string("what gains on the training data does not gain on the hold-out");
     }},
    {"the interval of the best candidate includes its neutral value",
     [](const VerdictEvidence& e) { return e.includes_neutral; }, Verdict::kUnexplained,
     [](const VerdictEvidence& e) {
       return fmt::format("the 95 % interval of {} includes that there is none of it", e.best);
     }},
    {"several candidates alike", [](const VerdictEvidence& e) { return e.alike > 1; }, Verdict::kAmbiguous,
     [](const VerdictEvidence&) { return std::string("these data cannot tell the candidates apart"); }},
    {"one candidate, noise alone in its residual", [](const VerdictEvidence&) { return true; }, Verdict::kEffectFound,
     [](const VerdictEvidence&) {
       return std::string("the residual is at the noise floor with it, and with nothing else");
     }},
};

}  // namespace

std::string ToString(Verdict verdict) {
  switch (verdict) {
    case Verdict::kEffectFound:
      return "effect_found";
    case Verdict::kMainCause:
      return "main_cause";
    case Verdict::kNoEffect:
      return "no_effect";
    case Verdict::kAmbiguous:
      return "ambiguous";
    case Verdict::kUnexplained:
      break;
  }
  return "unexplained";
}

Ruling VerdictOf(const VerdictEvidence& evidence) {
  const Row* row = kTable;
  while (!row->applies(evidence)) ++row;  // the last one always does
  return {row->verdict, row->rule, row->reason(evidence)};
}

}  // namespace dynoproof::diagnosis
