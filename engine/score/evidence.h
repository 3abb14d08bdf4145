// What a check judged, for those who draw or explain it: the two courses, the band between which the test had to be,
// and where it was worst.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "score/series.h"
#include "score/tube.h"

namespace dynoproof::score {

/// All courses have one value for each time of `time_s` and the signal's unit, but for `distance`.
struct Evidence {
  enum class Rule { kEverySample, kRms };  // what must not exceed 1: each distance, or the root of their mean square

  std::string signal, unit;
  std::string reference_name, test_name;  // "golden", "run", "reference", the name of an oracle
  Rule rule = Rule::kEverySample;
  double half_width = 0.0;  // of the band, in the signal's unit; positive
  std::vector<double> time_s, reference, test;
  std::vector<double> lower, upper;  // the band
  std::vector<double> distance;      // from the reference, over the half-width: 1 is the edge
  std::size_t worst = 0;             // row of the largest distance
  std::optional<std::size_t> first;  // first row with a distance above 1
};
using SharedEvidence = std::shared_ptr<const Evidence>;

/// What the evidence is of.
struct Compared {
  std::string signal, unit, reference_name, test_name;
};

/// The evidence of a distance from `reference`, at its samples, that is judged against `half_width`. Null where the two
/// cannot be compared (AlignTo()) or the half-width is not positive: the check has failed then, and says why.
SharedEvidence BandEvidence(Compared compared, Evidence::Rule rule, const Series& reference, const Series& test,
                            double half_width);

/// The evidence of CompareTube(reference, ..., options); null where that compared nothing.
SharedEvidence TubeEvidence(Compared compared, const Series& reference, const TubeResult& result,
                            const TubeOptions& options);

}  // namespace dynoproof::score
