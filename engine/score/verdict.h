// The verdict of a score: one Check as it stands in the JSON of `run`, and how many checks become one verdict.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace dynoproof::score {

enum class Verdict { kPass, kFail, kBroken, kInconclusive };

/// "pass", "fail", "broken" or "inconclusive".
std::string_view ToString(Verdict verdict);

/// The exit code a lone verdict asks for: 0, 1, 3, 4 in the order of the enumeration.
int ExitCode(Verdict verdict);

/// The worse of two verdicts: broken, then fail, then inconclusive, then pass.
Verdict Worse(Verdict a, Verdict b);

/// What every score starts from. A fresh Outcome fails: a function that forgets to decide cannot pass.
struct Outcome {
  Verdict verdict = Verdict::kFail;
  std::string reason;  // one line; always set unless the verdict is a pass

  bool ok() const { return verdict == Verdict::kPass; }
};

struct Evidence;  // score/evidence.h

/// One line of a report. `value` and `limit` are NaN where the check never came to a number; writers turn that to null.
struct Check {
  std::string name;
  std::string kind;  // "tube", "hull", "resonance", "nrmse", "claim", "oracle", ...
  Verdict verdict = Verdict::kFail;
  double value = 0.0;
  double limit = 0.0;
  std::string unit;
  std::string origin;       // why this limit
  std::string explanation;  // what was seen
  bool at_least = false;    // the limit is the least: the check holds when value >= limit
  std::string stated = {};  // the kind of the [[check]] that made it, "golden"; empty: made without one
  std::string shown = {};   // the value as a person reads it, in the signal's unit; empty: value and limit say it
  std::shared_ptr<const Evidence> evidence = {};  // what was compared; null where no two courses were
  std::string cause = {};  // "resonance moved from 97.4 to 96.9 Hz"; empty where none was found or looked for
};

/// The verdict over all checks: the worst wins; no check at all is a failure, because nothing was compared.
Verdict Combine(std::span<const Check> checks);

/// A check that holds when value <= limit. A value or limit that is not finite fails and says so.
Check AtMost(std::string name, std::string kind, double value, double limit, std::string unit, std::string origin,
             std::string explanation = "");

/// The same for value >= limit.
Check AtLeast(std::string name, std::string kind, double value, double limit, std::string unit, std::string origin,
              std::string explanation = "");

/// The check of an outcome: its verdict and reason, with the number that decided it. A pass with a number that is not
/// finite, or above its limit, becomes a failure.
Check ToCheck(const Outcome& outcome, std::string name, std::string kind, double value, double limit, std::string unit,
              std::string origin);

}  // namespace dynoproof::score
