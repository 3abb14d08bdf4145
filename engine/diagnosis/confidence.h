// How far a verdict is to be trusted, by how often such a one was right about made cases whose truth was opened afterwards.
#pragma once

#include <cstddef>
#include <optional>

#include "diagnosis/conclusion.h"

namespace dynoproof::diagnosis {

/// The share of made cases with this verdict, one effect shown or several, in which every effect that was shown had been hidden (the
/// mean of what that share may be, Jeffreys 1946); of an ambiguous verdict, the first of its sets. Nothing: there were fewer than twenty such cases.
std::optional<double> ConfidenceOf(Conclusion verdict, std::size_t effects);

}  // namespace dynoproof::diagnosis
