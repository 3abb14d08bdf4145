#include "diagnosis/levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/policy.h"
#include "experiment/drive_by_record.h"
#include "experiment/prediction_windows.h"
#include "identification/noise_model.h"

namespace dynoproof::diagnosis {

using Eigen::Index;
using estimation::DataSet;
using estimation::LinearModel;
using estimation::Predictor;

namespace {

constexpr double kLongerAtLeast = 1.05;  // of the memory before: a level of its own

/// Whether what the plan leaves is so much of the record (geometric mean over the channels) that a gap which it crosses at other
/// times may lead anywhere: with a memory of 10 ms a gap a sixth too narrow leaves two fifths, and a hump before the truth; with 2 ms all ways lead down.
bool LosesSight(const Predictor& shortest, const Plan& plan) {
  const Result<Eigen::VectorXd> rows = shortest.Innovations(plan);
  if (!rows.ok()) return false;
  double logarithms = 0.0;
  const auto& channels = shortest.data().channels();
  for (const estimation::Channel& channel : channels) {
    const double rms = identification::RmsOf(rows->segment(channel.begin, channel.count));
    logarithms += std::log(std::max(channel.OfSpread(rms), 1e-12));
  }
  return logarithms > std::log(policy::kOutOfSight) * static_cast<double>(channels.size());
}

}  // namespace

Result<std::unique_ptr<Levels>> Levels::Of(const Plan& plan, const std::vector<MappedRecord>& records,
                                           const Registry& registry, double compared_from, Index most_rows,
                                           const Levels* like, double most_s) {
  std::unique_ptr<Levels> levels(new Levels());
  const DataSet whole(records, plan);
  const Result<LinearModel> model = LinearModel::Of(StartingInto(plan, 0), whole.records().front(), registry);
  if (!model.ok()) return model.failure();
  levels->model_ = *model;
  const double duration_s = std::min(whole.records().front().end_s, most_s);
  const double memory_s = estimation::MemoryFor(*model, duration_s);
  // Records differ in length: what a run is led in by ends with the shortest.
  const double shortest_s = std::ranges::min_element(whole.records(), {}, &MappedRecord::end_s)->end_s;
  double from_s = compared_from * shortest_s;
  const bool in_motion = std::ranges::any_of(whole.records(), &MappedRecord::in_motion);
  if (!(from_s > 0.0) && in_motion) from_s = estimation::LeadInOf(policy::kLonger * memory_s, duration_s);
  levels->data_ = std::make_unique<DataSet>(
      records, plan,
      DataSet::Options{.from_s = from_s,
                       .most_s = most_s,
                       .from_share = compared_from,
                       .most_rows = most_rows,
                       .noise_of = like != nullptr && compared_from > 0.0 ? &like->data() : nullptr});
  const auto known = std::make_shared<mechanics::Decompositions>();
  const std::optional<double> window_s = PredictionWindow(plan);
  if (like != nullptr) {
    levels->memories_s_ = like->memories_s_;
    levels->corrected_ = like->corrected_;
    levels->longest_ = like->longest_;
  } else if (!model->HasStates()) {
    // All levels are the free run.
  } else if (window_s) {
    levels->memories_s_ = {*window_s / policy::kLonger, *window_s};
    const Predictor shorter(*levels->data_, levels->model_, registry, levels->memories_s_.front(), known);
    if (LosesSight(shorter, plan))
      levels->memories_s_.insert(levels->memories_s_.begin(), levels->memories_s_.front() / policy::kLonger);
    levels->corrected_ = levels->longest_ = levels->memories_s_.size() - 1;
  } else {
    // Between a memory and the free run the error has ever more minima: steps are small up to beyond the record's length.
    for (double memory = memory_s; levels->memories_s_.empty() || memory < policy::kLongest * duration_s;
         memory *= policy::kLonger) {
      const std::size_t level = levels->memories_s_.size();
      if (memory < policy::kMostOfRecord * duration_s) levels->longest_ = level;
      levels->corrected_ = std::min<std::size_t>(levels->longest_, 1);
      levels->memories_s_.push_back(memory);
    }
  }
  // A free run that is compared later begins where the shortest memory has come to. A record in motion leads every run in:
  // the shortest memory finds its start, the next one averages what noise has made of that, for it stays in a free run.
  auto& all = levels->predictors_;
  std::vector<std::optional<double>> memories(levels->memories_s_.begin(), levels->memories_s_.end());
  if (!window_s || memories.empty()) memories.push_back(std::nullopt);
  std::vector<double> kept;
  for (const std::optional<double>& memory : memories) {
    const bool led = !all.empty() && (in_motion || (!memory && from_s > 0.0));
    if (led && in_motion && all.size() == 1 && memory)
      all.push_back(std::make_unique<Predictor>(*all[0], estimation::LeadInOf(memory_s, duration_s), memory));
    else if (led)
      all.push_back(std::make_unique<Predictor>(*all[in_motion && all.size() > 1 ? 1 : 0], from_s, memory));
    else
      all.push_back(std::make_unique<Predictor>(*levels->data_, levels->model_, registry, memory, known));
    // A plant that forgets by itself cannot be given a longer memory: the same level once more would tell nothing.
    const auto reached = [](const Predictor& one) { return one.observer()->memory_s(); };
    if (like == nullptr && memory && !window_s && all.size() > 2 && !all.back()->free_run() &&
        reached(*all.back()) < kLongerAtLeast * reached(*all[all.size() - 2]))
      all.pop_back();
    else if (memory)
      kept.push_back(*memory);
  }
  if (like == nullptr && !kept.empty()) {
    levels->memories_s_ = kept;
    levels->longest_ = std::min(levels->longest_, kept.size() - 1);
  }
  if (!in_motion && from_s > 0.0 && all.back()->free_run())
    levels->from_the_start_ =
        std::make_unique<Predictor>(*levels->data_, levels->model_, registry, std::nullopt, known);
  for (const auto& predictor : all) predictor->LearnNoise(plan);
  return levels;
}

std::string Levels::Name(std::size_t level) const {
  return predictors_[level]->free_run() ? "free run"
                                        : fmt::format("memory {:.3g} s", predictors_[level]->observer()->memory_s());
}

std::int64_t Levels::simulations() const {
  std::int64_t sum = 0;
  for (const auto& predictor : predictors_) sum += predictor->simulations();
  return sum;
}

}  // namespace dynoproof::diagnosis
