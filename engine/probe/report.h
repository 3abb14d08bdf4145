// Findings as text, as JSON and back.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "probe/probe.h"

namespace dynoproof::probe {

/// "4.1 %", "0.3 N m", "-2e-05 s": a strength as people read it; shares in per cent.
std::string StrengthText(double strength, const std::string& unit);

/// What passes: "up to +4.1 %", "any, up to 20 N m", "down to a limit of 480".
std::string PassesText(const Finding& finding);

/// A sentence for the first line: how many of how many usual errors would pass, and the largest three.
std::string Sentence(const Probed& probed);

/// The holes, then the weakest of what is seen, then what leaves no trace.
std::string ToTable(const Probed& probed);

nlohmann::json ToJson(const Finding& finding);
/// Nothing where it is not what ToJson() writes.
std::optional<Finding> FromJson(const nlohmann::json& document);

/// What has to be seen: an effect (or another change by name) at a strength, as --see "stiffness_change=5 %" asks for it.
struct Demand {
  std::string name;
  double strength = 0.0;  // 0: what is usual
};
/// "stiffness_change=0.05", "stiffness_change=5%", "turned_sign"; nothing where it is none of these.
std::optional<Demand> ParseDemand(const std::string& text);
/// The findings that a demand is not met by: at each place and in each direction that can be built and leaves a trace.
std::vector<const Finding*> Unmet(const Demand& demand, const std::vector<Finding>& findings);

}  // namespace dynoproof::probe
