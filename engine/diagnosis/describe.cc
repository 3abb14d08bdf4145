#include "diagnosis/describe.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/confidence.h"
#include "diagnosis/extend.h"
#include "diagnosis/polish.h"
#include "diagnosis/trial.h"
#include "estimation/horizon.h"
#include "experiment/drive_by_record.h"
#include "identification/nuisance.h"
#include "identification/residual_tests.h"
#include "identification/start.h"

namespace dynoproof::diagnosis {
namespace {

using Predictions = Result<Eigen::VectorXd>;

/// A fit as the report and the extended scenario take it: nominal values in deviations, effects with their numbers. `plan`:
/// of the fit, from where the records start.
identification::Hypothesis AsReported(const EstimationProblem& problem, const Contestant& one, const Eigen::VectorXd& q,
                                      const Plan& plan) {
  identification::Hypothesis hypothesis = problem.Nominal();
  const auto& parameters = one.hypothesis.parameters();
  for (std::size_t k = 0; k < problem.nuisances().size(); ++k) {
    const identification::Nuisance& nuisance = problem.nuisances()[k];
    const double nominal = problem.plan().root.NumberOr(nuisance.path, 0.0);
    double value = nominal;
    if (nuisance.start) {
      value = plan.root.NumberOr(StartOfRecord(0) + "." + nuisance.path, nominal);
    } else {
      const auto own = std::ranges::find(parameters, nuisance.path, &estimation::Parameter::name);
      if (own == parameters.end()) continue;
      value = own->ValueAt(q[own - parameters.begin()]);
    }
    hypothesis.z[k] = (nuisance.relative ? std::log(value / nominal) : value - nominal) / nuisance.spread;
  }
  std::size_t next = 0;
  for (const auto& [effect, place] : one.hypothesis.effects()) {
    std::vector<double> values(effect->info().parameters.size());
    for (double& value : values) {
      value = parameters[next].ValueAt(q[static_cast<Eigen::Index>(next)]);
      ++next;
    }
    hypothesis.effects.push_back({effect, place, std::move(values)});
  }
  return hypothesis;
}

/// The coordinates that are told of a model: of all the records, where it was fitted to them.
const Eigen::VectorXd& ToldOf(const Contestant& one, std::size_t level) {
  return one.to_all ? one.to_all->q : one.levels[level].q;
}

/// The numbers of all effects of a model with intervals: at the deciding level of an exact one, else the hull over all levels,
/// for how much a number depends on what is taken for unknown is what the model's error makes of it.
std::vector<FoundEffect> FoundOf(const Contestant& one, const Levels& levels, const Settled& settled) {
  const Eigen::VectorXd& q = ToldOf(one, settled.level);
  Eigen::VectorXd low = q, high = q;
  const auto widen = [&](const Eigen::VectorXd& about, const Eigen::VectorXd& half) {
    low = low.cwiseMin(about - half).cwiseMax(one.hypothesis.lower());
    high = high.cwiseMax(about + half).cwiseMin(one.hypothesis.upper());
  };
  if (one.to_all) widen(one.to_all->q, one.to_all->half);
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const bool replaced = one.to_all && level == settled.level;
    const bool counts = !replaced && (!settled.exact || level == settled.level);
    if (one.Holds(level) && counts)
      widen(one.levels[level].q, HalfIntervalOf(one.levels[level], levels.data(), one.hypothesis));
  }
  std::vector<FoundEffect> all;
  Eigen::Index i = 0;
  for (const auto& [effect, place] : one.hypothesis.effects()) {
    FoundEffect found;
    found.name = effect->info().name;
    found.at = place.ToString();
    found.description = effect->info().description;
    found.law = effect->info().law;
    for (const EffectParameter& known : effect->info().parameters) {
      const estimation::Parameter& parameter = one.hypothesis.parameters()[static_cast<std::size_t>(i)];
      const double a = parameter.ValueAt(low[i]), b = parameter.ValueAt(high[i]);
      found.parameters.push_back({known.name, parameter.unit, parameter.ValueAt(q[i]), std::min(a, b), std::max(a, b)});
      for (std::size_t level = 0; level < levels.size(); ++level) {
        if (!levels.IsSteppingStone(level) && one.Holds(level))
          found.parameters.back().by_level.emplace_back(levels.Name(level), parameter.ValueAt(one.levels[level].q[i]));
      }
      ++i;
    }
    all.push_back(std::move(found));
  }
  return all;
}

/// The outcome of the comparison for a candidate, or the reason why it took no part.
std::string OutcomeOf(const Settled& settled, const Contestant& one) {
  const auto entry = std::ranges::find_if(settled.journal, [&](const JournalEntry& some) {
    return !some.compared.empty() && some.compared.front() == one.Name();
  });
  return entry != settled.journal.end() ? entry->outcome : one.levels[settled.level].broken;
}

/// RMS over the channels of what a model leaves at a level, over the spread of the signal; NaN where its run breaks.
double NrmseOf(const Contestant& one, const Levels& levels, std::size_t level) {
  if (!one.Holds(level)) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  const std::vector<estimation::Channel>& channels = levels.data().channels();
  for (std::size_t c = 0; c < channels.size(); ++c)
    sum += std::pow(channels[c].OfSpread(one.levels[level].scales[c].rms), 2);
  return std::sqrt(sum / static_cast<double>(channels.size()));
}

/// By level, the share of the null's excess that a model removes.
std::vector<std::pair<std::string, double>> SharesOf(const Contestant& one, const Contestant& null,
                                                     const Levels& levels) {
  std::vector<std::pair<std::string, double>> shares;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    if (!levels.IsSteppingStone(level) && one.Holds(level) && null.Holds(level))
      shares.emplace_back(levels.Name(level), ShareOf(one, null, levels, level));
  }
  return shares;
}

/// The share of unknown forces that the innovations of a model are most likely with: how much of what drives the machine it does not
/// account for. Nothing where its run holds at no level.
std::optional<double> UnknownForcesOf(const Contestant& one, const Levels& levels) {
  std::optional<double> share;
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t level = 0; level < levels.size(); ++level) {
    if (!one.Holds(level) || one.levels[level].innovations.size() == 0) continue;
    const double likelihood = estimation::LogLikelihood(one.levels[level], levels[level]);
    if (!(likelihood > best)) continue;
    best = likelihood;
    share = levels[level].free_run() ? 0.0 : levels[level].observer()->share();
  }
  return share;
}

/// The nominal plan with what a model has found of each record: its start, and how numbers differ there.
Plan FromTheStartOf(const Plan& begun, const Contestant& one, const Eigen::VectorXd& q) {
  Plan plan = begun;
  for (std::size_t i = one.hypothesis.of_effects(); i < one.hypothesis.parameters().size(); ++i) {
    const estimation::Parameter& parameter = one.hypothesis.parameters()[i];
    if (parameter.name.starts_with("of_record."))
      WriteNumber(plan.root, parameter.name, parameter.ValueAt(q[static_cast<Eigen::Index>(i)]));
  }
  return plan;
}

/// Free runs of three models over the rows that took no part: as given, with nominal values released, with the cause.
struct Judged {
  EstimationProblem problem;
  double from = 0.0;  // share of each channel that is not judged
  Predictions given, released, with_cause;
};

Judged JudgeOf(const Task& task, const Plan& given, const std::optional<Plan>& released, const Plan& with_cause) {
  const bool own = !task.holdout.empty();
  Judged judged{EstimationProblem(task.problem.plan(), own ? task.holdout : task.data, task.problem.registry()),
                own ? 0.0 : kFittedShare, Failure{"not fitted"}, Failure{"not fitted"}, Failure{"not fitted"}};
  // Other records begin elsewhere: as the scenario does, or, in motion, where it suits each model best by their first tenth.
  if (own && std::ranges::any_of(task.holdout, &MappedRecord::in_motion)) judged.from = identification::kStartShare;
  const auto predict = [&](Plan plan) -> Predictions {
    if (own) {
      plan.root.Erase("of_record");
      Result<Plan> started = identification::FindStarts(judged.problem, plan, judged.from);
      if (!started.ok()) return started.failure();
      plan = *std::move(started);
    }
    return judged.problem.PredictPlan(plan);
  };
  judged.given = predict(given);
  judged.with_cause = predict(with_cause);
  if (released) judged.released = predict(*released);
  return judged;
}

std::map<std::string, double> NrmseBySignal(const Judged& judged, const Predictions& predicted) {
  std::map<std::string, double> all;
  if (!predicted.ok()) return all;
  for (const auto& [name, gain] : GainsOf(judged.problem, *predicted, *predicted, judged.from)) all[name] = gain.after;
  return all;
}

/// Effects at places that these records cannot show.
std::vector<NotTestable> NotTestableOf(const EstimationProblem& problem) {
  std::vector<NotTestable> all;
  for (const Effect* effect : problem.registry().Effects()) {
    for (const Place& place : effect->Places(problem.plan())) {
      if (CanBeSeen(place, problem.channels(), problem.records().front())) continue;
      all.push_back({effect->info().name, place.ToString(),
                     place.kind == "output" ? "no record has this output" : "no record drives this input"});
    }
  }
  return all;
}

void TestResidual(const EstimationProblem& problem, const Eigen::VectorXd& predicted, Diagnosis& result) {
  const auto structure = identification::FindStructure(problem, problem.measured() - predicted, predicted);
  result.tests = identification::TestsOf(structure);
  for (const identification::Structure& one : structure) {
    if (!one.tested) continue;
    if (one.HasLine()) result.lines.push_back({one.signal, one.line_hz, one.line_share});
    result.journal.push_back({"residual tests",
                              {one.signal},
                              "independent of inputs and predicted outputs, no line, no larger than noise",
                              {{"regression_f_p_value", one.p_value},
                               {"explained_share", one.explained},
                               {"line_fisher_g_p_value", one.line_p_value},
                               {"line_share", one.line_share},
                               {"line_hz", one.line_hz},
                               {"over_high_frequency_level", one.over_floor},
                               {"over_one_step_error", one.rings},
                               {"over_spread", one.size}},
                              one.found() ? one.Text() : "noise"});
  }
}

/// The effects of a model but for the last one: "a@x + b@y".
std::string BesideItsLast(const Contestant& one) {
  const std::string name = one.Name();
  const std::size_t last = name.rfind(" + ");
  return last == std::string::npos ? "" : name.substr(0, last);
}

/// What a main cause leaves, by signal, on the rows that took no part.
void Leave(const Judged& judged, const Diagnosis& result, std::map<std::string, Left>& left) {
  if (!judged.with_cause.ok()) return;
  const Eigen::VectorXd residual = judged.problem.measured() - *judged.with_cause;
  for (std::size_t c = 0; c < judged.problem.channels().size(); ++c) {
    const ComparedOutput& channel = judged.problem.channels()[c];
    const auto gain = result.holdout.find(channel.name);
    const auto floor = result.floor_by_signal.find(channel.name);
    if (gain == result.holdout.end() || floor == result.floor_by_signal.end()) continue;
    left[channel.name] = {gain->second.after, LocaliseIn(judged.problem, residual, c, floor->second)};
  }
}

}  // namespace

Status Describe(const Task& task, const Levels& levels, const Contest& contest, const Settled& settled,
                const std::optional<Contestant>& released, const std::vector<std::string>& alike, Diagnosis& result) {
  const EstimationProblem& problem = task.problem;
  const std::size_t chosen = !settled.causes.empty() ? settled.causes.front() : settled.best.value_or(0);
  const Contestant& model = contest.contestants[chosen];
  std::size_t level = settled.level;
  while (level > 0 && !model.Holds(level)) --level;
  if (!model.Holds(level)) return {};
  const estimation::Estimate& fit = model.levels[level];
  const Eigen::VectorXd& q = ToldOf(model, level);
  result.effects = FoundOf(model, levels, settled);
  // A model is fitted where its run is corrected, or behind a lead-in, which says little of where the records start.
  Plan with_cause = model.hypothesis.At(q);
  if (const Result<Plan> started = identification::FindStarts(problem, with_cause); started.ok()) with_cause = *started;
  const identification::Hypothesis hypothesis = AsReported(problem, model, q, with_cause);
  const Plan given = FromTheStartOf(task.begun, model, q);
  std::optional<Plan> let_go;
  if (released && released->Holds(level)) let_go = released->hypothesis.At(released->levels[level].q);
  const Predictions before = problem.PredictPlan(given), after = problem.PredictPlan(with_cause);
  if (before.ok() && after.ok()) result.train = GainsOf(problem, *before, *after, 0.0);
  const Judged judged = JudgeOf(task, given, let_go, with_cause);
  if (judged.given.ok() && judged.with_cause.ok()) {
    result.holdout = GainsOf(judged.problem, *judged.given, *judged.with_cause, judged.from);
    result.explained = ExplainedShare(judged.problem, *judged.given, *judged.with_cause, judged.from);
  }
  // Shares are those of runs that the record corrects, too: what is right there and wrong in the free run is no main cause.
  const bool no_better = IsNoBetterThanGiven(result.explained, settled.exact);
  if (!settled.exact && !settled.causes.empty() && no_better) {
    result.verdict = Conclusion::kUnexplained;
    result.reason = fmt::format(
        "{} removes most beside a run that the record corrects, but in the free run the model is no better with it",
        model.Name());
  }
  if (result.verdict == Conclusion::kAmbiguous) {
    std::vector<std::string> names;
    std::vector<identification::EffectInstance> instances;
    for (const std::size_t i : settled.causes) {
      const Contestant& one = contest.contestants[i];
      names.push_back(one.Name());
      if (i != chosen && one.Holds(settled.level)) result.instead.push_back(FoundOf(one, levels, settled));
      instances.push_back(AsReported(problem, one, ToldOf(one, level), task.begun).effects.back());
    }
    names.insert(names.end(), alike.begin(), alike.end());
    result.ambiguous_with.push_back(names);
    result.experiment_text = SeparatingText(problem, instances);
    if (const Result<std::string> file = WriteSeparating(problem, instances, task.options); file.ok())
      result.experiment_scenario = *file;
  }
  for (FoundEffect& effect : result.effects) effect.confidence = ConfidenceOf(result.verdict, result.effects.size());
  result.given = NrmseBySignal(judged, judged.given);
  result.released = NrmseBySignal(judged, judged.released);
  result.with_cause = NrmseBySignal(judged, judged.with_cause);
  std::vector<double> floors;
  double floor = 0.0;
  for (std::size_t c = 0; c < levels.data().channels().size(); ++c) {
    const estimation::Channel& channel = levels.data().channels()[c];
    result.floor_by_signal[channel.name] = channel.noise;
    floors.push_back(channel.noise);
    const auto rows = fit.innovations.segment(channel.begin, channel.count);
    result.residual_by_signal[channel.name] =
        std::sqrt(rows.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, channel.count)));
    floor += std::pow(channel.OfSpread(channel.noise), 2);
  }
  result.noise_floor = std::sqrt(floor / static_cast<double>(floors.size()));
  result.at_noise_floor = IsExact(fit);
  if (result.verdict == Conclusion::kMainCause) Leave(judged, result, result.left);
  if (before.ok()) result.where = Localise(problem, problem.measured() - *before, floors);
  if (after.ok()) TestResidual(problem, *after, result);
  result.not_testable = NotTestableOf(problem);
  result.not_testable.insert(result.not_testable.end(), contest.silent.begin(), contest.silent.end());
  result.unknown_forces = UnknownForcesOf(model, levels);
  if (const auto horizon = estimation::HorizonOf(given, problem.records().front(), problem.registry());
      horizon.ok() && *horizon)
    result.horizon_s = (*horizon)->horizon_s;
  for (std::size_t i = 0; i < hypothesis.z.size(); ++i) {
    const identification::Nuisance& nuisance = problem.nuisances()[i];
    if (hypothesis.z[i] == 0.0) continue;
    const auto value = identification::ValueOf(nuisance, hypothesis.z[i], problem.plan());
    result.refitted.push_back({nuisance.path, value.nominal, value.value, hypothesis.z[i], nuisance.start});
  }
  for (const std::size_t i : NominalValuesOnBounds(model, level)) {
    const estimation::Parameter& own = model.hypothesis.parameters()[i];
    result.notes.push_back(fmt::format(
        "{} = {:.4g} lies on the bound of its fit (nominal {:.4g}): it would go on, or stands for something else",
        own.name, own.ValueAt(q[static_cast<Eigen::Index>(i)]), own.reference));
  }
  for (std::size_t i = 1; i < contest.contestants.size(); ++i) {
    const Contestant& one = contest.contestants[i];
    const bool named = std::ranges::find(settled.causes, i) != settled.causes.end();
    const std::size_t at = one.Holds(level) ? level : contest.first;
    result.considered.push_back({.name = one.effect().info().name,
                                 .at = one.place().ToString(),
                                 .why_not = named              ? ""
                                            : contest.complete ? OutcomeOf(settled, one)
                                                               : "the search ended before it was followed",
                                 .on_top_of = BesideItsLast(one),
                                 .validation_nrmse = NrmseOf(one, levels, at),
                                 .shares = SharesOf(one, contest.null(), levels)});
  }
  if (result.effects.empty()) return {};
  if (no_better) {
    result.notes.push_back(
        "with this the model is no better on data that took no part than as given: no extended scenario is written");
    RemoveExtended(task.options);
    return {};
  }
  const Result<std::string> file = WriteExtended(problem, hypothesis, result, task.options);
  if (!file.ok()) return file.failure();
  result.extended_scenario = *file;
  return {};
}

}  // namespace dynoproof::diagnosis
