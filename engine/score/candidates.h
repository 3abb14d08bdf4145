// The candidates of explain.h, each fitted on its own. Internal to the layer.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "score/explain.h"

namespace dynoproof::score {

/// Reference x and test y on one uniform base, and their difference.
struct Pair {
  std::vector<double> x, y, d;
  double step_s = 0.0;
  double start_s = 0.0;
  double difference_square = 0.0;  // sum of d^2

  double Duration() const { return step_s * Num(d.size()); }
};

struct Candidate {
  Cause cause = Cause::kNone;
  int complexity = 0;        // about the number of free parameters
  double unexplained = 1.0;  // of the difference's mean square
  bool structural = true;    // whether a residual that still follows the reference refutes it
  std::vector<double> residual;
  std::size_t first = 0;  // sample that the residual starts at
  std::vector<Quantity> quantities;
  std::string text;
};
using Candidates = std::vector<Candidate>;

double SumOfSquares(std::span<const double> v);

/// Gain, offset, shift and their combinations, sign flips, drift.
void AddScalings(const Pair& pair, const std::string& unit, Candidates& out);

/// A shift too fine for the reference's samples to show, of a test that is sampled more densely: up to two samples of
/// the reference, with `start_s` and `step_s` of the pair as its time base.
void AddFineShift(const Pair& pair, const Series& test, Candidates& out);

/// Events shifted (the reference warped in time to the test's events), in another order, missing or extra.
void AddEvents(const Pair& pair, const ExplainOptions& options, Candidates& out);

/// R^2 of the regression of `residual` (from sample `first` of the pair) on functions of the reference: x earlier and
/// later by up to 63 samples (any short linear filter), x|x|, x^3, t x, t x', t. Near 0 for what has nothing to do with
/// it.
double RelationToReference(const Pair& pair, std::span<const double> residual, std::size_t first);

}  // namespace dynoproof::score
