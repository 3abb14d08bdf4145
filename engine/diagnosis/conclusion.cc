#include "diagnosis/conclusion.h"

namespace dynoproof::diagnosis {

std::string ToString(Conclusion verdict) {
  switch (verdict) {
    case Conclusion::kEffectFound:
      return "effect_found";
    case Conclusion::kMainCause:
      return "main_cause";
    case Conclusion::kNoEffect:
      return "no_effect";
    case Conclusion::kAmbiguous:
      return "ambiguous";
    case Conclusion::kUnexplained:
      break;
  }
  return "unexplained";
}

}  // namespace dynoproof::diagnosis
