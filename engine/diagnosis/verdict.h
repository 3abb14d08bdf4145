// What a diagnosis may say.
#pragma once

#include <string>

namespace dynoproof::diagnosis {

enum class Verdict { kEffectFound, kMainCause, kNoEffect, kAmbiguous, kUnexplained };
/// "effect_found", as in a result.
std::string ToString(Verdict verdict);

}  // namespace dynoproof::diagnosis
