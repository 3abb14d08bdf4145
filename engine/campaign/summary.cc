// What the rows of a campaign say together.
#include "campaign/summary.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "campaign/table.h"
#include "score/ranks.h"

namespace dynoproof::campaign {
namespace {

using score::Verdict;

/// Between the two nearest ranks.
double Quantile(const std::vector<double>& sorted, double q) {
  const double place = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(below);
  return below + 1 < sorted.size() ? sorted[below] + share * (sorted[below + 1] - sorted[below]) : sorted[below];
}

double Correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double mean = 0.5 * static_cast<double>(a.size() + 1);  // of ranks
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean) * (b[i] - mean);
    aa += (a[i] - mean) * (a[i] - mean);
    bb += (b[i] - mean) * (b[i] - mean);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : std::nan("");
}

FigureSummary SummariseFigure(const Campaign& campaign, const std::vector<Row>& rows, std::size_t figure) {
  FigureSummary summary;
  summary.name = campaign.subject->figures()[figure].name;
  summary.unit = campaign.subject->figures()[figure].unit;
  std::vector<double> values;
  std::vector<std::int64_t> runs;
  for (const Row& row : rows) {
    if (!std::isfinite(row.figures[figure])) continue;
    values.push_back(row.figures[figure]);
    runs.push_back(row.run);
  }
  summary.runs = std::ssize(values);
  if (values.empty()) return summary;
  summary.least_run = runs[static_cast<std::size_t>(std::min_element(values.begin(), values.end()) - values.begin())];
  summary.largest_run = runs[static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin())];
  const std::vector<double> ranks = score::Ranks(values);
  for (std::size_t axis = 0; axis < campaign.axes.size(); ++axis) {
    std::vector<double> numbers;
    for (const std::int64_t run : runs) numbers.push_back(campaign.axes.Number(axis, run));
    summary.rank_correlation.push_back(Correlation(ranks, score::Ranks(numbers)));
  }
  const auto n = static_cast<double>(values.size());
  summary.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - summary.mean) * (value - summary.mean);
  const double half = n > 1.0 ? 1.96 * std::sqrt(squares / (n - 1.0) / n) : INFINITY;
  summary.mean_lower = summary.mean - half;
  summary.mean_upper = summary.mean + half;
  std::sort(values.begin(), values.end());
  summary.least = values.front();
  summary.q05 = Quantile(values, 0.05);
  summary.q25 = Quantile(values, 0.25);
  summary.median = Quantile(values, 0.5);
  summary.q75 = Quantile(values, 0.75);
  summary.q95 = Quantile(values, 0.95);
  summary.largest = values.back();
  // How many of n values lie below the median is binomial: the k-th value is below it unless fewer than k are. Less
  // than six values hold it nowhere with 95 %.
  const boost::math::binomial below(n, 0.5);
  std::size_t k = values.size() / 2;
  while (k > 0 && boost::math::cdf(below, static_cast<double>(k - 1)) > 0.025) --k;
  summary.median_lower = k > 0 ? values[k - 1] : -INFINITY;
  summary.median_upper = k > 0 ? values[values.size() - k] : INFINITY;
  return summary;
}

double Count(const Campaign& campaign, const std::string& what, const Row& row) {
  if (what == "runs") return 1.0;
  if (what == "fail") return row.verdict == Verdict::kFail ? 1.0 : 0.0;
  if (what == "broken") return row.verdict == Verdict::kBroken ? 1.0 : 0.0;
  const std::vector<FigureInfo>& figures = campaign.subject->figures();
  for (std::size_t i = 0; i < figures.size(); ++i) {
    if (figures[i].name == what) return std::isfinite(row.figures[i]) ? row.figures[i] : 0.0;
  }
  return 0.0;
}

void SummariseRate(const Campaign& campaign, const std::vector<Row>& rows, const std::string& name,
                   const RateSpec& spec, std::vector<RateSummary>& rates) {
  std::size_t axis = 0;
  while (axis < campaign.axes.size() && campaign.axes.spec(axis).key != spec.by) ++axis;
  struct Sum {
    std::string label;
    double hits = 0.0, of = 0.0;
  };
  std::map<double, Sum> groups;
  Sum all;
  for (const Row& row : rows) {
    const double hits = Count(campaign, spec.hits, row), of = Count(campaign, spec.of, row);
    all.hits += hits;
    all.of += of;
    if (axis == campaign.axes.size()) continue;
    Sum& group = groups[campaign.axes.Number(axis, row.run)];
    group.label = TextOf(campaign.axes.At(axis, row.run));
    group.hits += hits;
    group.of += of;
  }
  const auto add = [&](const std::string& label, const Sum& sum) {
    rates.push_back({name, label, {std::lround(sum.hits), std::lround(sum.of)}});
  };
  for (const auto& [number, group] : groups) add(group.label, group);
  add("", all);
}

}  // namespace

Summary Summarise(const Campaign& campaign, const std::vector<Row>& rows, const std::vector<Cost>& costs) {
  Summary summary;
  summary.runs = std::ssize(rows);
  for (const Row& row : rows) ++summary.verdicts[std::string(score::ToString(row.verdict))];
  summary.failing.of = summary.broken.of = summary.runs;
  summary.failing.hits = summary.verdicts["fail"];
  summary.broken.hits = summary.verdicts["broken"];
  for (std::size_t i = 0; i < campaign.subject->figures().size(); ++i)
    summary.figures.push_back(SummariseFigure(campaign, rows, i));
  for (const auto& [name, rate] : campaign.rates) SummariseRate(campaign, rows, name, rate, summary.rates);
  for (const Cost& cost : costs) {
    summary.wall_s += cost.wall_s;
    summary.cpu_s += cost.cpu_s;
    summary.peak_MB = std::max(summary.peak_MB, cost.peak_MB);
  }
  return summary;
}

std::vector<std::int64_t> WorstRuns(const std::vector<Row>& rows, std::size_t most) {
  constexpr double kNoNumber = std::numeric_limits<double>::infinity();
  const auto rank = [](const Row& row) {
    const int verdict = row.verdict == Verdict::kBroken ? 0 : row.verdict == Verdict::kFail ? 1 : 2;
    return std::tuple(verdict, std::isfinite(row.used) ? -row.used : -kNoNumber, row.run);
  };
  std::vector<const Row*> worst;
  for (const Row& row : rows) {
    if (row.verdict != Verdict::kPass) worst.push_back(&row);
  }
  std::ranges::sort(worst, {}, [&rank](const Row* row) { return rank(*row); });
  worst.resize(std::min(most, worst.size()));
  std::vector<std::int64_t> runs;
  for (const Row* row : worst) runs.push_back(row->run);
  return runs;
}

const Row* ClosestToItsLimit(const std::vector<Row>& rows) {
  const Row* closest = nullptr;
  for (const Row& row : rows) {
    if (!row.nearest.empty() && (closest == nullptr || row.used > closest->used)) closest = &row;
  }
  return closest;
}

}  // namespace dynoproof::campaign
