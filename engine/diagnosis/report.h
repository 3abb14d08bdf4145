// A diagnosis as JSON (the contract's layout) and as a table for people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "diagnosis/diagnose.h"

namespace dynoproof::diagnosis {

nlohmann::json ToJson(const Diagnosis& diagnosis);
/// NRMSE before and after by signal, and the gain's interval if asked for.
nlohmann::json ToJson(const std::map<std::string, SignalGain>& gains, bool interval);
/// The verdict in words: the cause, its place, its values, and the share of the error that it explains; the causes of which it may be one;
/// what comes nearest where none is named; else the reason.
std::string Sentence(const Diagnosis& diagnosis);
/// Whether the reason tells what the sentence does not.
bool TellsMoreThanItsSentence(const Diagnosis& diagnosis);
/// That sentence first, then cause, gain, what was considered and why not.
std::string ToTable(const Diagnosis& diagnosis);

}  // namespace dynoproof::diagnosis
