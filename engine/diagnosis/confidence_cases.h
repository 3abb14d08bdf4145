// Written by bench/confidence.py from bench/confidence.json: made cases by their verdict, of the program c7dd48a.
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
    {Conclusion::kAmbiguous, false, 13, 8},
    {Conclusion::kAmbiguous, true, 3, 2},
    {Conclusion::kEffectFound, false, 98, 96},
    {Conclusion::kEffectFound, true, 12, 11},
    {Conclusion::kMainCause, false, 9, 4},
    {Conclusion::kUnexplained, false, 25, 2},
};
// clang-format on

}  // namespace dynoproof::diagnosis
