// What `run` found out, for machines and for people: JSON, JUnit XML, Markdown, a table on the terminal.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "experiment/run_scenario.h"

namespace dynoproof::reports {

/// Exit code of a run (contract): the worst of 2, 3, 1, 5, 4, 0, in that order. No scenario at all is a failure.
int ExitCode(const std::vector<ScenarioResult>& results);
int WorseExit(int a, int b);

/// A number as JSON: null where it is not finite.
nlohmann::json Number(double value);
/// The contract's document for `run`.
nlohmann::json ToJson(const std::vector<ScenarioResult>& results);
/// One test case per check.
std::string ToJUnit(const std::vector<ScenarioResult>& results);
/// Worst first; at most `most_bytes`, what is left out is counted.
std::string ToMarkdown(const std::vector<ScenarioResult>& results, std::size_t most_bytes = 900'000);

/// The table at the end of a run: scenario, checks done and failed, worst check.
std::string ToTable(const std::vector<ScenarioResult>& results, bool colour);
/// One card per failed check that a person understands in a minute. `again`: by id, the command that shows it again.
std::string ToCards(const std::vector<ScenarioResult>& results, const std::map<std::string, std::string>& again,
                    bool colour);

/// Results with the worst first: broken, fail, inconclusive, pass; of these what takes most of a limit; else in their
/// order.
std::vector<const ScenarioResult*> WorstFirst(const std::vector<ScenarioResult>& results);

/// The check that says most about a scenario: the worst verdict, then the largest share of its limit.
const score::Check* WorstCheck(const ScenarioResult& result);

}  // namespace dynoproof::reports
