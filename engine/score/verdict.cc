#include "score/verdict.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/within.h"

namespace dynoproof::score {
namespace {

int Rank(Verdict verdict) {  // the exit order of the contract, 3 before 1 before 4 before 0
  switch (verdict) {
    case Verdict::kBroken:
      return 3;
    case Verdict::kFail:
      return 2;
    case Verdict::kInconclusive:
      return 1;
    case Verdict::kPass:
      return 0;
  }
  return 3;  // a value outside the enumeration is a broken promise, never a pass
}

std::string NotANumber(double value, double limit) {
  return fmt::format("not a number to judge: value {}, limit {}", value, limit);
}

}  // namespace

std::string_view ToString(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kFail:
      return "fail";
    case Verdict::kInconclusive:
      return "inconclusive";
    case Verdict::kBroken:
      break;
  }
  return "broken";
}

int ExitCode(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return 0;
    case Verdict::kFail:
      return 1;
    case Verdict::kInconclusive:
      return 4;
    case Verdict::kBroken:
      break;
  }
  return 3;
}

Verdict Worse(Verdict a, Verdict b) { return Rank(a) >= Rank(b) ? a : b; }

Verdict Combine(std::span<const Check> checks) {
  if (checks.empty()) return Verdict::kFail;
  Verdict worst = Verdict::kPass;
  for (const Check& check : checks) worst = Worse(worst, check.verdict);
  return worst;
}

Check AtMost(std::string name, std::string kind, double value, double limit, std::string unit, std::string origin,
             std::string explanation) {
  Outcome outcome{Verdict::kPass, std::move(explanation)};
  return ToCheck(outcome, std::move(name), std::move(kind), value, limit, std::move(unit), std::move(origin));
}

Check AtLeast(std::string name, std::string kind, double value, double limit, std::string unit, std::string origin,
              std::string explanation) {
  Check check{std::move(name), std::move(kind),   Verdict::kPass,         value, limit,
              std::move(unit), std::move(origin), std::move(explanation), true};
  if (!std::isfinite(value) || !std::isfinite(limit)) {
    check.verdict = Verdict::kFail;
    check.explanation = NotANumber(value, limit);
  } else if (!Reaches(value, limit)) {
    check.verdict = Verdict::kFail;
    if (check.explanation.empty()) check.explanation = fmt::format("{:.6g} falls short of {:.6g}", value, limit);
  }
  return check;
}

Check ToCheck(const Outcome& outcome, std::string name, std::string kind, double value, double limit, std::string unit,
              std::string origin) {
  Check check{std::move(name), std::move(kind), outcome.verdict,   value,
              limit,           std::move(unit), std::move(origin), outcome.reason};
  if (outcome.verdict != Verdict::kPass) return check;
  if (!std::isfinite(value) || !std::isfinite(limit)) {
    check.verdict = Verdict::kFail;
    check.explanation = NotANumber(value, limit);
  } else if (!Within(value, limit)) {
    check.verdict = Verdict::kFail;
    if (check.explanation.empty()) check.explanation = fmt::format("{:.6g} exceeds {:.6g}", value, limit);
  }
  return check;
}

}  // namespace dynoproof::score
