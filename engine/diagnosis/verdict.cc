#include "diagnosis/verdict.h"

namespace dynoproof::diagnosis {

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

}  // namespace dynoproof::diagnosis
