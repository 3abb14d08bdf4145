// What a failing check shows, and whether another one shows the same.
#pragma once

#include <string>

#include "score/verdict.h"

namespace dynoproof::reduce {

/// A text without its numbers: resonances move, and "resonance 2 at 605.1 Hz" stays the same check.
std::string WithoutNumbers(const std::string& text);

/// What a failing run shows.
struct Symptom {
  std::string name = {};   // of the check, without numbers; empty: the run breaks
  bool number = false;     // a value beyond a limit
  double share = 0.0;      // of the limit
  std::string words = {};  // why there is none, without numbers
  score::Check check = {};

  /// The check of the same name fails in the same way: by a number that is at most ten times as far beyond its limit, or not made
  /// for the same reason.
  bool Same(const Symptom& other) const;
};

Symptom SymptomOf(const score::Check& check);

}  // namespace dynoproof::reduce
