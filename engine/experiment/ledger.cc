#include "experiment/ledger.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "experiment/studies.h"
#include "scenario/load.h"

namespace dynoproof {

const char* ToString(Standing standing) {
  switch (standing) {
    case Standing::kReproduced:
      return "reproduced";
    case Standing::kContradicted:
      return "contradicted";
    default:
      return "not_checkable";
  }
}

std::vector<Claim> ReadLedger(const std::string& file, Diagnostics& diagnostics) {
  std::vector<Claim> claims;
  const std::optional<Plan> plan = LoadPlan(file, {}, diagnostics);
  const Value* tables = plan ? plan->root.Find("claim") : nullptr;
  if (tables == nullptr || !tables->is_array()) {
    if (plan) diagnostics.Error({file}, "the ledger has no [[claim]]");
    return claims;
  }
  std::set<std::string> ids;
  for (const Value& table : tables->array()) {
    Claim claim;
    claim.where = table.where();
    if (!ReadParams(table, claim, diagnostics, "claim")) continue;
    if (!ids.insert(claim.id).second)
      diagnostics.Error(claim.where, fmt::format("a second claim \"{}\"", claim.id), "rename one");
    const bool checkable = claim.expect != "not_checkable";
    const Value* study = claim.compute.Find("study");
    if (checkable && (study == nullptr || !study->is_string() || !Studies().contains(study->string()))) {
      std::vector<std::string> known;
      for (const auto& [name, function] : Studies()) known.push_back(name);
      diagnostics.Error(claim.where, fmt::format("claim \"{}\" names no study", claim.id),
                        fmt::format("compute = {{ study = ... }}, one of {}", fmt::join(known, ", ")));
    }
    if (checkable && (table.Find("published") == nullptr || claim.origin.empty())) {
      diagnostics.Error(claim.where, fmt::format("claim \"{}\" needs published, tolerance and its origin", claim.id));
    }
    if (claim.expect != "reproduced" && claim.explanation.empty()) {
      diagnostics.Error(claim.where, fmt::format("claim \"{}\" is {} without an explanation", claim.id, claim.expect),
                        "add explanation = \"...\"");
    }
    claims.push_back(std::move(claim));
  }
  return claims;
}

ClaimResult Judge(const Claim& claim, const Figure& ours) {
  ClaimResult result;
  result.claim = claim;
  if (ours.unit != claim.unit) {
    result.fault = fmt::format("the study gives \"{}\", the claim is in \"{}\"", ours.unit, claim.unit);
    return result;
  }
  result.ours = ours;
  const bool same = std::isfinite(ours.value) && std::abs(ours.value - claim.published) <= claim.tolerance;
  result.standing = same ? Standing::kReproduced : Standing::kContradicted;
  result.as_expected = ToString(result.standing) == claim.expect && std::isfinite(ours.value);
  return result;
}

ClaimResult Reproduce(const Registry& registry, const Claim& claim) {
  ClaimResult result;
  result.claim = claim;
  if (claim.expect == "not_checkable") {
    result.as_expected = true;
    return result;
  }
  const Result<Figure> figure = Studies().at(claim.compute.Find("study")->string())(registry, claim.compute);
  if (figure.ok()) return Judge(claim, *figure);
  result.fault = figure.failure().ToString();
  return result;
}

}  // namespace dynoproof
