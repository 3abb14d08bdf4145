#include "diagnosis/prospects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>

#include "base/parallel.h"
#include "base/text.h"
#include "diagnosis/contest.h"
#include "diagnosis/detection.h"
#include "diagnosis/parts.h"
#include "diagnosis/policy.h"
#include "diagnosis/sketch.h"
#include "identification/estimation_problem.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::Estimate;
using estimation::Hypothesis;

/// A candidate with the column by which it is told from others.
struct Column {
  Prospect prospect;
  VectorXd change, rest;  // of its signature, over the root of rest'change
};

/// Fits the null where it leaves more than noise, the most corrected level first; the level at which it does. The free run
/// where it does nowhere.
std::size_t FitWhereSeen(const Levels& levels, Contestant& null) {
  null.levels.assign(levels.size(), {});
  for (Estimate& estimate : null.levels) estimate.broken = "not fitted";
  VectorXd from = null.hypothesis.start();
  std::optional<std::size_t> last;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    null.levels[level] = estimation::Fit(null.hypothesis, levels[level], from, {.renewals = 6, .near = true});
    if (!null.Holds(level)) continue;
    last = level;
    from = null.levels[level].q;
    if (HasExcess(null.levels[level], levels.data())) break;
  }
  return last.value_or(levels.size());
}

/// How many deviations of noise a signature is: what the null gets wrong has taken part in its weights.
double OverNoise(const Signature& signature, const Estimate& null, const estimation::DataSet& data) {
  double sum = 0.0;
  const bool excess = HasExcess(null, data);
  for (std::size_t c = 0; c < data.channels().size(); ++c) {
    const estimation::Channel& channel = data.channels()[c];
    const estimation::ChannelScale& scale = null.scales[c];
    const double unit = scale.rms / scale.noise_alone * (excess ? std::sqrt(scale.correlation) : 1.0);
    sum += std::pow(unit, 2) * signature.rest.segment(channel.begin, channel.count)
                                   .dot(signature.change.segment(channel.begin, channel.count));
  }
  return std::sqrt(std::max(sum, 0.0));
}

/// A candidate at the size that its own run asks for, and so on, for few effects are linear over decades; and what it removes
/// there, with nominal values that follow. What promises little stays at the size of its sketch.
struct Sized {
  VectorXd q;
  Signature signature;
  double removes = 0.0;
};
Sized SizedBy(const Trial& trial, const Screen& screen, const Sketch& sketch) {
  constexpr int kMostRuns = 4;
  constexpr double kPromises = 0.1, kSame = 1.1;
  const auto at = [&](VectorXd q) {
    Signature signature = screen.Of(trial, q);
    const double removes = screen.Removed(trial, q, signature);
    return Sized{std::move(q), std::move(signature), removes};
  };
  Sized best = at(sketch.q);
  for (int run = 0; run < kMostRuns && sketch.removes > kPromises; ++run) {
    const double size = best.signature.size;
    if (!(size > 0.0) || std::abs(std::log(size)) < std::log(kSame)) break;
    VectorXd q = best.q;
    for (const std::size_t i : trial.strengths) q[trial.own() + static_cast<Index>(i)] *= size;
    Sized next = at(q.cwiseMax(trial.hypothesis.lower()).cwiseMin(trial.hypothesis.upper()));
    if (!(next.removes > best.removes)) break;
    best = std::move(next);
  }
  return best;
}

std::optional<Column> ColumnOf(const Trial& trial, const Sized& sized, const Contestant& null, const Estimate& estimate,
                               const estimation::DataSet& data) {
  const Signature& signature = sized.signature;
  if (signature.removes < 0.0) return std::nullopt;
  Column column;
  Prospect& told = column.prospect;
  told.name = trial.effect->info().name;
  told.at = trial.place.ToString();
  told.removes = sized.removes;
  if (const auto& parameters = trial.effect->info().parameters; !parameters.empty()) {
    const std::size_t own = trial.strengths.empty() ? 0 : trial.strengths.front();
    const estimation::Parameter& parameter = trial.hypothesis.parameters()[static_cast<std::size_t>(trial.own()) + own];
    told.parameter = parameters[own].name;
    told.unit = parameter.unit;
    told.strength = parameter.ValueAt(sized.q[trial.own() + static_cast<Index>(own)]);
    if (const double neutral = parameters[own].neutral; !trial.strengths.empty())
      told.smallest =
          std::max(std::abs(told.strength - neutral) * kSeenDeviations / OverNoise(signature, estimate, data),
                   WithinItsPrior(trial, null.hypothesis));
  }
  const double length = std::sqrt(signature.rest.dot(signature.change));
  column.change = signature.change / length;
  column.rest = signature.rest / length;
  return column;
}

/// Each candidate is told with those whose columns say the same.
void CompareColumns(std::vector<Column>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (std::abs(columns[i].rest.dot(columns[k].change)) < policy::kAlike) continue;
      columns[i].prospect.alike.push_back(columns[k].prospect.name + "@" + columns[k].prospect.at);
      columns[k].prospect.alike.push_back(columns[i].prospect.name + "@" + columns[i].prospect.at);
    }
  }
}

/// Share of the null's squares that two columns remove together.
double TogetherOf(const Column& a, const Column& b, const VectorXd& left) {
  const double cosine = a.rest.dot(b.change), x = a.rest.dot(left), y = b.rest.dot(left);
  const double apart = 1.0 - cosine * cosine;
  return (x * x - 2.0 * cosine * x * y + y * y) / (apart * left.squaredNorm());
}

/// The pairs that remove most, where they remove clearly more than any candidate alone. `columns`: the best first.
std::vector<ProspectPair> PairsOf(const std::vector<Column>& columns, const VectorXd& left) {
  constexpr double kClearly = 0.1;
  constexpr std::size_t kTold = 3;
  std::vector<ProspectPair> pairs;
  if (columns.empty()) return pairs;
  const auto name = [](const Column& one) { return one.prospect.name + "@" + one.prospect.at; };
  const auto alone = [&left](const Column& one) { return std::pow(one.rest.dot(left), 2) / left.squaredNorm(); };
  const double best = std::transform_reduce(
      columns.begin(), columns.end(), 0.0, [](double a, double b) { return std::max(a, b); }, alone);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (std::abs(columns[i].rest.dot(columns[k].change)) >= policy::kAlike) continue;
      const double together = TogetherOf(columns[k], columns[i], left);
      if (together > best + kClearly * (1.0 - best)) pairs.push_back({name(columns[k]), name(columns[i]), together});
    }
  }
  std::ranges::stable_sort(pairs, [](const auto& a, const auto& b) { return a.removes > b.removes; });
  pairs.resize(std::min(pairs.size(), kTold));
  return pairs;
}

}  // namespace

Result<Prospects> ProspectsOf(const Plan& plan, const std::vector<MappedRecord>& records, const Registry& registry) {
  const EstimationProblem problem(plan, records, registry);
  const Result<std::unique_ptr<Levels>> made =
      Levels::Of(plan, records, registry, 0.0, kComparedRows, nullptr, SearchedUntil(plan, records));
  if (!made.ok()) return made.failure();
  const Levels& levels = **made;
  Contestant null(NullHypothesis(plan, false, levels, registry));
  const std::size_t level = FitWhereSeen(levels, null);
  if (level == levels.size())
    return Failure{"the model breaks beside the record: " + null.levels.back().broken, plan.id};
  const Screens screens(null, levels, level);
  const std::vector<Trial> trials = TrialsOf(null.hypothesis, levels, MagnitudesOf(problem), registry);
  std::vector<std::optional<Column>> each(trials.size());
  std::vector<Sketch> sketches(trials.size());
  ParallelFor(trials.size(), 0, [&](std::size_t i) {
    sketches[i] = SketchOf(trials[i], screens, StartFrom(trials[i].hypothesis, null.hypothesis, null.levels[level].q));
    if (sketches[i].removes >= 0.0)
      each[i] =
          ColumnOf(trials[i], SizedBy(trials[i], screens.here, sketches[i]), null, null.levels[level], levels.data());
  });
  Prospects prospects;
  prospects.level = levels.Name(level);
  prospects.excess = HasExcess(null.levels[level], levels.data());
  std::vector<Column> columns;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (sketches[i].IsSilent())
      prospects.silent.push_back(Silence(trials[i]));
    else if (each[i])
      columns.push_back(*std::move(each[i]));
  }
  if (prospects.excess)
    std::ranges::stable_sort(columns,
                             [](const Column& a, const Column& b) { return a.prospect.removes > b.prospect.removes; });
  CompareColumns(columns);
  if (prospects.excess) prospects.pairs = PairsOf(columns, null.levels[level].weighted);
  for (Column& one : columns) prospects.all.push_back(std::move(one.prospect));
  prospects.simulations = levels.simulations();
  return prospects;
}

std::string Prospects::ToTable() const {
  constexpr std::size_t kTold = 15, kNamed = 2;
  const auto size = [](const Prospect& one, double value, int digits) {
    if (!std::isfinite(value)) return std::string("-");
    return one.unit == "1" ? fmt::format("{:.{}g} %", 100.0 * value, digits)
                           : fmt::format("{:.{}g} {}", value, digits, one.unit);
  };
  std::string text = excess
                         ? fmt::format("  {} at {}: which share of what the model gets wrong each would remove\n",
                                       Counted(all.size(), "candidate"), level)
                         : fmt::format("  {} at {}: from which size each would show; now there is nothing but noise\n",
                                       Counted(all.size(), "candidate"), level);
  text += fmt::format("  {:<46}", "effect@place");
  if (excess) text += fmt::format("{:>8}  {:<22}", "removes", "as");
  text += fmt::format("{:<22}{}\n", "would show from", "not told from");
  const std::size_t told = excess ? std::min(kTold, all.size()) : all.size();
  for (const Prospect& one : std::span(all).first(told)) {
    text += fmt::format("  {:<46}", one.name + "@" + one.at);
    if (excess)
      text += fmt::format("{:>6.1f} %  {:<22}", 100.0 * one.removes,
                          one.parameter.empty() ? "" : one.parameter + " " + size(one, one.strength, 3));
    std::string like =
        fmt::format("{}", fmt::join(std::span(one.alike).first(std::min(kNamed, one.alike.size())), ", "));
    if (one.alike.size() > kNamed) like += fmt::format(" and {} more", one.alike.size() - kNamed);
    text +=
        like.empty() ? size(one, one.smallest, 2) + "\n" : fmt::format("{:<22}{}\n", size(one, one.smallest, 2), like);
  }
  if (all.size() > told)
    text += fmt::format("  the other {} remove {:.1f} % or less each; --json lists them\n", all.size() - told,
                        100.0 * all[told].removes);
  for (const ProspectPair& one : pairs)
    text += fmt::format("  {} with {} {:.1f} %\n", one.first, one.second, 100.0 * one.removes);
  if (!silent.empty()) {
    std::vector<std::string> names;
    for (const NotTestable& one : silent) names.push_back(one.name + "@" + one.at);
    text += fmt::format("  at this level no output moves by a tenth of the noise at any size that was tried: {}\n",
                        fmt::join(names, ", "));
  }
  if (excess) text += "  A candidate that removes much need not be the cause: `dynoproof diagnose` finds which is.\n";
  return text;
}

void AddTo(nlohmann::json& document, const Prospects& prospects) {
  document["candidates_level"] = prospects.level;
  document["candidates"] = nlohmann::json::array();
  for (const Prospect& one : prospects.all)
    document["candidates"].push_back(
        {{"name", one.name},
         {"at", one.at},
         {"removes", one.removes},
         {"parameter", one.parameter},
         {"unit", one.unit},
         {"strength", one.strength},
         {"smallest", std::isfinite(one.smallest) ? nlohmann::json(one.smallest) : nlohmann::json()},
         {"alike", one.alike}});
  document["pairs"] = nlohmann::json::array();
  for (const ProspectPair& one : prospects.pairs)
    document["pairs"].push_back({{"first", one.first}, {"second", one.second}, {"removes", one.removes}});
  document["not_testable"] = nlohmann::json::array();
  for (const NotTestable& one : prospects.silent)
    document["not_testable"].push_back({{"name", one.name}, {"at", one.at}, {"reason", one.reason}});
}

}  // namespace dynoproof::diagnosis
