#include "thesis/ledger.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/within.h"
#include "scenario/load.h"
#include "thesis/studies.h"

namespace dynoproof {
namespace {

constexpr std::array<const char*, kStandings> kNames = {"reproduced",   "reproduced_assumed", "derived",
                                                        "contradicted", "misprint",           "not_checkable"};

/// The rules of one standing. Every fault stands where the claim does, and says what to write instead.
class ClaimRules {
 public:
  ClaimRules(const Claim& claim, Diagnostics& diagnostics) : claim_(claim), diagnostics_(diagnostics) {}

  void Check() {
    if (claim_.expect == "not_checkable") return CheckNotCheckable();
    CheckStudy();
    const bool limits = claim_.HasLimits(), allowed = std::isfinite(claim_.allowed);
    if (limits == allowed) Fault("needs either allowed or limits (at_least, at_most)", "");
    if (claim_.origin.empty()) Fault("does not say why this tolerance", "add origin = \"...\"");
    if (!claim_.HasThesis() && !claim_.HasIndependent() && !limits) {
      Fault("has nothing to compare with", "add thesis = (what is printed) or independent = (another method)");
    }
    const bool beside = claim_.HasIndependent() && (claim_.HasThesis() || limits);
    if (beside != std::isfinite(claim_.independent_within)) {
      Fault(beside ? "does not say how close to the independent value ours must be"
                   : "has independent_within without an independent value beside something of the thesis",
            beside ? "add independent_within" : "leave independent_within out");
    }
    CheckStanding(limits);
    if ((claim_.expect == "contradicted" || claim_.expect == "misprint") && claim_.explanation.empty()) {
      Fault("has no explanation", "add explanation = \"...\"");
    }
  }

 private:
  void Fault(const std::string& what, const std::string& hint) {
    diagnostics_.Error(claim_.where, fmt::format("claim \"{}\" ({}) {}", claim_.id, claim_.expect, what), hint);
  }

  void CheckNotCheckable() {
    if (claim_.explanation.empty()) Fault("has no explanation", "add explanation = \"...\"");
    if (!claim_.compute.table().empty() || claim_.HasIndependent() || claim_.HasLimits() ||
        std::isfinite(claim_.allowed)) {
      Fault("computes or compares something", "leave out compute, independent, allowed, or give it another standing");
    }
  }

  void CheckStudy() {
    const Value* study = claim_.compute.Find("study");
    if (study != nullptr && study->is_string() && Studies().contains(study->string())) return;
    std::vector<std::string> known;
    for (const auto& [name, function] : Studies()) known.push_back(name);
    Fault("names no study", fmt::format("compute = {{ study = ... }}, one of {}", fmt::join(known, ", ")));
  }

  void CheckStanding(bool limits) {
    const std::string& expect = claim_.expect;
    if (expect == "reproduced") {
      if (!claim_.HasThesis()) {
        Fault("names no figure of the thesis", "add thesis = (what is printed), or expect = \"derived\"");
      }
      if (!claim_.assumed.empty()) Fault("rests on assumed data", "expect = \"reproduced_assumed\"");
    }
    if (expect == "reproduced_assumed") {
      if (claim_.assumed.empty()) Fault("does not say what is assumed", "add assumed = \"...\"");
      if (!claim_.HasThesis() && !limits) {
        Fault("compares with nothing of the thesis", "add thesis, or limits for its words; else expect = \"derived\"");
      }
    }
    if (expect == "derived" && (!claim_.HasIndependent() || claim_.HasThesis() || limits)) {
      Fault("compares with an independent value alone", "give independent and allowed; no thesis, no limits");
    }
    if (expect == "contradicted" && !claim_.HasThesis() && !limits) {
      Fault("contradicts nothing of the thesis", "add thesis = (what is printed), or limits for its words");
    }
  }

  const Claim& claim_;
  Diagnostics& diagnostics_;
};

bool Holds(const Claim& claim, double ours) {
  if (claim.HasLimits())
    return !(ours < claim.at_least) && !(ours > claim.at_most);  // NaN: a limit that is not set; ours is finite
  return Within(std::abs(ours - claim.Reference()), claim.allowed);
}

Standing StandingOf(const Claim& claim, double ours) {
  if (!Holds(claim, ours)) return claim.expect == "misprint" ? Standing::kMisprint : Standing::kContradicted;
  if (!claim.HasThesis() && !claim.HasLimits()) return Standing::kDerived;
  const bool printed = claim.HasThesis() && claim.assumed.empty();
  return printed ? Standing::kReproduced : Standing::kReproducedAssumed;
}

}  // namespace

std::vector<std::string> Claim::StandingNames() { return {kNames.begin(), kNames.end()}; }

const char* ToString(Standing standing) { return kNames[static_cast<std::size_t>(standing)]; }

const char* InWords(Standing standing) {
  switch (standing) {
    case Standing::kReproducedAssumed:
      return "reproduced with assumed data";
    case Standing::kNotCheckable:
      return "not checkable";
    default:
      return ToString(standing);
  }
}

std::string AllowedText(const Claim& claim) {
  const bool low = std::isfinite(claim.at_least), high = std::isfinite(claim.at_most);
  if (low && high) return fmt::format("{:.4g} ... {:.4g}", claim.at_least, claim.at_most);
  if (low) return fmt::format(">= {:.4g}", claim.at_least);
  if (high) return fmt::format("<= {:.4g}", claim.at_most);
  return std::isfinite(claim.allowed) ? fmt::format("+-{:.3g}", claim.allowed) : "";
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
    ClaimRules(claim, diagnostics).Check();
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
  if (!std::isfinite(ours.value)) {
    result.fault = "the study gives no finite number";
    return result;
  }
  if (std::isfinite(claim.independent_within) &&
      !(std::abs(ours.value - claim.independent) <= claim.independent_within)) {
    result.fault = fmt::format("ours, {:.6g}, is not within {:.3g} of the independent value, {:.6g}", ours.value,
                               claim.independent_within, claim.independent);
    return result;
  }
  result.standing = StandingOf(claim, ours.value);
  result.as_expected = ToString(result.standing) == claim.expect;
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
