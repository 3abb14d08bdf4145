// What of the thesis is here, golden/coverage.toml: a row for each of its models, algorithms, experiments, figures and
// tables, with what covers it and how far.
#pragma once

#include <string>
#include <vector>

#include "thesis/atlas.h"
#include "thesis/ledger.h"

namespace dynoproof {

/// One row as written. whole: all that the thesis says of it is computed here from what it prints, or from what is derived
/// from that. assumed: the same, with data that the thesis does not print. partial: something of it is not computed,
/// cannot be compared or comes out otherwise. not_given: the thesis gives nothing of it to compute from, a photograph or a
/// curve without a number. missing: nothing of it is here, though there could be.
struct CoverageRow {
  std::string name, kind, place, title, state, reason;
  std::vector<std::string> scenarios, claims, figures, studies, plugins;
  SourceSpan where = {};
  void Visit(auto& v) {
    v.Required("name", name, Any(), "a word or two, unique; \"Fig. 5.19\", \"Table A.7\"");
    v.Required("kind", kind, Kinds(), "what it is; a diagram: a figure without axes, whose structure is built");
    v.Optional("place", place, Any(), "where the thesis has it; left out for what is named by its number");
    v.Required("title", title, Any(), "what it is or shows, in our words");
    v.Required("state", state, States(), "how much of it is here");
    v.Optional("reason", reason, Any(), "why it is not whole, in a sentence");
    v.Optional("scenarios", scenarios, Any(), "ids of scenarios");
    v.Optional("claims", claims, Any(), "ids of claims of the ledger");
    v.Optional("figures", figures, Any(), "numbers of figures of the atlas");
    v.Optional("studies", studies, Any(), "names of studies of the ledger");
    v.Optional("plugins", plugins, Any(),
               "kind and name: \"law.phase_plane\", \"effect.backlash\", \"check.contacts\"");
  }
  static std::vector<std::string> Kinds() { return {"model", "algorithm", "experiment", "figure", "diagram", "table"}; }
  static std::vector<std::string> States() { return {"whole", "assumed", "partial", "not_given", "missing"}; }

  /// All that covers it, in words: "scenarios a, b; claims c".
  std::string CoveredBy() const;
};

/// All rows of the file; those of figures, diagrams and tables are completed by the atlas' figure and the claims whose place
/// names them. Faults become diagnostics: a row that names what is not there, that is not whole without a reason, or that is
/// called more than the claims and figures it rests on; a figure that the atlas does not draw; a figure of the atlas or of a
/// claim without a row.
std::vector<CoverageRow> ReadCoverage(const std::string& file, const Registry& registry,
                                      const std::vector<AtlasFigure>& figures, const std::vector<Claim>& claims,
                                      Diagnostics& diagnostics);

/// How many rows of a kind ("" for all) are in each state, in the order of States().
std::vector<int> CountStates(const std::vector<CoverageRow>& rows, const std::string& kind);

}  // namespace dynoproof
