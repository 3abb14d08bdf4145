// The sentence under a failed comparison: where it begins, how much, and the likely cause.
#pragma once

#include <limits>
#include <string>

#include "score/series.h"
#include "score/verdict.h"

namespace dynoproof {

struct Reason {
  std::string text;   // "apart from t = 1.2 s on (3.4 instead of 3.1 N m), most at t = ...; likely cause: gain 1.05"
  std::string cause;  // "gain 1.05"; empty where no simple cause explains the difference
  void To(score::Check& check) const {
    check.explanation = text;
    check.cause = cause;
  }
};

/// Why a test differs. `threshold` [unit of the signal] is the error from which on two values count as apart; before
/// `from_s` none does.
Reason Why(const score::Series& reference, const score::Series& test, double threshold, const std::string& unit,
           double from_s = -std::numeric_limits<double>::infinity());

}  // namespace dynoproof
