// Written by bench/confidence.py from bench/confidence.json: made cases by their verdict, of the program 4de852a.
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
    {Conclusion::kAmbiguous, false, 5, 5},
    {Conclusion::kAmbiguous, true, 1, 1},
    {Conclusion::kEffectFound, false, 28, 28},
    {Conclusion::kEffectFound, true, 7, 6},
    {Conclusion::kMainCause, false, 3, 1},
    {Conclusion::kUnexplained, false, 1, 0},
};
// clang-format on

}  // namespace dynoproof::diagnosis
