// Compares the result of a diagnosis with the truth, which is opened only then.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "model/registry.h"
#include "tests/blind/blind_case.h"

namespace dynoproof::blind {

/// right, in the set, abstained, missed, wrong, false alarm or broken. In an inexact world a main cause counts, too, as do
/// names beside the truth that stand for what is inexact; there `near` says that nothing but these was named where
/// nothing was hidden.
std::string Judged(const Case& hidden, const nlohmann::json& result);

/// How many of the true parameters of causes that were named lie inside their intervals, and of how many.
std::pair<int, int> Covered(const Case& hidden, const nlohmann::json& result, const Registry& registry);

/// Whether the extended scenario predicts the hold-out (the last 30 %) within 1.1 times the noise, every signal.
bool AtNoise(const Case& hidden, const nlohmann::json& result, const Columns& columns, const Columns& clean);

/// The causes, "a@b + c@d", or what else the case hides.
std::string TruthOf(const Case& hidden);

}  // namespace dynoproof::blind
