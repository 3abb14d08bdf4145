#include "diagnosis/drift.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "diagnosis/contest.h"
#include "diagnosis/parts.h"
#include "diagnosis/policy.h"
#include "diagnosis/taken_off.h"
#include "linear/dense.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Channel;
using estimation::Estimate;

constexpr std::array<double, 3> kWarms = {0.1, 0.3, 1.0};  // time constants, of the record
constexpr auto kTerms = static_cast<Index>(kWarms.size());

double Term(Index k, double time_s, double length_s) {
  return -std::expm1(-time_s / (kWarms[static_cast<std::size_t>(k)] * length_s));
}

/// How each term of a drift of one unit in each channel moves the innovations of a plan [rows x 3 channels]: by itself, and by what it makes
/// of the samples that correct the run. A free run that a record leads in is corrected where drifts have only begun.
std::optional<MatrixXd> ColumnsOf(const Plan& plan, const Levels& levels, std::size_t level) {
  const estimation::DataSet& data = levels.data();
  const auto channels = std::ssize(data.channels());
  MatrixXd columns = MatrixXd::Zero(data.measured().size(), kTerms * channels);
  for (Index c = 0; c < channels; ++c) {
    const Channel& channel = data.channels()[static_cast<std::size_t>(c)];
    const double length_s = data.records()[channel.record].end_s;
    for (Index i = channel.begin; i < channel.begin + channel.count; ++i) {
      for (Index k = 0; k < kTerms; ++k)
        columns(i, kTerms * c + k) = Term(k, data.time_s()[static_cast<std::size_t>(i)], length_s);
    }
  }
  if (levels[level].free_run()) return columns;
  const Result<VectorXd> as_is = levels[level].Innovations(plan);
  if (!as_is.ok()) return std::nullopt;
  std::vector<char> ran(static_cast<std::size_t>(columns.cols()));
  ParallelFor(ran.size(), 0, [&](std::size_t column) {
    const auto k = static_cast<Index>(column) % kTerms;
    const Channel& channel = data.channels()[column / kWarms.size()];
    Drift off;
    off.length_s = data.records()[channel.record].end_s;
    off.heights = Eigen::Vector3d::Zero();
    off.heights[k] = -channel.noise;
    const auto drifting = [&](MappedRecord& record, std::size_t r) {
      if (r == channel.record) TakeOff(off, record.outputs.at(channel.name));
    };
    const Result<VectorXd> moved = levels[level].CorrectedByOthers(plan, drifting);
    ran[column] = moved.ok();
    if (moved.ok()) columns.col(static_cast<Index>(column)) += (*moved - *as_is) / channel.noise;
  });
  if (!std::ranges::all_of(ran, [](char one) { return one != 0; })) return std::nullopt;
  return columns;
}

/// Weighs each column as a fit weighs its rows.
void WeighColumns(const Estimate& fit, const estimation::DataSet& data, MatrixXd& columns) {
  for (Index k = 0; k < columns.cols(); ++k) {
    VectorXd column = columns.col(k);
    WeighAs(fit, data, column);
    columns.col(k) = column;
  }
}

/// Drifts with these heights [3 channels].
std::vector<Drift> Named(const VectorXd& heights, const MatrixXd& covariance, const estimation::DataSet& data) {
  std::vector<Drift> drifts;
  for (Index c = 0; c < std::ssize(data.channels()); ++c) {
    const Channel& channel = data.channels()[static_cast<std::size_t>(c)];
    Drift drift{channel.record, channel.name, channel.unit, data.records()[channel.record].end_s,
                heights.segment<3>(kTerms * c)};
    double sum = 0.0;
    for (Index i = channel.begin; i < channel.begin + channel.count; ++i)
      sum += std::pow(drift.At(data.time_s()[static_cast<std::size_t>(i)]), 2);
    drift.of_noise = std::sqrt(sum / static_cast<double>(std::max<Index>(1, channel.count))) / channel.noise;
    drift.deviations =
        drift.heights.dot(dense::PseudoInverse(covariance.block<3, 3>(kTerms * c, kTerms * c)) * drift.heights);
    drifts.push_back(std::move(drift));
  }
  return drifts;
}

/// Drifts beside one model by one step, in which its numbers follow [3 channels].
struct Step {
  VectorXd heights;
  MatrixXd covariance;  // numbers that might do the same make it large
};
std::optional<Step> StepOf(const Contestant& one, const Levels& levels, std::size_t level) {
  const Estimate& fit = one.levels[level];
  if (!fit.ok() || fit.weighted.size() == 0 || fit.jacobian.cols() != fit.q.size()) return std::nullopt;
  const std::optional<MatrixXd> columns = ColumnsOf(one.hypothesis.At(fit.q), levels, level);
  if (!columns) return std::nullopt;
  MatrixXd weighted = *columns;
  WeighColumns(fit, levels.data(), weighted);
  const Index numbers = fit.q.size(), count = weighted.cols();
  MatrixXd curvature = MatrixXd::Zero(numbers + count, numbers + count);
  VectorXd slope(numbers + count);
  curvature.topLeftCorner(numbers, numbers) = estimation::HessianOf(fit.jacobian, one.hypothesis);
  curvature.topRightCorner(numbers, count) = -fit.jacobian.transpose() * weighted;
  curvature.bottomLeftCorner(count, numbers) = curvature.topRightCorner(numbers, count).transpose();
  curvature.bottomRightCorner(count, count) = weighted.transpose() * weighted;
  slope << fit.jacobian.transpose() * fit.weighted, -weighted.transpose() * fit.weighted;
  for (Index i = 0; i < numbers; ++i) {
    if (one.hypothesis.parameters()[static_cast<std::size_t>(i)].prior) slope[i] += fit.q[i];
  }
  const VectorXd step = -dense::LeastSquares(curvature, slope);
  const VectorXd noise = NoiseAloneOf(fit);
  const MatrixXd own = weighted.transpose() * weighted;
  const MatrixXd covariance = dense::PseudoInverse(curvature).bottomRightCorner(count, count);
  std::optional<Step> best;
  double least = std::numeric_limits<double>::infinity();
  // A run through a gap is nowhere linear for a whole step.
  for (const double share : {1.0, 0.3, 0.0}) {
    const VectorXd q =
        (fit.q + share * step.head(numbers)).cwiseMax(one.hypothesis.lower()).cwiseMin(one.hypothesis.upper());
    Result<VectorXd> there = levels[level].Innovations(one.hypothesis.At(q));
    if (!there.ok()) continue;
    VectorXd rows = *there;
    WeighAs(fit, levels.data(), rows);
    const VectorXd heights = dense::LeastSquares(own, weighted.transpose() * rows);
    const double left =
        LogExcess(estimation::ScalesOf(levels.data(), *there - *columns * heights, noise), levels.data());
    if (left < least) best = Step{heights, covariance}, least = left;
  }
  return best;
}

/// The drifts beside one model. Steps alternate with fits of the model's numbers to the records without the drifts. `without`: LogLeft() of the
/// best model without drifts.
std::optional<Drifts> DriftsOf(Contestant one, const Plan& plan, const Levels& levels, std::size_t level,
                               const Registry& registry, double without) {
  constexpr int kRounds = 5;
  constexpr double kWorth = 0.95;  // of what is left
  std::optional<Drifts> best;
  VectorXd heights = VectorXd::Zero(kTerms * std::ssize(levels.data().channels()));
  std::unique_ptr<Levels> cleaned;
  std::optional<Step> ahead;  // the next one, where it is known already
  std::int64_t simulations = 0;
  for (int round = 0; round < kRounds; ++round) {
    // Far from the truth a free run has minima of its own: the first step is taken where a record corrects the run. How far a speed is off
    // is hardly seen there.
    const std::size_t at = round == 0 && one.Holds(levels.corrected()) ? levels.corrected() : level;
    const std::optional<Step> step = ahead ? std::exchange(ahead, {}) : StepOf(one, cleaned ? *cleaned : levels, at);
    if (!step) break;
    heights += step->heights;
    std::vector<Drift> drifts = Named(heights, step->covariance, levels.data());
    std::vector<MappedRecord> records = levels.data().records();
    TakeOff(drifts, records);
    Result<std::unique_ptr<Levels>> next = Levels::Of(plan, records, registry, 0.0, kComparedRows, &levels);
    if (!next.ok()) break;
    cleaned = *std::move(next);
    VectorXd from = one.hypothesis.start();
    const auto own = static_cast<Index>(one.hypothesis.of_effects());
    from.head(own) = one.levels[at].q.head(own);
    FitAlong(one, *cleaned, from);
    simulations += cleaned->simulations();
    const Estimate& fit = one.levels[level];
    if (!fit.ok()) break;
    if (at != level) continue;
    const double left = std::exp(LogLeft(fit, *cleaned) - without);
    const bool settled = best && left > kWorth * best->leaves;
    if (!best || left < best->leaves) {
      // How well the drifts are known is told by what is left beside them, not by what was left before they were taken off.
      ahead = StepOf(one, *cleaned, level);
      if (ahead) drifts = Named(heights, ahead->covariance, levels.data());
      best = {one.Name(), one.hypothesis, fit.q, left, IsExact(fit), false, std::move(drifts), 0};
    }
    if (settled || best->exact) break;
  }
  if (best) best->simulations = simulations;
  return best;
}

}  // namespace

double Drift::At(double time_s) const {
  double sum = 0.0;
  for (Index k = 0; k < kTerms; ++k) sum += heights[k] * Term(k, time_s, length_s);
  return sum;
}

bool Drifts::Found() const {
  const auto shows = [](const Drift& one) {
    return one.of_noise > policy::kDriftShows && one.deviations > static_cast<double>(kTerms) * policy::kByChance;
  };
  return leaves <= policy::kDriftsLeave && std::ranges::count_if(of_sensors, shows) > 1;
}

bool Drifts::Plainly() const { return Found() && of_output; }

bool Drifts::Suffice() const { return Found() && (exact || leaves <= policy::kDriftsAlone); }

std::optional<Drifts> FindDrifts(const Plan& plan, std::span<const Contestant> contestants, const Levels& levels,
                                 std::size_t level, const Registry& registry) {
  const Contestant *leader = LeaderAt(contestants, levels, level), *machine = nullptr;
  const auto is_at_output = [](const Contestant& one) {
    return !one.hypothesis.effects().empty() && one.place().kind == "output";
  };
  for (const Contestant& one : contestants.subspan(1)) {
    if (!one.Holds(level) || is_at_output(one)) continue;
    if (machine == nullptr || LogLeft(one.levels[level], levels) < LogLeft(machine->levels[level], levels))
      machine = &one;
  }
  std::optional<Drifts> best;
  std::int64_t simulations = 0;
  // An offset or a gain of one sensor is hardly told from its drift. The best model counts only where it is at a sensor and drifts beside it
  // leave far less than beside the machine, as they do beside a sensor that is late.
  const Contestant* late = is_at_output(*leader) ? leader : nullptr;
  for (const Contestant* one : {&contestants.front(), machine, late}) {
    if (one == nullptr || !one->Holds(level) || (best && best->exact)) continue;
    std::optional<Drifts> own = DriftsOf(*one, plan, levels, level, registry, LogLeft(leader->levels[level], levels));
    if (!own) continue;
    own->of_output = is_at_output(*leader);
    simulations += own->simulations;
    if (!best || own->leaves < (one == late ? policy::kDriftsLeave : 1.0) * best->leaves) best = std::move(own);
  }
  if (best) best->simulations = simulations;
  return best;
}

std::vector<Drift> DriftsBeside(const Plan& plan, const Levels& levels, std::size_t level) {
  const Result<VectorXd> left = levels[level].Innovations(plan);
  const std::optional<MatrixXd> columns = ColumnsOf(plan, levels, level);
  if (!left.ok() || !columns) return {};
  const MatrixXd curvature = columns->transpose() * *columns;
  return Named(dense::LeastSquares(curvature, columns->transpose() * *left), dense::PseudoInverse(curvature),
               levels.data());
}

std::string ToText(const std::vector<Drift>& drifts) {
  std::string text;
  for (const Drift& one : drifts)
    text += fmt::format("{}{:.2g} {} of {}", text.empty() ? "" : ", ", one.At(one.length_s), one.unit, one.signal);
  return text;
}

}  // namespace dynoproof::diagnosis
