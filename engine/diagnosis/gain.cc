#include "diagnosis/gain.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/random.h"
#include "diagnosis/policy.h"

namespace dynoproof::diagnosis {
namespace {

/// Standard deviation of rows of a channel; where these stand still, of the whole channel a share that is no motion.
double SpreadOf(const Eigen::Ref<const Eigen::VectorXd>& rows, const ComparedOutput& channel) {
  return std::max({std::sqrt((rows.array() - rows.mean()).square().mean()), policy::kStill * channel.spread,
                   1e-12 * channel.nominal});
}

/// Blocks of the squares are drawn anew 1000 times: residuals are correlated within a block, hardly across.
void Bootstrap(const Eigen::ArrayXd& before, const Eigen::ArrayXd& after, double spread, SignalGain& gain) {
  const Eigen::Index blocks = std::min<Eigen::Index>(40, before.size() / 5);
  if (blocks < 2) return;
  std::vector<std::pair<double, double>> sums(static_cast<std::size_t>(blocks));
  const Eigen::Index length = before.size() / blocks;
  for (Eigen::Index i = 0; i < blocks; ++i)
    sums[static_cast<std::size_t>(i)] = {before.segment(i * length, length).mean(),
                                         after.segment(i * length, length).mean()};
  std::vector<double> drawn;
  for (std::uint64_t draw = 0; draw < 1000; ++draw) {
    double b = 0.0, a = 0.0;
    for (std::uint64_t i = 0; i < sums.size(); ++i) {
      const auto& one = sums[RandomBits(1, draw, i) % sums.size()];
      b += one.first;
      a += one.second;
    }
    const auto n = static_cast<double>(sums.size());
    drawn.push_back((std::sqrt(b / n) - std::sqrt(a / n)) / spread);
  }
  std::sort(drawn.begin(), drawn.end());
  gain.lower = drawn[25];
  gain.upper = drawn[974];
}

}  // namespace

std::map<std::string, SignalGain> GainsOf(const EstimationProblem& problem, const Eigen::VectorXd& before,
                                          const Eigen::VectorXd& after, double from) {
  std::map<std::string, SignalGain> all;
  for (const ComparedOutput& c : problem.channels()) {
    const auto first = static_cast<Eigen::Index>(from * static_cast<double>(c.count));
    const Eigen::Index count = c.count - first;
    if (count < 10) continue;
    const auto y = problem.measured().segment(c.begin + first, count);
    const double spread = SpreadOf(y, c);
    const Eigen::ArrayXd b = (y - before.segment(c.begin + first, count)).array().square();
    const Eigen::ArrayXd a = (y - after.segment(c.begin + first, count)).array().square();
    SignalGain gain{std::sqrt(b.mean()) / spread, std::sqrt(a.mean()) / spread, 0.0, 0.0};
    Bootstrap(b, a, spread, gain);
    all[c.name] = gain;
  }
  return all;
}

Result<std::map<std::string, SignalGain>> MeasureGains(const EstimationProblem& problem, const Plan& before,
                                                       const Plan& after, double from) {
  const Result<Eigen::VectorXd> b = problem.PredictPlan(before), a = problem.PredictPlan(after);
  if (!b.ok()) return b.failure();
  if (!a.ok()) return a.failure();
  return GainsOf(problem, *b, *a, from);
}

std::optional<Share> ExplainedShare(const EstimationProblem& problem, const Eigen::VectorXd& before,
                                    const Eigen::VectorXd& after, double from) {
  constexpr Eigen::Index kMostBlocks = 40, kLeastRows = 5;
  constexpr std::uint64_t kDraws = 1000;
  const auto first_of = [from](const ComparedOutput& c) {
    return static_cast<Eigen::Index>(from * static_cast<double>(c.count));
  };
  // Blocks of time, in which each signal has rows enough; signals with fewer than two blocks of them are left out.
  Eigen::Index blocks = kMostBlocks;
  for (const ComparedOutput& c : problem.channels()) {
    const Eigen::Index own = (c.count - first_of(c)) / kLeastRows;
    if (own >= 2) blocks = std::min(blocks, own);
  }
  std::vector<std::pair<double, double>> sums(static_cast<std::size_t>(blocks), {0.0, 0.0});  // all signals together
  for (const ComparedOutput& c : problem.channels()) {
    const Eigen::Index first = first_of(c), count = c.count - first, length = count / blocks;
    if (length < kLeastRows) continue;
    const auto y = problem.measured().segment(c.begin + first, count);
    const double variance = std::pow(SpreadOf(y, c), 2);
    for (Eigen::Index b = 0; b < blocks; ++b) {
      const auto squares = [&](const Eigen::VectorXd& predicted) {
        const Eigen::Index at = b * length;
        return (y.segment(at, length) - predicted.segment(c.begin + first + at, length)).squaredNorm() / variance;
      };
      sums[static_cast<std::size_t>(b)].first += squares(before);
      sums[static_cast<std::size_t>(b)].second += squares(after);
    }
  }
  const auto share = [](double b, double a) { return b > 0.0 ? 1.0 - a / b : 0.0; };
  double b = 0.0, a = 0.0;
  for (const auto& [first, second] : sums) b += first, a += second;
  if (!(b > 0.0)) return std::nullopt;
  std::vector<double> drawn;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    double of_b = 0.0, of_a = 0.0;
    for (std::uint64_t i = 0; i < sums.size(); ++i) {
      const auto& one = sums[RandomBits(1, draw, i) % sums.size()];
      of_b += one.first, of_a += one.second;
    }
    drawn.push_back(share(of_b, of_a));
  }
  std::sort(drawn.begin(), drawn.end());
  return Share{share(b, a), drawn[kDraws / 40], drawn[kDraws - 1 - kDraws / 40]};
}

}  // namespace dynoproof::diagnosis
