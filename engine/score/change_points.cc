#include "score/change_points.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/within.h"
#include "score/ranks.h"
#include "score/series.h"

namespace dynoproof::score {
namespace {

struct Split {
  std::size_t at = 0;
  double statistic = 0.0;
};

/// The clearest split of ranks into two levels of at least `least` values: |rank sum - mean| over its deviation.
Split Clearest(std::span<const double> ranks, std::size_t least) {
  const auto n = static_cast<double>(ranks.size());
  Split best;
  double sum = 0.0;
  for (std::size_t k = 1; k + least <= ranks.size(); ++k) {
    sum += ranks[k - 1];
    if (k < least) continue;
    const auto left = static_cast<double>(k);
    const double deviation = std::sqrt(left * (n - left) * (n + 1.0) / 12.0);
    const double statistic = std::abs(sum - 0.5 * left * (n + 1.0)) / deviation;
    if (statistic > best.statistic) best = {k, statistic};
  }
  return best;
}

/// p by permutation, stopped early (Besag, Clifford) once it is clearly no finding.
double PermutationP(std::vector<double> ranks, double statistic, const NoiseOptions& options, std::mt19937_64& random) {
  const int most = static_cast<int>(std::min(1e6, std::ceil(20.0 / options.alpha)));
  constexpr int kEnough = 20;
  int reached = 0;
  for (int i = 1; i <= most; ++i) {
    std::shuffle(ranks.begin(), ranks.end(), random);
    if (Clearest(ranks, options.least).statistic >= statistic - 1e-12) ++reached;
    if (reached == kEnough) return static_cast<double>(reached) / i;
  }
  return (reached + 1.0) / (most + 1.0);
}

void Segment(std::span<const double> values, std::size_t first, const NoiseOptions& options, std::mt19937_64& random,
             std::vector<LevelChange>& changes) {
  if (values.size() < 2 * options.least) return;
  const std::vector<double> ranks = Ranks(values);
  const Split split = Clearest(ranks, options.least);
  if (split.at == 0) return;
  const double before = Median(values.first(split.at)), after = Median(values.subspan(split.at));
  if (std::abs(after - before) < options.relevant * std::abs(before)) return;  // NaN: a change
  const double p = PermutationP(ranks, split.statistic, options, random);
  if (p > options.alpha) return;  // NaN: a change
  Segment(values.first(split.at), first, options, random, changes);
  changes.push_back({first + split.at, before, after, p});
  Segment(values.subspan(split.at), first + split.at, options, random, changes);
}

}  // namespace

std::vector<LevelChange> NoisyChanges(std::span<const double> values, const NoiseOptions& options) {
  std::vector<LevelChange> changes;
  std::mt19937_64 random(options.seed);
  Segment(values, 0, options, random, changes);
  // Levels as the segmentation left them, not as each split first saw them; what has become irrelevant goes.
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const std::size_t from = i == 0 ? 0 : changes[i - 1].at;
    const std::size_t to = i + 1 < changes.size() ? changes[i + 1].at : values.size();
    changes[i].before = Median(values.subspan(from, changes[i].at - from));
    changes[i].after = Median(values.subspan(changes[i].at, to - changes[i].at));
  }
  std::erase_if(changes, [&options](const LevelChange& change) {
    return std::abs(change.after - change.before) < options.relevant * std::abs(change.before);  // NaN: stays
  });
  return changes;
}

bool CanDecide(std::size_t count, const NoiseOptions& options) {
  if (count < 2 * options.least) return false;
  // Of all orders of distinct values, those that part as clearly as the clearest split: two for each choice of its
  // size.
  const double n = static_cast<double>(count), k = static_cast<double>(options.least);
  const double log_choices = std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
  return Within(2.0 * std::exp(-log_choices), options.alpha);
}

std::vector<LevelChange> ExactChanges(std::span<const double> values, double relevant) {
  std::vector<LevelChange> changes;
  std::size_t first = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (Within(std::abs(values[i] - values[first]), relevant)) continue;
    changes.push_back({i, values[first], values[i], 0.0});
    first = i;
  }
  return changes;
}

}  // namespace dynoproof::score
