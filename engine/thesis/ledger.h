// The claims ledger, golden/published.toml: what the thesis prints, what another method gives, what comes out here, and
// what that means.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "experiment/checks.h"
#include "model/registry.h"

namespace dynoproof {

/// reproduced: ours is the figure that the thesis prints, from data that it prints. reproduced_assumed: the same, or a
/// statement in words under a stated reading, but something in it is assumed. derived: ours is an identity or a value
/// of our own from another method; the thesis prints no such figure. contradicted: ours is not what the thesis says.
/// misprint: what is printed does not hold, shown by derivation. not_checkable: nothing here can decide it.
enum class Standing { kReproduced, kReproducedAssumed, kDerived, kContradicted, kMisprint, kNotCheckable };
inline constexpr int kStandings = 6;

/// One claim as written.
struct Claim {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::string id, place, claim, unit = "1", origin, assumed, explanation;
  double thesis = kNone, independent = kNone;
  double allowed = kNone, at_least = kNone, at_most = kNone, independent_within = kNone;
  std::string expect;  // one of the standings
  Value compute;       // study = "name" and its parameters; empty for what cannot be checked
  SourceSpan where;
  void Visit(auto& v) {
    v.Required("id", id, Any(), "short name, unique");
    v.Required("place", place, Any(), "where the thesis says it");
    v.Required("claim", claim, Any(), "what it says, in our words");
    v.Required("expect", expect, StandingNames(), "our verdict");
    v.Optional("thesis", thesis, Any("1"), "the figure that the thesis prints; absent when it prints none");
    v.Optional("independent", independent, Any("1"), "the value by another method, or of an identity");
    v.Optional("unit", unit, Any(), "unit of all of them");
    v.Optional("allowed", allowed, NonNegative("1"), "largest deviation that counts as the same");
    v.Optional("at_least", at_least, Any("1"), "lower limit: how words of the thesis are read");
    v.Optional("at_most", at_most, Any("1"), "upper limit");
    v.Optional("independent_within", independent_within, NonNegative("1"),
               "largest deviation from `independent` beside a figure or words of the thesis");
    v.Optional("origin", origin, Any(), "why this tolerance, or these limits");
    v.Optional("assumed", assumed, Any(), "which data the thesis does not print");
    v.Optional("compute", compute, Any(), "study and its parameters");
    v.Optional("explanation", explanation, Any(), "why it is contradicted or cannot be checked, or what to know");
  }
  static std::vector<std::string> StandingNames();

  bool HasThesis() const { return std::isfinite(thesis); }
  bool HasIndependent() const { return std::isfinite(independent); }
  bool HasLimits() const { return std::isfinite(at_least) || std::isfinite(at_most); }
  /// What ours is compared with: the thesis' figure, else the independent one, else NaN (limits alone).
  double Reference() const { return HasThesis() ? thesis : independent; }
};

/// One claim as found.
struct ClaimResult {
  Claim claim;
  std::optional<Figure> ours;
  Standing standing = Standing::kNotCheckable;
  bool as_expected = false;  // a claim that changes its standing is a failure, whichever way
  std::string fault;         // the study failed, or does not give the independent value
};

const char* ToString(Standing standing);
/// The same in words: "reproduced with assumed data".
const char* InWords(Standing standing);
/// "+-0.05", ">= 500", "<= 1", "592 ... 614", "" for what is not compared.
std::string AllowedText(const Claim& claim);

/// All claims of the ledger; faults become diagnostics: a claim twice, a study that does not exist, a standing whose
/// figures are missing, a contradiction without explanation.
std::vector<Claim> ReadLedger(const std::string& file, Diagnostics& diagnostics);
/// The claim beside our figure.
ClaimResult Judge(const Claim& claim, const Figure& ours);
/// Computes what the claim needs and no more, and judges it.
ClaimResult Reproduce(const Registry& registry, const Claim& claim);

}  // namespace dynoproof
