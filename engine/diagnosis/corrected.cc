#include "diagnosis/corrected.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "diagnosis/candidates.h"
#include "diagnosis/contest.h"
#include "diagnosis/extend.h"
#include "diagnosis/judgement.h"
#include "diagnosis/policy.h"
#include "diagnosis/settle.h"
#include "experiment/drive_by_record.h"
#include "identification/nuisance.h"
#include "identification/residual_tests.h"
#include "identification/start.h"

namespace dynoproof::diagnosis {
namespace {

constexpr Eigen::Index kRows = 4000;  // of a channel, that are compared
constexpr int kMostCauses = 3;        // that are looked for one after the other

/// Which effect on top of a null explains what that leaves.
struct Answer {
  Contest contest;
  Settled settled;
};

/// Whether an answer with a cause in the model says more than the one before. Where several causes stood side by side, only
/// one of these, or a model that leaves nothing, tells that two of them are needed.
bool Adds(const Answer& before, const Answer& next) {
  if (next.settled.causes.empty()) return false;
  if (next.settled.exact) return true;
  if (next.settled.verdict != Verdict::kMainCause) return false;
  const Contestant& second = next.contest.contestants[next.settled.causes.front()];
  const auto stood = [&](std::size_t i) {
    return before.contest.contestants[i].hypothesis.effects().back() == second.hypothesis.effects().back();
  };
  return before.settled.causes.size() == 1 || std::ranges::any_of(before.settled.causes, stood);
}

/// The records that models are fitted to, and those that judge them afterwards.
struct Parts {
  std::unique_ptr<Levels> training, held_out;
};

/// Mean over channels of the logarithm of the power that a plan leaves in its free run.
double LogPowerOf(const Plan& plan, const Levels& levels) {
  const Result<Eigen::VectorXd> rows = levels[levels.free_run()].Innovations(plan);
  if (!rows.ok()) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const estimation::Channel& channel : levels.data().channels())
    sum += std::log(std::max(rows->segment(channel.begin, channel.count).squaredNorm() /
                                 static_cast<double>(std::max<Eigen::Index>(1, channel.count)),
                             std::numeric_limits<double>::min()));
  return sum / static_cast<double>(levels.data().channels().size());
}

/// Records in motion are led in by their samples, unless the plan holds starts (FitStarts()) that suit them as well: what
/// noise makes of a start that is found in a short lead-in stays in the free run behind it.
Result<Parts> Split(const Plan& plan, const std::vector<MappedRecord>& data, const std::vector<MappedRecord>& holdout,
                    const Registry& registry) {
  constexpr double kAsWell = 1.5;  // times the power
  std::vector<MappedRecord> first = data, later = holdout.empty() ? data : holdout;
  if (holdout.empty()) {
    for (MappedRecord& record : first) {
      record = OntoClock(std::move(record), plan);
      identification::CutRecord(record, kTrainingShare);
    }
  }
  const double most_s = policy::kSearchedSteps * plan.root.NumberOr("run.period_s", 1e-4);
  Result<std::unique_ptr<Levels>> training = Levels::Of(plan, first, registry, 0.0, kRows, nullptr, most_s);
  if (!training.ok()) return training.failure();
  if (std::ranges::any_of(first, &MappedRecord::in_motion)) {
    for (MappedRecord& record : first) record.in_motion = false;
    Result<std::unique_ptr<Levels>> unled = Levels::Of(plan, first, registry, 0.0, kRows, nullptr, most_s);
    if (unled.ok() && LogPowerOf(plan, **unled) <= LogPowerOf(plan, **training) + std::log(kAsWell)) {
      training = std::move(unled);
      if (holdout.empty()) {
        for (MappedRecord& record : later) record.in_motion = false;
      }
    }
  }
  const double from_s = holdout.empty() ? kTrainingShare * data.front().end_s : 0.0;
  Result<std::unique_ptr<Levels>> held = Levels::Of(plan, later, registry, from_s, kRows, training->get());
  if (!held.ok()) return held.failure();
  return Parts{*std::move(training), *std::move(held)};
}

/// Whether what a model leaves in its free run is noise, of whatever colour: independent of inputs and outputs, without lines
/// and no echo of the machine. Differences of a record tell white noise alone.
bool LeavesNoise(const EstimationProblem& problem, const Contestant& one, const Levels& levels) {
  const std::size_t free = levels.free_run();
  if (!one.Holds(free)) return false;
  const Result<Eigen::VectorXd> predicted = problem.PredictPlan(one.hypothesis.At(one.levels[free].q));
  if (!predicted.ok()) return false;
  const auto structure = identification::FindStructure(problem, problem.measured() - *predicted, *predicted);
  return std::ranges::all_of(structure, [](const auto& of) { return of.tested && !of.found(); });
}

/// The log excess of a plan's innovations.
std::optional<double> LogExcessAt(const Plan& plan, const Levels& levels, std::size_t level) {
  const Result<Eigen::VectorXd> rows = levels[level].Innovations(plan);
  if (!rows.ok()) return std::nullopt;
  return LogExcess(estimation::ScalesOf(levels.data(), *rows, levels[level].NoiseAlone(plan)), levels.data());
}

/// Of each contestant, as it is fitted at each level, over what the plan as given leaves. `own`: these are other records, which
/// start elsewhere than those of the fits.
std::vector<HeldOut> HeldOutOf(const Contest& contest, const Levels& held_out, const HeldOut& given, bool own) {
  std::vector<HeldOut> all(contest.contestants.size(), HeldOut(held_out.size()));
  ParallelFor(all.size(), 0, [&](std::size_t i) {
    const Contestant& one = contest.contestants[i];
    for (std::size_t level = contest.first; level < held_out.size(); ++level) {
      if (!one.Holds(level)) continue;
      Plan plan = one.hypothesis.At(one.levels[level].q);
      if (own) plan.root.Erase("start_of_record");
      all[i][level] = LogExcessAt(plan, held_out, level);
      if (all[i][level]) *all[i][level] -= given[level].value_or(0.0);
    }
  });
  return all;
}

/// By level, the least of all, the plan as given (0) among them.
std::vector<double> LeastOf(const std::vector<std::vector<HeldOut>>& passes, std::size_t levels) {
  std::vector<double> least(levels, 0.0);
  for (const auto& pass : passes) {
    for (const HeldOut& one : pass) {
      for (std::size_t level = 0; level < levels; ++level)
        least[level] = std::min(least[level], one[level].value_or(0.0));
    }
  }
  return least;
}

/// A fit as the report and the extended scenario take it: nominal values in deviations, effects with their numbers.
identification::Hypothesis AsReported(const EstimationProblem& problem, const Contestant& one,
                                      const Eigen::VectorXd& q) {
  identification::Hypothesis hypothesis = problem.Nominal();
  const auto& parameters = one.hypothesis.parameters();
  const std::size_t own = one.hypothesis.of_effects();
  for (std::size_t i = own; i < parameters.size(); ++i) {
    const double value = parameters[i].ValueAt(q[static_cast<Eigen::Index>(i)]);
    for (std::size_t k = 0; k < problem.nuisances().size(); ++k) {
      const identification::Nuisance& nuisance = problem.nuisances()[k];
      const double nominal = problem.plan().root.NumberOr(nuisance.path, 0.0);
      if ((nuisance.start ? StartOfRecord(0) + "." : "") + nuisance.path != parameters[i].name) continue;
      hypothesis.z[k] = (nuisance.relative ? std::log(value / nominal) : value - nominal) / nuisance.spread;
    }
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

/// The numbers of all effects of a model with intervals: at the deciding level of an exact one, else the hull over all levels,
/// for how much a number depends on what is taken for unknown is what the model's error makes of it.
std::vector<FoundEffect> FoundOf(const Contestant& one, const Levels& levels, const Settled& settled) {
  constexpr double kTwoSided = 1.959964;
  const estimation::Estimate& fit = one.levels[settled.level];
  Eigen::VectorXd low = fit.q, high = fit.q;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    if (!one.Holds(level) || (settled.exact && level != settled.level)) continue;
    const Eigen::VectorXd half =
        kTwoSided *
        estimation::Sandwich(one.levels[level], levels.data(), one.hypothesis).diagonal().cwiseMax(0.0).cwiseSqrt();
    low = low.cwiseMin(one.levels[level].q - half);
    high = high.cwiseMax(one.levels[level].q + half);
  }
  std::vector<FoundEffect> all;
  Eigen::Index i = 0;
  for (const auto& [effect, place] : one.hypothesis.effects()) {
    FoundEffect found;
    found.name = effect->info().name;
    found.at = place.ToString();
    for (const EffectParameter& known : effect->info().parameters) {
      const estimation::Parameter& parameter = one.hypothesis.parameters()[static_cast<std::size_t>(i)];
      const double a = parameter.ValueAt(low[i]), b = parameter.ValueAt(high[i]);
      found.parameters.push_back({known.name, known.unit, parameter.ValueAt(fit.q[i]), std::min(a, b), std::max(a, b)});
      ++i;
    }
    all.push_back(std::move(found));
  }
  return all;
}

/// Whether what a model leaves at its longest memory may be another cause beside a noise that can be seen.
bool NearEnough(const Contestant& one) {
  for (std::size_t level = one.levels.size(); level-- > 0;) {
    if (!one.Holds(level)) continue;
    return std::ranges::all_of(one.levels[level].scales, [](const estimation::ChannelScale& scale) {
      return scale.rms <= policy::kNearEnough * scale.noise_alone;
    });
  }
  return false;
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
    sum += std::pow(one.levels[level].scales[c].rms / std::max(channels[c].spread, 1e-300), 2);
  return std::sqrt(sum / static_cast<double>(channels.size()));
}

/// Fills in the report on the chosen model: its gain, where the given one (`begun`: from where the records start) is wrong, and
/// the residual.
Status Describe(const Parts& parts, const Contest& contest, const Settled& settled, const EstimationProblem& problem,
                const Plan& begun, const std::vector<MappedRecord>& data, const std::vector<MappedRecord>& holdout,
                const DiagnoseOptions& options, Diagnosis& result) {
  const Levels& levels = *parts.training;
  const std::size_t chosen = !settled.causes.empty() ? settled.causes.front() : settled.best.value_or(0);
  const Contestant& model = contest.contestants[chosen];
  std::size_t level = settled.level;
  while (level > 0 && !model.Holds(level)) --level;
  if (!model.Holds(level)) return {};
  const estimation::Estimate& fit = model.levels[level];
  const identification::Hypothesis hypothesis = AsReported(problem, model, fit.q);
  result.effects = FoundOf(model, levels, settled);
  if (result.verdict == Verdict::kAmbiguous) {
    std::vector<std::string> names;
    std::vector<identification::EffectInstance> alike;
    for (const std::size_t i : settled.causes) {
      const Contestant& one = contest.contestants[i];
      names.push_back(one.effect().info().name + "@" + one.place().ToString());
      alike.push_back(AsReported(problem, one, one.levels[level].q).effects.back());
    }
    result.ambiguous_with.push_back(names);
    result.experiment_text = SeparatingText(problem, alike);
    if (const Result<std::string> file = WriteSeparating(problem, alike, options); file.ok())
      result.experiment_scenario = *file;
  }
  // Gains in the free run, each model from the start that suits it.
  const auto gains = [&](const std::vector<MappedRecord>& records, double until, double from) {
    const EstimationProblem of(problem.plan(), records, problem.registry(), until);
    const Result<Plan> before = identification::FitStarts(of, problem.plan());
    const Result<Plan> after = identification::FitStarts(of, problem.PlanOf(hypothesis));
    if (!before.ok() || !after.ok()) return Result<std::map<std::string, SignalGain>>(Failure{"no start"});
    return MeasureGains(of, *before, *after, from);
  };
  if (const auto train = gains(data, holdout.empty() ? kTrainingShare : 1.0, 0.0); train.ok()) result.train = *train;
  if (const auto held = gains(holdout.empty() ? data : holdout, 1.0, holdout.empty() ? kTrainingShare : 0.0); held.ok())
    result.holdout = *held;
  double floor = 0.0;
  std::vector<double> floors;
  for (std::size_t c = 0; c < levels.data().channels().size(); ++c) {
    const estimation::Channel& channel = levels.data().channels()[c];
    result.floor_by_signal[channel.name] = channel.noise;
    floors.push_back(channel.noise);
    const auto rows = fit.innovations.segment(channel.begin, channel.count);
    result.residual_by_signal[channel.name] =
        std::sqrt(rows.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, channel.count)));
    floor += std::pow(channel.noise / std::max(channel.spread, 1e-300), 2);
  }
  result.noise_floor = std::sqrt(floor / static_cast<double>(floors.size()));
  result.at_noise_floor = IsExact(fit);
  if (const Result<Eigen::VectorXd> nominal = problem.PredictPlan(begun); nominal.ok())
    result.where = Localise(problem, problem.measured() - *nominal, floors);
  for (std::size_t i = 0; i < hypothesis.z.size(); ++i) {
    const identification::Nuisance& nuisance = problem.nuisances()[i];
    if (hypothesis.z[i] == 0.0) continue;
    const auto value = identification::ValueOf(nuisance, hypothesis.z[i], problem.plan());
    result.refitted.push_back({nuisance.path, value.nominal, value.value, hypothesis.z[i], nuisance.start});
  }
  for (std::size_t i = 1; i < contest.contestants.size(); ++i) {
    const Contestant& one = contest.contestants[i];
    const bool named = std::ranges::find(settled.causes, i) != settled.causes.end();
    result.considered.push_back({one.effect().info().name, one.place().ToString(), named ? "" : OutcomeOf(settled, one),
                                 NrmseOf(one, levels, level)});
  }
  identification::Estimate reported;
  reported.hypothesis = hypothesis;
  if (result.effects.empty() && hypothesis.effects.empty()) return {};
  const Result<std::string> file = WriteExtended(problem, reported, result, options);
  if (!file.ok()) return file.failure();
  result.extended_scenario = *file;
  return {};
}

}  // namespace

Result<Diagnosis> DiagnoseCorrected(const Plan& plan, const std::vector<MappedRecord>& data,
                                    const std::vector<MappedRecord>& holdout, const Registry& registry,
                                    const DiagnoseOptions& options) {
  Diagnosis result;
  result.own_holdout = !holdout.empty();
  if (holdout.empty()) result.notes.push_back("the last 30 % of the data are the hold-out");
  options.progress("levels", 0.0);
  identification::SearchContext context;
  context.released = true;  // what was let go is told
  const EstimationProblem problem(plan, data, registry, holdout.empty() ? kTrainingShare : 1.0, std::move(context));
  const Result<Plan> started = identification::FitStarts(problem, plan);
  const Plan begun = started.ok() ? *started : plan;
  const Result<Parts> parts = Split(begun, data, holdout, registry);
  if (!parts.ok()) return parts.failure();
  const Levels& levels = *parts->training;
  const Magnitudes magnitudes = MagnitudesOf(problem);
  HeldOut given;
  for (std::size_t level = 0; level < levels.size(); ++level)
    given.push_back(LogExcessAt(holdout.empty() ? begun : plan, *parts->held_out, level));
  std::vector<std::vector<HeldOut>> passes;
  int asked = 0;
  const auto ask = [&](Contestant null, bool released, const std::string& stage) -> Result<Answer> {
    const double from = 1.0 - std::pow(0.5, asked++);
    if (!null.Holds(levels.free_run()) || !IsExact(null.levels[levels.free_run()])) {
      if (LeavesNoise(problem, null, levels)) CountAsNoise(null, {&null, 1});
    }
    Result<Contest> contest = Compete(std::move(null), released, levels, magnitudes, registry, [&](double share) {
      options.progress(stage, from + 0.5 * (1.0 - from) * share);
    });
    if (!contest.ok()) return contest.failure();
    if (!ExactLevel(*contest, levels)) {
      const Contestant* best = LeaderAt(contest->contestants, levels, levels.free_run());
      if (best != nullptr && LeavesNoise(problem, *best, levels)) CountAsNoise(*best, contest->contestants);
    }
    passes.push_back(HeldOutOf(*contest, *parts->held_out, given, !holdout.empty()));
    Settled settled = Settle(*contest, levels, passes.back(), LeastOf(passes, levels.size()));
    result.journal.insert(result.journal.end(), settled.journal.begin(), settled.journal.end());
    JournalEntry looked{"first look",
                        {},
                        "share of what the null leaves, " + stage,
                        {},
                        fmt::format("{} are carried", contest->contestants.size() - 1)};
    for (const auto* some : {&contest->contestants, &contest->left_behind}) {
      for (const Contestant& one : *some) {
        if (one.share > 0.0) looked.numbers.emplace_back(one.Name(), one.share);
      }
    }
    result.journal.push_back(std::move(looked));
    JournalEntry cost{"simulations", {}, stage, {}, ""};
    for (const Contest::Cost& one : contest->cost)
      cost.numbers.emplace_back(one.stage, static_cast<double>(one.simulations));
    result.journal.push_back(std::move(cost));
    return Answer{*std::move(contest), std::move(settled)};
  };
  // Once more with the cause in the model, for there may be several.
  const auto extend = [&](Result<Answer>& answer) {
    for (int causes = 1; causes < kMostCauses && !answer->settled.exact; ++causes) {
      const Settled& settled = answer->settled;
      const bool most = settled.best && settled.best_explains >= policy::kHeldOutReleased;
      const std::optional<std::size_t> leader = !settled.causes.empty() ? std::optional(settled.causes.front())
                                                : most                  ? settled.best
                                                                        : std::nullopt;
      if (!leader) return;
      if (!answer->contest.released && !NearEnough(answer->contest.contestants[*leader])) return;
      const Contestant& null = answer->contest.contestants[*leader];
      Result<Answer> next = ask(null, answer->contest.released, "with " + null.Name());
      if (!next.ok() || !Adds(*answer, *next)) return;
      answer = std::move(next);
    }
  };
  Result<Answer> answer =
      ask(NullOf(begun, false, levels, registry), false, "candidates, nominal values on their priors");
  if (!answer.ok()) return answer.failure();
  Result<Answer> first = answer;
  extend(first);
  if (first->settled.exact) answer = first;
  // A model that was fitted naively has swallowed its missing effect, and gives it back only when it is let go.
  if (!answer->settled.exact) {
    Result<Answer> released = ask(NullOf(begun, true, levels, registry), true, "candidates, nominal values released");
    if (released.ok()) {
      if (!released->settled.exact)
        answer->settled = Settle(answer->contest, levels, passes[0], LeastOf(passes, levels.size()));
      if (released->settled.exact || answer->settled.causes.empty()) {
        answer = std::move(released);
        extend(answer);
      } else {
        answer = std::move(first);
      }
    }
  }
  const Settled& settled = answer->settled;
  result.verdict = settled.verdict;
  result.reason = settled.reason;
  if (Status failed = Describe(*parts, answer->contest, settled, problem, begun, data, holdout, options, result))
    return *failed;
  result.simulations = static_cast<double>(levels.simulations() + parts->held_out->simulations());
  result.journal.push_back({"verdict", {}, settled.rule, {}, ToString(result.verdict) + ": " + result.reason});
  return result;
}

}  // namespace dynoproof::diagnosis
