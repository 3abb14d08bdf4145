#include "identification/corrected_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/random.h"
#include "estimation/estimator.h"
#include "experiment/drive_by_record.h"
#include "identification/told_apart.h"
#include "linear/dense.h"

namespace dynoproof::identification {
namespace {

using estimation::DataSet;
using estimation::LinearModel;
using estimation::Parameter;
using estimation::Predictor;

constexpr double kLonger = 5.0;  // from level to level; the first is as much shorter than a search's usual memory
constexpr Eigen::Index kMostRows = 12'000;

/// Searched by its logarithm between bounds of one sign, else linearly.
Parameter ParameterOf(const FreeKey& key, double nominal) {
  Parameter parameter;
  parameter.name = key.key;
  parameter.lower = std::min(nominal / kWithoutBounds, nominal * kWithoutBounds);
  parameter.upper = std::max(nominal / kWithoutBounds, nominal * kWithoutBounds);
  if (key.bounds) parameter.lower = key.bounds->first, parameter.upper = key.bounds->second;
  const double within = std::clamp(nominal, parameter.lower, parameter.upper);
  parameter.logarithmic = parameter.lower * parameter.upper > 0.0;
  parameter.reference = parameter.logarithmic ? within : 0.0;
  const double largest = std::max(std::abs(parameter.lower), std::abs(parameter.upper));
  parameter.scale = parameter.logarithmic ? 1.0 : std::max(std::abs(within), 0.01 * largest);
  return parameter;
}

/// NRMSE over all outputs.
double NrmseOf(const DataSet& data, const Eigen::VectorXd& innovations) {
  double sum = 0.0, rows = 0.0;
  for (const estimation::Channel& channel : data.channels()) {
    sum += std::pow(channel.OfSpread(innovations.segment(channel.begin, channel.count).norm()), 2);
    rows += static_cast<double>(channel.count);
  }
  return std::sqrt(sum / std::max(rows, 1.0));
}

/// Whether nothing is left but what measurement noise causes.
bool AtNoise(const estimation::Estimate& fit) {
  constexpr double kMost = 1.2;
  return std::ranges::all_of(
      fit.scales, [](const estimation::ChannelScale& scale) { return scale.rms <= kMost * scale.noise_alone; });
}

/// The first `count` columns without what the others can stand for.
Eigen::MatrixXd Beside(const Eigen::MatrixXd& jacobian, Eigen::Index count) {
  Eigen::MatrixXd own = jacobian.leftCols(count);
  const Eigen::MatrixXd others = jacobian.rightCols(jacobian.cols() - count);
  if (others.cols() == 0) return own;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd column = own.col(k);
    own.col(k) -= others * dense::LeastSquares(others, column);
  }
  return own;
}

/// Values of `best`. Intervals: of an exact model its own; of another the hull over all levels, for how much a number
/// depends on what is taken for unknown is what the model's error makes of it.
void AddValues(const estimation::Hypothesis& hypothesis, const std::vector<FreeKey>& free,
               const std::vector<estimation::Estimate>& fits, std::size_t best, const DataSet& data,
               Identified& result) {
  constexpr double kTwoSided = 1.959964, kOnBound = 1e-6;
  const estimation::Estimate& fit = fits[best];
  const bool exact = best + 1 == fits.size() && AtNoise(fit);
  const Eigen::VectorXd lower = hypothesis.lower(), upper = hypothesis.upper();
  const auto count = static_cast<Eigen::Index>(free.size());  // the starts of records come behind
  Eigen::VectorXd low = fit.q, high = fit.q, slope(count);
  std::vector<std::string> keys;
  for (const FreeKey& key : free) keys.push_back(key.key);
  const ToldApart told = TellApart(Beside(fit.jacobian, count), 1.0, keys);  // the rows count in deviations
  for (const estimation::Estimate& level : fits) {
    if (!level.ok() || (exact && &level != &fit)) continue;
    const Eigen::VectorXd half =
        kTwoSided * estimation::Sandwich(level, data, hypothesis).diagonal().cwiseMax(0.0).cwiseSqrt();
    low = low.cwiseMin(level.q - half);
    high = high.cwiseMax(level.q + half);
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& parameter = hypothesis.parameters()[static_cast<std::size_t>(i)];
    const double width = upper[i] - lower[i], value = parameter.ValueAt(fit.q[i]);
    slope[i] = parameter.logarithmic ? parameter.scale * value : parameter.scale;
    IdentifiedValue one{parameter.name, 0.0, value, std::nullopt, false};
    one.nominal = hypothesis.nominal().root.FindPath(parameter.name)->number();
    one.on_bound = fit.q[i] < lower[i] + kOnBound * width || fit.q[i] > upper[i] - kOnBound * width;
    const double a = parameter.ValueAt(low[i]), b = parameter.ValueAt(high[i]);
    if (!one.on_bound && told.Tells(one.key) && high[i] - low[i] < width)
      one.interval = {std::min(a, b), std::max(a, b)};
    result.values.push_back(std::move(one));
  }
  result.covariance =
      slope.asDiagonal() * estimation::Sandwich(fit, data, hypothesis).topLeftCorner(count, count) * slope.asDiagonal();
  for (Eigen::Index i = 0; i < count; ++i) {
    if (told.Tells(keys[static_cast<std::size_t>(i)])) continue;
    result.covariance.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    result.covariance.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  result.singular = told.singular;
  result.alike = told.alike;
}

/// How numbers differ from record to record, in the order of the hypothesis' parameters, by the level that is taken.
void AddOfRecords(const estimation::Hypothesis& hypothesis, const estimation::Estimate& fit, const DataSet& data,
                  Identified& result) {
  constexpr double kTwoSided = 1.959964;
  const Eigen::MatrixXd covariance = estimation::Sandwich(fit, data, hypothesis);
  for (std::size_t i = 0; i < hypothesis.parameters().size(); ++i) {
    const Parameter& parameter = hypothesis.parameters()[i];
    for (std::size_t r = 0; r < data.records().size(); ++r) {
      const std::string before = DifferenceOfRecord(r) + ".";
      if (!parameter.name.starts_with(before)) continue;
      const auto k = static_cast<Eigen::Index>(i);
      const double half = kTwoSided * std::sqrt(std::max(0.0, covariance(k, k)));
      result.of_records.push_back({r, data.records()[r].file, parameter.name.substr(before.size()),
                                   parameter.ValueAt(fit.q[k]),
                                   std::pair(parameter.ValueAt(fit.q[k] - half), parameter.ValueAt(fit.q[k] + half))});
    }
  }
}

/// The nominal values; or the best of some random points, anywhere within the bounds that are given, else within a factor.
Eigen::VectorXd StartOf(const estimation::Hypothesis& hypothesis, const std::vector<FreeKey>& keys, int start,
                        const Predictor& predictor) {
  constexpr std::uint64_t kSeed = 11;
  constexpr double kFactor = 2.0;
  constexpr int kTries = 20;
  if (start == 0) return hypothesis.start();
  Eigen::VectorXd best = hypothesis.start();
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kTries; ++k) {
    Eigen::VectorXd q = hypothesis.start();
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const Parameter& parameter = hypothesis.parameters()[i];
      const auto at = static_cast<Eigen::Index>(i);
      double low = hypothesis.lower()[at], high = hypothesis.upper()[at];
      if (!keys[i].bounds && parameter.logarithmic)
        low = std::max(low, q[at] - std::log(kFactor)), high = std::min(high, q[at] + std::log(kFactor));
      q[at] = low + (high - low) * RandomUniform(kSeed, static_cast<std::uint64_t>(start * kTries + k), i);
    }
    const Result<Eigen::VectorXd> innovations = predictor.Innovations(hypothesis.At(q));
    const double left = innovations.ok() ? NrmseOf(predictor.data(), *innovations) : least;
    if (left < least) least = left, best = q;
  }
  return best;
}

/// The level whose numbers are taken: the likeliest of those that make the free run no worse than it was. With a memory of few
/// samples a model that leaves much is soon the likeliest, whatever its numbers: what it leaves is known by the sample before.
std::size_t LevelOf(const estimation::Hypothesis& hypothesis, const std::vector<estimation::Estimate>& fits,
                    std::size_t likeliest, const std::vector<std::unique_ptr<Predictor>>& levels) {
  constexpr double kWorse = 1.01;
  const Predictor& free = *levels.back();
  const auto left = [&](const Plan& plan) {
    const Result<Eigen::VectorXd> rows = free.Innovations(plan);
    return rows.ok() ? NrmseOf(free.data(), *rows) : std::numeric_limits<double>::infinity();
  };
  const double before = left(hypothesis.nominal());
  const auto worse = [&](std::size_t i) { return !(left(hypothesis.At(fits[i].q)) <= kWorse * before); };
  if (!std::isfinite(before) || !worse(likeliest)) return likeliest;
  double end = -std::numeric_limits<double>::infinity();
  std::size_t taken = likeliest;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i].ok() || worse(i)) continue;
    if (const double likelihood = estimation::LogLikelihood(fits[i], *levels[i]); likelihood > end)
      end = likelihood, taken = i;
  }
  return taken;
}

}  // namespace

Status FitCorrected(const EstimationProblem& problem, const IdentifyOptions& options, Identified& result) {
  const Registry& registry = problem.registry();
  std::vector<MappedRecord> data = problem.records();
  const Plan& plan = problem.plan();
  estimation::Hypothesis hypothesis(plan);
  for (const FreeKey& key : options.keys)
    hypothesis = hypothesis.WithFree(ParameterOf(key, plan.root.FindPath(key.key)->number()));
  // Where a record starts is fitted along, in the numbers that its plant declares for that. With none it is led in.
  for (std::size_t r = 0; r < data.size(); ++r) {
    const std::size_t before = hypothesis.parameters().size();
    hypothesis = hypothesis.WithStartFree(r, registry);
    if (hypothesis.parameters().size() > before) data[r].in_motion = false;
  }
  hypothesis = hypothesis.WithDifferencesFree(data.size());
  const DataSet whole(data, plan);
  const Result<LinearModel> model = LinearModel::Of(StartingInto(plan, 0), whole.records().front(), registry);
  if (!model.ok()) return model.failure();
  const double duration_s = whole.records().front().end_s;
  std::vector<double> memories;
  if (model->HasStates()) {
    for (double memory_s = estimation::MemoryFor(*model, duration_s) / kLonger; memory_s < duration_s;
         memory_s *= kLonger)
      memories.push_back(memory_s);
  }
  // A record that begins as the plan does needs no lead-in, and none is better: what noise makes of a state that is found
  // in one stays in the free run behind it.
  const bool in_motion = std::ranges::any_of(whole.records(), &MappedRecord::in_motion);
  const double lead_in_s = in_motion && !memories.empty() ? estimation::LeadInOf(memories.front(), duration_s) : 0.0;
  const DataSet compared(data, plan, {.from_s = lead_in_s, .most_rows = kMostRows});
  const auto known = std::make_shared<mechanics::Decompositions>();
  std::vector<std::unique_ptr<Predictor>> levels;
  const auto add = [&](std::optional<double> memory_s) {
    levels.push_back(in_motion && !levels.empty()
                         ? std::make_unique<Predictor>(*levels.front(), lead_in_s, memory_s)
                         : std::make_unique<Predictor>(compared, *model, registry, memory_s, known));
  };
  for (const double memory_s : memories) add(memory_s);
  add(std::nullopt);
  std::vector<const Predictor*> order;
  for (const auto& level : levels) order.push_back(level.get());
  // From the nominal values, and from others until one ends at the noise.
  std::vector<estimation::Estimate> fits;
  std::size_t best = 0;
  double likeliest = -std::numeric_limits<double>::infinity();
  std::vector<double> ends;
  for (int start = 0; start < options.starts; ++start) {
    std::vector<estimation::Estimate> chain =
        estimation::FitThrough(hypothesis, order, StartOf(hypothesis, options.keys, start, *levels.front()));
    double end = -std::numeric_limits<double>::infinity();
    std::size_t own = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const double likelihood = chain[i].ok() ? estimation::LogLikelihood(chain[i], *levels[i]) : end;
      if (likelihood > end) end = likelihood, own = i;
    }
    // A free run that leaves nothing but noise leaves nothing unknown, however likely a shorter memory is by chance.
    const bool exact = chain.size() == levels.size() && chain.back().ok() && AtNoise(chain.back());
    if (exact) own = chain.size() - 1;
    ends.push_back(end);
    if (end > likeliest) fits = std::move(chain), best = own, likeliest = end;
    options.progress(static_cast<double>(start + 1) / options.starts);
    if (exact) break;
  }
  CorrectedLevel told;
  for (const auto& level : levels) told.simulations += level->simulations();
  if (fits.empty()) return Failure{"no run beside the record holds", plan.id, {}, 4};
  best = LevelOf(hypothesis, fits, best, levels);
  const Result<Eigen::VectorXd> nominal = levels[best]->Innovations(plan);
  if (!levels[best]->free_run()) {
    told.memory_s = levels[best]->observer()->memory_s();
    told.share = levels[best]->observer()->share();
  }
  told.nrmse_before = nominal.ok() ? NrmseOf(compared, *nominal) : std::numeric_limits<double>::infinity();
  told.nrmse_after = NrmseOf(compared, fits[best].innovations);
  told.at_noise = AtNoise(fits[best]);
  result.level = told;
  constexpr double kSame = 1e-3;  // of the likelihood a row
  result.starts = static_cast<int>(ends.size());
  result.converged = static_cast<int>(std::ranges::count_if(ends, [&](double end) { return end > likeliest - kSame; }));
  AddValues(hypothesis, options.keys, fits, best, compared, result);
  AddOfRecords(hypothesis, fits[best], compared, result);
  return {};
}

}  // namespace dynoproof::identification
