// Written by bench/confidence.py from bench/confidence.json: made cases by their verdict, of the program 385582f.
#pragma once

#include "diagnosis/conclusion.h"

namespace dynoproof::diagnosis {

struct MadeCases {
  Conclusion verdict;
  bool several;  // effects were shown
  int count, right;
};
// clang-format off
inline constexpr MadeCases kMadeCases[] = {
    {Conclusion::kAmbiguous, false, 15, 9},
    {Conclusion::kAmbiguous, true, 1, 1},
    {Conclusion::kEffectFound, false, 73, 73},
    {Conclusion::kEffectFound, true, 9, 8},
    {Conclusion::kMainCause, false, 3, 1},
    {Conclusion::kUnexplained, false, 9, 0},
};
// clang-format on

}  // namespace dynoproof::diagnosis
