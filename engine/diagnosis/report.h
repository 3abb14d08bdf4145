// A diagnosis as JSON (the contract's layout) and as a table for people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "diagnosis/diagnose.h"

namespace dynoproof::diagnosis {

nlohmann::json ToJson(const Diagnosis& diagnosis);
/// NRMSE before and after by signal, and the gain's interval if asked for.
nlohmann::json ToJson(const std::map<std::string, SignalGain>& gains, bool interval);
/// The verdict in words: the cause, its place, its values, and the share of the error that it explains. The reason where no cause is named.
std::string Sentence(const Diagnosis& diagnosis);
/// That sentence first, then cause, gain, what was considered and why not.
std::string ToTable(const Diagnosis& diagnosis);

}  // namespace dynoproof::diagnosis
