// What the rows of a campaign say together.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/campaign.h"
#include "campaign/rows.h"
#include "score/rate.h"

namespace dynoproof::campaign {

struct FigureSummary {
  std::string name, unit;
  std::int64_t runs = 0;                                  // that have it
  double mean = 0.0, mean_lower = 0.0, mean_upper = 0.0;  // 95 %
  double least = 0.0, q05 = 0.0, q25 = 0.0, median = 0.0, q75 = 0.0, q95 = 0.0, largest = 0.0;
  double median_lower = 0.0, median_upper = 0.0;  // 95 %, from the ranks: whatever the distribution
  std::int64_t least_run = 0, largest_run = 0;
  std::vector<double> rank_correlation;  // Spearman's, with each axis
};

struct RateSummary {
  std::string name, group;  // group: "" for all, else the value of the axis
  score::Rate rate;
};

struct Summary {
  std::int64_t runs = 0;
  std::map<std::string, std::int64_t> verdicts;
  score::Rate failing, broken;
  std::vector<FigureSummary> figures;
  std::vector<RateSummary> rates;
  double wall_s = 0.0, cpu_s = 0.0, peak_MB = 0.0;  // summed over the runs; the largest
};

Summary Summarise(const Campaign& campaign, const std::vector<Row>& rows, const std::vector<Cost>& costs);

/// Runs that did not pass, the worst first: broken, failing, inconclusive; of these what never came to a number,
/// then what takes most of its limit, then the lower number; at most `most`.
std::vector<std::int64_t> WorstRuns(const std::vector<Row>& rows, std::size_t most);

/// The run that takes up most of a limit; null where no run has a limit to take up.
const Row* ClosestToItsLimit(const std::vector<Row>& rows);

}  // namespace dynoproof::campaign
