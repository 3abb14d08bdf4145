// The claims ledger, golden/published.toml: what the thesis says, what comes out here, and what that means.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "experiment/checks.h"
#include "model/registry.h"

namespace dynoproof {

enum class Standing { kReproduced, kContradicted, kNotCheckable };

/// One claim as written.
struct Claim {
  std::string id, place, claim, unit, origin, explanation;
  double published = 0.0, tolerance = 0.0;
  std::string expect;  // reproduced, contradicted, not_checkable
  Value compute;       // study = "name" and its parameters; empty for what cannot be checked
  SourceSpan where;
  void Visit(auto& v) {
    v.Required("id", id, Any(), "short name, unique");
    v.Required("place", place, Any(), "where the thesis says it");
    v.Required("claim", claim, Any(), "what it says, in our words");
    v.Required("expect", expect, std::vector<std::string>{"reproduced", "contradicted", "not_checkable"},
               "our verdict");
    v.Optional("published", published, Any("1"), "the printed figure");
    v.Optional("unit", unit, Any(), "its unit");
    v.Optional("tolerance", tolerance, NonNegative("1"), "largest deviation that counts as the same");
    v.Optional("origin", origin, Any(), "why this tolerance");
    v.Optional("compute", compute, Any(), "study and its parameters");
    v.Optional("explanation", explanation, Any(), "why it is contradicted or cannot be checked, or what to know");
  }
};

/// One claim as found.
struct ClaimResult {
  Claim claim;
  std::optional<Figure> ours;
  Standing standing = Standing::kNotCheckable;
  bool as_expected = false;  // a claim that changes its standing is a failure, whichever way
  std::string fault;         // the study failed
};

const char* ToString(Standing standing);

/// All claims of the ledger; faults (a claim twice, a study that does not exist, a contradiction without explanation)
/// become diagnostics.
std::vector<Claim> ReadLedger(const std::string& file, Diagnostics& diagnostics);
/// The claim beside our figure.
ClaimResult Judge(const Claim& claim, const Figure& ours);
/// Computes what the claim needs and no more, and judges it.
ClaimResult Reproduce(const Registry& registry, const Claim& claim);

}  // namespace dynoproof
