#include "estimation/horizon.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "estimation/predictor.h"
#include "experiment/prepare.h"
#include "score/series.h"

namespace dynoproof::estimation {
namespace {

constexpr double kMostPeriods = 2e4;                // of a record are looked at: 2 s of a drive line
constexpr double kFirst = 10.0;                     // samples
constexpr double kLonger = 3.1622776601683795;      // sqrt(10): two memories a decade
constexpr double kMostOfRecord = 0.2;               // memories in a record: of fewer than five little is seen
constexpr double kLeadIn = 5.0, kMostLeadIn = 0.3;  // memories, share of the record: after which a start does not count
constexpr double kReached = 0.7;  // a plant that forgets by itself within less is in its free run already
constexpr double kAtNoise = 1.2;  // times what noise alone causes: its size is known to some hundredths
constexpr double kMoves = 1e-12;  // of the usual magnitude

Result<std::optional<Horizon>> Look(Plan plan, MappedRecord record, const Registry& registry, bool shortest_only) {
  StartFromRecord(record, registry, plan);
  const double period_s = plan.root.NumberOr("run.period_s", RunSettings().period_s);
  std::erase_if(record.outputs, [&](const auto& output) {
    const double nominal = plan.root.NumberOr("output." + output.first + ".nominal", 1.0);
    return !(score::StandardDeviation(*output.second.values) > kMoves * nominal);
  });
  if (record.outputs.empty()) return std::optional<Horizon>();
  double step_s = record.end_s;
  for (const auto& [name, series] : record.outputs) step_s = std::min(step_s, score::MedianStep(*series.time));
  const double end_s = std::min(record.end_s, kMostPeriods * period_s);
  if (!(step_s > 0.0) || end_s < kFirst / kMostOfRecord * step_s) return std::optional<Horizon>();
  const DataSet whole({record}, plan, {.most_s = end_s});
  const Result<LinearModel> model = LinearModel::Of(plan, whole.records().front(), registry);
  if (!model.ok()) return model.failure();
  const auto known = std::make_shared<mechanics::Decompositions>();
  Horizon horizon;
  horizon.in_motion = record.in_motion;
  horizon.seen_s = end_s, horizon.record_s = record.end_s;
  for (const Channel& channel : whole.channels()) horizon.noise[channel.name] = channel.OfSpread(channel.noise);
  const auto look = [&](const Predictor& predictor) -> Result<HorizonLevel> {
    const Result<Prediction> there = predictor.Predict(plan);
    if (!there.ok()) return there.failure();
    HorizonLevel level;
    level.at_noise = true;
    Eigen::Index c = 0;
    for (const Channel& channel : predictor.data().channels()) {
      const double rms = std::sqrt(there->innovations.segment(channel.begin, channel.count).squaredNorm() /
                                   static_cast<double>(channel.count));
      level.nrmse[channel.name] = channel.OfSpread(rms);
      level.by_noise[channel.name] = channel.OfSpread(there->noise_alone[c]);
      level.at_noise = level.at_noise && rms <= kAtNoise * there->noise_alone[c];
      ++c;
    }
    return level;
  };
  bool within = true;
  for (double memory_s = kFirst * step_s; memory_s <= kMostOfRecord * end_s; memory_s *= kLonger) {
    const double lead_in_s = record.in_motion ? std::min(kLeadIn * memory_s, kMostLeadIn * end_s) : 0.0;
    const DataSet data({record}, plan, {.from_s = lead_in_s, .most_s = end_s});
    Predictor predictor(data, *model, registry, memory_s, known);
    if (!predictor.observer() || predictor.observer()->memory_s() < kReached * memory_s) break;
    if (predictor.observer()->memory_s() > memory_s / kReached) continue;  // no forces make it as short
    predictor.LearnNoise(plan);
    Result<HorizonLevel> level = look(predictor);
    if (!level.ok()) continue;  // a run may diverge beside its record with one memory, and hold with the next
    level->memory_s = predictor.observer()->memory_s();
    level->share = predictor.observer()->share();
    within = within && level->at_noise;
    if (within) horizon.horizon_s = *level->memory_s;
    horizon.levels.push_back(*std::move(level));
    if (shortest_only) return std::optional(std::move(horizon));
  }
  Result<HorizonLevel> free = look(Predictor(whole, *model, registry, std::nullopt, known));
  if (!free.ok()) return free.failure();
  if (free->at_noise) horizon.horizon_s = end_s;
  horizon.levels.push_back(*std::move(free));
  return std::optional(std::move(horizon));
}

}  // namespace

double HorizonLevel::GeometricMean() const {
  constexpr double kRoundOff = 1e-12;
  double logarithms = 0.0;
  for (const auto& [output, own] : nrmse) logarithms += std::log(std::max(own, kRoundOff));
  return std::exp(logarithms / static_cast<double>(std::max<std::size_t>(1, nrmse.size())));
}

Result<std::optional<Horizon>> HorizonOf(Plan plan, MappedRecord record, const Registry& registry) {
  return Look(std::move(plan), std::move(record), registry, false);
}

Result<std::optional<HorizonLevel>> ShortestLevelOf(Plan plan, MappedRecord record, const Registry& registry) {
  Result<std::optional<Horizon>> horizon = Look(std::move(plan), std::move(record), registry, true);
  if (!horizon.ok()) return horizon.failure();
  return *horizon ? std::optional((*horizon)->levels.front()) : std::nullopt;
}

std::string Horizon::ToText() const {
  std::string text = fmt::format("\n  {:<24}", "NRMSE with a memory of");
  for (const auto& [name, floor] : noise) text += fmt::format("{:>24}", name);
  text += "\n";
  for (const HorizonLevel& level : levels) {
    text += fmt::format("  {:<24}", level.memory_s ? fmt::format("{:.3g} s", *level.memory_s) : "all (free run)");
    for (const auto& [name, floor] : noise)
      text += fmt::format("{:>24}", fmt::format("{:.3g} ({:.3g})", level.nrmse.at(name), level.by_noise.at(name)));
    text += level.at_noise ? "  noise\n" : "\n";
  }
  text +=
      "  The run beside the record forgets its own errors after so long, because the record corrects it;\n"
      "  in brackets: what the record's noise alone causes.";
  const bool whole = seen_s >= record_s;
  if (!whole) text += fmt::format("\n  All this is of the first {:.4g} s of {:.4g}.", seen_s, record_s);
  if (levels.back().at_noise)
    return text +
           fmt::format("\n  The model predicts {} to its noise.\n", whole ? "the whole record" : "all of that part");
  if (horizon_s > 0.0)
    return text +
           fmt::format("\n  The model predicts {:.3g} s ahead to the noise: what it lacks is small, or adds up{}.\n",
                       horizon_s, in_motion ? ", or the record starts otherwise" : "");
  if (levels.size() == 1)
    return text + (in_motion ? "\n  The model's free run is off, or starts otherwise than the record.\n"
                             : "\n  The model's free run is off.\n");
  return text +
         fmt::format("\n  The model is off within {:.3g} s: a number or a force of it is wrong, or one is missing.\n",
                     *levels.front().memory_s);
}

void AddTo(nlohmann::json& document, const Horizon& horizon) {
  document["horizon_s"] = horizon.horizon_s;
  document["seen_s"] = horizon.seen_s;
  document["noise"] = horizon.noise;
  document["levels"] = nlohmann::json::array();
  for (const HorizonLevel& level : horizon.levels)
    document["levels"].push_back({{"memory_s", level.memory_s ? nlohmann::json(*level.memory_s) : nlohmann::json()},
                                  {"unknown_forces", level.share},
                                  {"nrmse", level.nrmse},
                                  {"nrmse_by_noise", level.by_noise},
                                  {"at_noise", level.at_noise}});
}

}  // namespace dynoproof::estimation
