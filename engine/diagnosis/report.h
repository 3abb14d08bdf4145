// A diagnosis as JSON (the contract's layout) and as a table for people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "diagnosis/diagnose.h"

namespace dynoproof::diagnosis {

nlohmann::json ToJson(const Diagnosis& diagnosis);
/// NRMSE before and after by signal, and the gain's interval if asked for.
nlohmann::json ToJson(const std::map<std::string, SignalGain>& gains, bool interval);
/// What a person wants to know first: the cause in words, where, how large, and what share of the error it explains; where none is named,
/// why not.
std::string Sentence(const Diagnosis& diagnosis);
/// That sentence first, then cause, gain, what was considered and why not.
std::string ToTable(const Diagnosis& diagnosis);

}  // namespace dynoproof::diagnosis
