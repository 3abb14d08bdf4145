// Two traces signal by signal: what is missing, extra, short, in another unit or outside its tube fails.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "model/params.h"
#include "score/verdict.h"
#include "trace/trace.h"

namespace dynoproof {

/// How far a signal may be from its reference, and why.
struct SignalTolerance {
  double relative_width = 1e-7;  // half-width of the tube over the nominal; without one: over the reference's range
  double time_half_width_s = 0.0;
  std::string origin =
      "the same solver and steps: on the shipped scenarios other vector instructions and compilers differ by at most "
      "1.3 % of this (ci/spread.py)";
  double other_solver_width = 0.0;  // for a run of the other solver; 0: how far that may be is not known
  std::string other_solver_origin;
  SourceSpan where = {};  // of the table, where a file has it
  void Visit(auto& v) {
    v.Required("relative_width", relative_width, Positive("1"), "half-width over the nominal");
    v.Optional("time_half_width_s", time_half_width_s, NonNegative(), "how much earlier or later");
    v.Required("origin", origin, Any(), "why");
    v.Optional("other_solver_width", other_solver_width, NonNegative("1"), "half-width for the other solver");
    v.Optional("other_solver_origin", other_solver_origin, Any(), "why");
  }
};
using SignalTolerances = std::map<std::string, SignalTolerance>;

enum class ReferenceIs {
  /// The tube holds at every sample of either trace, over the span that both have.
  kWhole,
  /// Thin() of a run with the test's time stamps. The tube holds at the samples that it keeps, and for the least, the
  /// greatest and the mean value of each stretch between two of them.
  kThinned
};

/// Two traces signal by signal; `kind` begins the names of the checks. Without a tolerance a signal has the default
/// one. `notes` takes what was compared where the time stamps differ.
std::vector<score::Check> CompareTraces(const trace::Trace& reference, const trace::Trace& test,
                                        const SignalTolerances& tolerances, const std::string& kind,
                                        ReferenceIs reference_is = ReferenceIs::kWhole,
                                        std::vector<std::string>* notes = nullptr);

/// A check that fails since its comparison did not happen.
score::Check NotCompared(const std::string& name, const std::string& kind, std::string why);

/// A tolerance for a signal that neither trace has protects nothing: one fault each, with the name that was meant.
void CheckTolerances(const SignalTolerances& tolerances, const trace::Trace& reference, const trace::Trace& test,
                     Diagnostics& diagnostics);

}  // namespace dynoproof
