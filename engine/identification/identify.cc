#include "identification/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "experiment/drive_by_record.h"
#include "experiment/prediction_windows.h"
#include "identification/between_samples.h"
#include "identification/corrected_fit.h"
#include "identification/response_objective.h"
#include "identification/start.h"
#include "identification/suspects.h"
#include "identification/told_apart.h"
#include "model/prior.h"
#include "scenario/load.h"

namespace dynoproof::identification {
namespace {

constexpr double kTwoSided95 = 1.959964;  // standard deviations of a normal variable

/// Sandwich covariance: the scores of neighbouring samples are correlated where the residual is coloured, so they are
/// summed over blocks that are longer than its memory.
Eigen::MatrixXd Sandwich(const Objective& objective, const Optimum& at, const Eigen::MatrixXd& inverse) {
  constexpr Eigen::Index kBlocks = 50, kFewest = 8;  // the score of all rows together is none at the optimum
  const Eigen::Index p = at.jacobian.cols();
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(p, p);
  for (const auto& [first, count] : objective.Courses()) {
    const Eigen::Index blocks =
        std::min<Eigen::Index>(kBlocks, std::max<Eigen::Index>(std::min(kFewest, count), count / 10));
    for (Eigen::Index b = 0; b < blocks; ++b) {
      const Eigen::Index begin = first + count * b / blocks, end = first + count * (b + 1) / blocks;
      const Eigen::VectorXd score =
          at.jacobian.middleRows(begin, end - begin).transpose() * at.error.segment(begin, end - begin);
      meat += score * score.transpose();
    }
  }
  return inverse * meat * inverse;
}

/// The objective that a method with one stage minimises.
using Misfit = Result<std::unique_ptr<Objective>> (*)(const EstimationProblem& problem);

Result<std::unique_ptr<Objective>> OfFreeRun(const EstimationProblem& problem) { return FreeRunObjective(problem); }
Result<std::unique_ptr<Objective>> OfSpectrum(const EstimationProblem& problem) { return SpectrumObjective(problem); }
Result<std::unique_ptr<Objective>> OfResponse(const EstimationProblem& problem) {
  const Result<MeasuredCurve> measured = MeasuredResponse(problem);
  if (!measured.ok()) return measured.failure();
  return ResponseObjective(problem, measured->response);
}

/// The record with a clock that is off: its step by a share, the instants of one output beside the inputs by a time.
MappedRecord OffClock(MappedRecord record, double stretch, const std::string& output, double shift_s) {
  for (auto* signals : {&record.inputs, &record.outputs}) {
    for (auto& [name, series] : *signals) {
      std::vector<double> time = *series.time;
      for (double& t : time) t = t * (1.0 + stretch) + (signals == &record.outputs && name == output ? shift_s : 0.0);
      series.time = std::make_shared<const std::vector<double>>(std::move(time));
    }
  }
  for (auto& [name, step_s] : record.step_s) step_s *= 1.0 + stretch;
  record.end_s *= 1.0 + stretch, record.period_s *= 1.0 + stretch;
  return record;
}

/// Covariance of the search's own numbers by what the records' stamps leave open: each such doubt moves the optimum by
/// (J'J)^-1 J' times what it moves the error, and a 95 % interval is to reach to its end.
Result<Eigen::MatrixXd> ByDoubtOfStamps(const EstimationProblem& problem, Misfit misfit, const Plan& found,
                                        const Optimum& at, const Eigen::MatrixXd& inverse) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(inverse.rows(), inverse.cols());
  const auto add = [&](std::size_t record, double stretch, const std::string& output, double shift_s) -> Status {
    std::vector<MappedRecord> off = problem.records();
    off[record] = OffClock(std::move(off[record]), stretch, output, shift_s);
    const EstimationProblem other(problem.plan(), std::move(off), problem.registry());
    const Result<std::unique_ptr<Objective>> objective = misfit(other);
    if (!objective.ok()) return objective.failure();
    const Result<Eigen::VectorXd> error = (*objective)->Of(found);
    if (!error.ok()) return error.failure();
    if (error->size() != at.error.size()) return {};  // the doubt cuts bands or rows: nothing to compare
    const Eigen::VectorXd moved = inverse * (at.jacobian.transpose() * (*error - at.error)) / kTwoSided95;
    sum += moved * moved.transpose();
    return {};
  };
  for (std::size_t r = 0; r < problem.records().size(); ++r) {
    const MappedRecord& record = problem.records()[r];
    if (record.step_doubt > 0.0) {
      if (Status failed = add(r, record.step_doubt, "", 0.0)) return *failed;
    }
    for (const auto& [name, doubt_s] : record.shift_doubt_s) {
      if (Status failed = add(r, 0.0, name, doubt_s)) return *failed;
    }
  }
  return sum;
}

/// Intervals by the covariance of the search's own numbers. One as wide as the axis says nothing; and of what is not
/// told apart scores vanish with the slopes, which is no covariance.
void AddIntervals(const Objective& objective, const Optimum& at, const std::vector<Axis>& axes,
                  const Eigen::MatrixXd& inverse, const Eigen::MatrixXd& by_stamps, Identified& result) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd own = Sandwich(objective, at, inverse) + by_stamps;
  Eigen::VectorXd slope(own.rows());
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    slope[k] = axes[i].Slope(at.x[i]);
    const double half = kTwoSided95 * std::sqrt(std::max(0.0, own(k, k)));
    const double a = axes[i].ValueAt(at.x[i] - half), b = axes[i].ValueAt(at.x[i] + half);
    const bool told = std::none_of(result.alike.begin(), result.alike.end(), [&](const std::vector<std::string>& set) {
      return std::find(set.begin(), set.end(), axes[i].key) != set.end();
    });
    if (!told) own.row(k).setConstant(kNone), own.col(k).setConstant(kNone);
    if (told && !result.values[i].on_bound && half < 0.5 * (axes[i].high - axes[i].low))
      result.values[i].interval = {std::min(a, b), std::max(a, b)};
  }
  result.covariance = slope.asDiagonal() * own * slope.asDiagonal();
}

Status InOneStage(const EstimationProblem& problem, const std::vector<Axis>& axes, Misfit misfit,
                  const MultiStartOptions& search, Identified& result) {
  const Result<std::unique_ptr<Objective>> objective = misfit(problem);
  if (!objective.ok()) return objective.failure();
  const Result<Optimum> best = Minimise(problem.plan(), **objective, axes, search);
  if (!best.ok()) return best.failure();
  const Eigen::MatrixXd inverse = Take(*best, axes, result);
  const Result<Eigen::MatrixXd> by_stamps =
      ByDoubtOfStamps(problem, misfit, With(problem.plan(), axes, best->x), *best, inverse);
  if (!by_stamps.ok()) return by_stamps.failure();
  AddIntervals(**objective, *best, axes, inverse, *by_stamps, result);
  return {};
}

/// Refines an exact model in the free run, whose minimum is near the corrected fit; the free run's objective estimates the start of
/// each record and counts the uncertainty of its stamps. Where a run breaks, the corrected fit stands.
void GoOnInFreeRun(const EstimationProblem& problem, const std::vector<Axis>& axes, Identified& result) {
  Identified free_run;
  free_run.converged = 1;
  MultiStartOptions search = {.starts = 1};
  for (std::size_t i = 0; i < axes.size(); ++i) search.first.push_back(axes[i].At(result.values[i].value));
  if (InOneStage(problem, axes, OfFreeRun, search, free_run)) return;
  result.values = std::move(free_run.values);
  result.covariance = std::move(free_run.covariance);
  result.singular = std::move(free_run.singular);
  result.alike = std::move(free_run.alike);
}

template <Misfit misfit, bool by_runs>
Status OneStage(const EstimationProblem& problem, const std::vector<Axis>& axes, const IdentifyOptions& options,
                Identified& result) {
  return InOneStage(problem, axes, misfit, {options.starts, TriesOf(options.keys, by_runs), options.progress}, result);
}

Status Corrected(const EstimationProblem& problem, const std::vector<Axis>& axes, const IdentifyOptions& options,
                 Identified& result) {
  if (Status failed = FitCorrected(problem, options, result)) return failed;
  // The free run's objective knows no differences between records.
  if (!result.level->memory_s && result.of_records.empty()) GoOnInFreeRun(problem, axes, result);
  return {};
}

constexpr const char* kCorrected = "corrected";

std::map<std::string, Method>& AllMethods() {
  static std::map<std::string, Method> methods = {
      {kCorrected,
       {"the error of runs that the record corrects less and less, up to the free run where the model is exact",
        Corrected}},
      {"free_run", {"the error of the free run sample by sample, for values near by", OneStage<OfFreeRun, true>}},
      {"response",
       {"the error of a drive line's frequency response, by [analysis], for values far off, too",
        OneStage<OfResponse, false>}},
      {"spectrum", {"the error of the outputs' spectra, for values far off, too", OneStage<OfSpectrum, true>}}};
  return methods;
}

/// Why a fit is worth nothing.
std::vector<std::string> DoubtsOf(const Identified& result) {
  constexpr double kWorse = 1.01, kNothing = 0.9;  // what leaves four fifths of the squares accounts for nothing
  std::vector<std::string> doubts;
  for (const IdentifiedValue& one : result.values) {
    if (one.on_bound)
      doubts.push_back(fmt::format("{} rests on its bound ({:.6g}): the records want it beyond, or do not show it",
                                   one.key, one.value));
  }
  const double before = result.level ? result.level->nrmse_before : result.nrmse_before;
  const double after = result.level ? result.level->nrmse_after : result.nrmse_after;
  if (!(after <= kWorse * before))
    doubts.push_back(fmt::format("the fit leaves more than it found: NRMSE {:.3g} -> {:.3g}", before, after));
  // The record keeps a corrected run of any model near: a fit must have lowered its error, or have reached the noise.
  const bool nearer = result.level && (result.level->at_noise || after <= kNothing * before);
  if (!(after <= kNothing) || (result.level && !nearer && !(result.nrmse_after <= kNothing)))
    doubts.push_back(fmt::format("the fit explains nothing: NRMSE {:.3g}; is it the right record, in the right units?",
                                 result.nrmse_after));
  return doubts;
}

}  // namespace

const std::map<std::string, Method>& Methods() { return AllMethods(); }
void AddMethod(const std::string& name, Method method) { AllMethods().emplace(name, std::move(method)); }

Eigen::MatrixXd Take(const Optimum& at, const std::vector<Axis>& axes, Identified& result) {
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    keys.push_back(axes[i].key);
    result.values.push_back(
        {axes[i].key, axes[i].nominal, axes[i].ValueAt(at.x[i]), std::nullopt, axes[i].OnBound(at.x[i])});
  }
  result.converged = std::min(result.converged, at.converged);
  ToldApart told = TellApart(at.jacobian, at.error.squaredNorm() / static_cast<double>(at.error.size()), keys);
  result.singular.insert(result.singular.end(), told.singular.begin(), told.singular.end());
  std::ranges::move(told.alike, std::back_inserter(result.alike));
  return std::move(told.inverse);
}

Result<Identified> Identify(const Plan& plan, const std::vector<MappedRecord>& data, const Registry& registry,
                            const IdentifyOptions& options) {
  const auto method = Methods().find(options.method);
  if (method == Methods().end()) return Failure{.message = "no method is called " + options.method, .exit_code = 2};
  const EstimationProblem given(plan, data, registry);
  const Result<Plan> begun = FindStarts(given, given.plan());
  if (!begun.ok()) return begun.failure();
  const EstimationProblem problem(*begun, data, registry);
  const std::unique_ptr<Objective> free_run = FreeRunObjective(problem);
  std::vector<Axis> axes;
  for (const FreeKey& free : options.keys) axes.emplace_back(free, plan.root.FindPath(free.key)->number());
  const Result<double> before = NrmseOf(*free_run, problem.plan());
  if (!before.ok()) return before.failure();
  Identified result;
  result.starts = result.converged = options.starts;
  result.nrmse_before = *before;
  if (Status failed = method->second.fit(problem, axes, options, result)) return *failed;
  Plan found = problem.plan();
  for (const IdentifiedValue& one : result.values) *found.root.FindPath(one.key) = Value(one.value);
  for (const ValueOfRecord& one : result.of_records)
    WriteNumber(found.root, DifferenceOfRecord(one.record) + "." + one.key, one.factor);
  const Result<double> after = NrmseOf(*free_run, found);
  if (!after.ok()) return after.failure();
  result.nrmse_after = *after;
  result.doubts = DoubtsOf(result);
  if (options.method != kCorrected && data.size() > 1 && !NumbersThatDiffer(plan).empty())
    result.notes.push_back("[prior] states numbers that differ from record to record: --method corrected fits them");
  if (result.level && result.level->memory_s)
    result.notes.push_back("the model leaves more than noise in its free run: diagnose looks for what it lacks");
  return result;
}

Result<Identified> IdentifyBetween(const Plan& plan, const std::vector<MappedRecord>& data, const Registry& registry,
                                   const IdentifyOptions& options) {
  constexpr double kGood = 1e-3, kBetter = 0.9;  // by then half a sample more or less is not what is left
  Result<Identified> best = Identify(plan, data, registry, options);
  const auto guess = [&](const MappedRecord& record) { return !UnstatedInputs(plan, record).empty(); };
  const auto doubtful = std::find_if(data.begin(), data.end(), guess);
  if (!best.ok() || doubtful == data.end() || best->nrmse_after < kGood || PredictionWindow(plan)) return best;
  const auto guessed = doubtful->between.find(UnstatedInputs(plan, *doubtful).front());
  const std::string first = guessed == doubtful->between.end() ? "held" : guessed->second;
  Plan found = plan;
  for (const IdentifiedValue& one : best->values) *found.root.FindPath(one.key) = Value(one.value);
  if (IsClear(CompareBetween(found, registry, *doubtful), first)) return best;
  const double before = best->nrmse_after;
  double least = before, most = before;
  std::string taken = first, text = fmt::format("{} {:.3g}", first, best->nrmse_after);
  for (const std::string& between : PossibleBetween(plan, *doubtful)) {
    if (between == first) continue;
    std::vector<MappedRecord> other = data;
    for (MappedRecord& record : other) record = WithBetween(std::move(record), plan, between);
    Result<Identified> fit = Identify(plan, other, registry, options);
    if (!fit.ok()) continue;
    text += fmt::format(", {} {:.3g}", between, fit->nrmse_after);
    least = std::min(least, fit->nrmse_after), most = std::max(most, fit->nrmse_after);
    if (fit->nrmse_after < std::min(kBetter * before, best->nrmse_after)) best = std::move(fit), taken = between;
  }
  if (least > kBetter * most) return best;  // it makes no difference
  best->notes.push_back(fmt::format(
      "neither file nor map says what the inputs do between their samples; fitted, the outputs are off by (NRMSE) "
      "{}: {} is taken; if you know it, say between = ... of each input in a map",
      text, taken));
  return best;
}

std::vector<std::string> WhatItMayBe(const Plan& plan, const std::vector<MappedRecord>& data, const Registry& registry,
                                     const IdentifyOptions& options, const Identified& identified) {
  constexpr std::size_t kTried = 3;
  constexpr double kAlike = 0.5;  // correlation
  std::vector<std::string> causes;
  if (PredictionWindow(plan) || AccountsFor(identified.nrmse_after)) return causes;
  const EstimationProblem problem(plan, data, registry);
  Plan found = plan;
  for (const IdentifiedValue& one : identified.values) *found.root.FindPath(one.key) = Value(one.value);
  // The fit went where a wrong reading sent it: the numbers that it began with are the better guess.
  std::vector<Suspect> suspects;
  for (const Plan* at : {&plan, static_cast<const Plan*>(&found)}) {
    Result<std::vector<Suspect>> some = SuspectsOf(problem, *at);
    if (some.ok()) std::move(some->begin(), some->end(), std::back_inserter(suspects));
    if (!suspects.empty()) break;
  }
  IdentifyOptions once = options;
  once.starts = 1;
  for (std::size_t i = 0; i < std::min(kTried, suspects.size()); ++i) {
    const Result<Identified> fit = Identify(plan, suspects[i].records, registry, once);
    if (fit.ok() && AccountsFor(fit->nrmse_after))
      causes.push_back(
          fmt::format("with {} the fit leaves NRMSE {:.3g} instead of {:.3g}: a map says units, signs and "
                      "columns",
                      suspects[i].text, fit->nrmse_after, identified.nrmse_after));
  }
  if (!causes.empty()) return causes;
  for (const Suspect& one : MisreadingsOf(plan, data.front(), registry))
    causes.push_back(
        fmt::format("the model would be near the record, if that were read otherwise: {}; a map says units, signs and "
                    "columns",
                    one.text));
  if (!causes.empty()) return causes;
  if (const double alike = LargestCorrelation(problem, found); alike < kAlike)
    causes.push_back(
        fmt::format("no output is like what the fitted scenario makes of the inputs (correlation {:.2f} at "
                    "most): are these its inputs and outputs, is it a record of this machine?",
                    alike));
  return causes;
}

nlohmann::json ToJson(const Identified& identified) {
  nlohmann::json out = {{"parameters", nlohmann::json::object()},
                        {"covariance", nlohmann::json::array()},
                        {"singular_values", identified.singular},
                        {"not_told_apart", identified.alike},
                        {"starts", identified.starts},
                        {"converged", identified.converged},
                        {"nrmse_before", identified.nrmse_before},
                        {"nrmse_after", identified.nrmse_after},
                        {"notes", identified.notes},
                        {"doubts", identified.doubts}};
  if (identified.sighting) out[identified.sighting->name] = identified.sighting->numbers;
  if (identified.level) {
    const CorrectedLevel& level = *identified.level;
    out["corrected"] = {{"memory_s", nullptr},
                        {"unknown_forces", level.share},
                        {"nrmse_before", level.nrmse_before},
                        {"nrmse_after", level.nrmse_after},
                        {"simulations", level.simulations}};
    if (level.memory_s) out["corrected"]["memory_s"] = *level.memory_s;
  }
  for (const IdentifiedValue& one : identified.values) {
    out["parameters"][one.key] = {
        {"value", one.value}, {"nominal", one.nominal}, {"ci95", nullptr}, {"on_bound", one.on_bound}};
    if (one.interval) out["parameters"][one.key]["ci95"] = {one.interval->first, one.interval->second};
  }
  for (const ValueOfRecord& one : identified.of_records) {
    out["of_records"].push_back({{"record", one.file},
                                 {"key", one.key},
                                 {"factor", one.factor},
                                 {"ci95", {one.interval.first, one.interval.second}}});
  }
  for (Eigen::Index i = 0; i < identified.covariance.rows(); ++i) {
    out["covariance"].push_back(nlohmann::json::array());
    for (Eigen::Index k = 0; k < identified.covariance.cols(); ++k)
      out["covariance"].back().push_back(identified.covariance(i, k));
  }
  return out;
}

std::string ToTable(const Identified& identified) {
  std::string text = fmt::format("{:<44}{:>14}{:>14}   95 % interval\n", "key", "nominal", "value");
  for (const IdentifiedValue& one : identified.values) {
    const std::string interval =
        one.interval ? fmt::format("{:.6g} ... {:.6g}", one.interval->first, one.interval->second) : "none";
    text += fmt::format("{:<44}{:>14.6g}{:>14.6g}   {}\n", one.key, one.nominal, one.value,
                        one.on_bound ? "on its bound" : interval);
  }
  for (const ValueOfRecord& one : identified.of_records)
    text += fmt::format("{:<58} times {:>8.4f}   {:.4f} ... {:.4f}\n", fmt::format("{} in {}", one.key, one.file),
                        one.factor, one.interval.first, one.interval.second);
  if (identified.sighting) text += identified.sighting->line;
  for (const auto& set : identified.alike) text += fmt::format("not told apart: {}\n", fmt::join(set, ", "));
  if (identified.level) {
    const CorrectedLevel& level = *identified.level;
    text += level.memory_s
                ? fmt::format(
                      "corrected by the record with a memory of {:.3g} s: NRMSE {:.4g} -> {:.4g}; forces of {:.2g} of "
                      "what drives are taken for unknown\n",
                      *level.memory_s, level.nrmse_before, level.nrmse_after, level.share)
                : fmt::format("judged in the free run, after {} simulations\n", level.simulations);
  }
  text += fmt::format("NRMSE {:.4g} -> {:.4g}; {} of {} starts reached the best fit\n", identified.nrmse_before,
                      identified.nrmse_after, identified.converged, identified.starts);
  return text;
}

namespace {

/// What a file that includes another writes of a path, and how much of the path leads there: an array on the way is
/// written as a whole, it can be replaced only so. Null where the path leads nowhere.
std::pair<const Value*, std::size_t> WrittenAs(const Value& root, const std::string& path) {
  const Value* value = &root;
  std::size_t begin = 0;
  while (begin < path.size() && value != nullptr && value->is_table()) {
    const std::size_t dot = std::min(path.find('.', begin), path.size());
    value = value->Find(path.substr(begin, dot - begin));
    begin = dot + 1;
  }
  return {value, std::min(begin == 0 ? 0 : begin - 1, path.size())};
}

bool Same(const Value& a, const Value& b) { return ToToml(Value{{"v", a}}) == ToToml(Value{{"v", b}}); }

/// Whether the effects of a plan have changed something that is written under one of the paths.
bool ActsOnOneOf(const std::vector<std::string>& paths, const Plan& applied, const Plan& written) {
  if (written.root.Find("effect") == nullptr) return false;
  return std::any_of(paths.begin(), paths.end(), [&](const std::string& path) {
    const Value *after = WrittenAs(applied.root, path).first, *before = WrittenAs(written.root, path).first;
    if (after == nullptr || before == nullptr) return after != before;
    return !Same(*after, *before);
  });
}

}  // namespace

std::string ToScenario(const Identified& identified, const Plan& plan, const Plan& written, const Plan& included,
                       const std::string& include, const std::vector<std::string>& overrides) {
  Plan found = plan;
  std::vector<std::string> changed;
  for (const std::string& change : overrides) changed.push_back(change.substr(0, change.find('=')));
  for (const IdentifiedValue& one : identified.values) {
    Value* value = found.root.FindPath(one.key);
    const std::size_t dot = one.key.rfind('.');  // a default stands in a table that is there
    if (value == nullptr) value = &(*found.root.FindPath(one.key.substr(0, dot)))[one.key.substr(dot + 1)];
    *value = Value(one.value);
    changed.push_back(one.key);
  }
  Value tree;
  tree["include"] = Value::Array{include};
  // Limits, oracles and golden traces are those of the other numbers.
  Value::Array without;
  const auto leave_out = [&](const std::string& section) {
    if (included.root.Find(section) != nullptr) without.emplace_back(section);
  };
  leave_out("check");
  if (ActsOnOneOf(changed, plan, written)) {
    leave_out("effect");
    for (const Value::Entry& section : found.root.table()) {
      const Value *before = written.root.Find(section.key), *after = plan.root.Find(section.key);
      if (section.key == "check" || (before != nullptr && Same(*before, *after))) continue;
      leave_out(section.key);
      changed.push_back(section.key);
    }
  }
  if (!without.empty()) tree["without"] = std::move(without);
  for (const std::string& path : changed) {
    const auto [from, length] = WrittenAs(found.root, path);
    if (from == nullptr) continue;
    Value* to = &tree;
    for (std::size_t begin = 0; begin < length;) {
      const std::size_t dot = std::min(path.find('.', begin), length);
      to = &(*to)[path.substr(begin, dot - begin)];
      begin = dot + 1;
    }
    *to = *from;
  }
  const std::vector<NumberThatDiffers> differ = NumbersThatDiffer(plan);  // which stays in force
  for (const IdentifiedValue& one : identified.values) {
    if (std::ranges::find(differ, one.key, &NumberThatDiffers::path) == differ.end())
      tree["prior"][one.key] = Value("fitted");
  }
  return std::string(kIdentified) + ToToml(tree);
}

}  // namespace dynoproof::identification
