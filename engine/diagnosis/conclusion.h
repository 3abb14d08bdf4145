// What a diagnosis may say.
#pragma once

#include <string>

namespace dynoproof::diagnosis {

enum class Conclusion { kEffectFound, kMainCause, kNoEffect, kAmbiguous, kUnexplained };
/// "effect_found", as in a result.
std::string ToString(Conclusion verdict);

}  // namespace dynoproof::diagnosis
