#include "probe/probe.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <tuple>

#include "base/parallel.h"
#include "base/within.h"
#include "experiment/run_scenario.h"
#include "score/share.h"

namespace dynoproof::probe {
namespace {

constexpr double kClose = 1.1;     // the largest that passed and the least that failed are no further apart
constexpr double kBeyond = 1.04;   // two looks that far on both sides of the limit close the bracket
constexpr double kFlat = 1.05;     // a share that a mutation has not raised by that much says nothing of its slope
constexpr double kStride = 100.0;  // no step is larger: few effects are linear over more
constexpr double kNoTrace = 1e-6;  // of an output's spread: what moves none by more at its usual strength is nowhere
constexpr double kStill = 1e-3;    // of its nominal: an output that spreads less stands still
constexpr int kFewLines = 3;       // what closes within these grows with its size
constexpr int kMostLines = 6;      // steps by a line that has not closed the bracket by then is none
constexpr int kMostRuns = 30;      // of one mutation: bisection alone needs 20 over six decades

/// What one run says.
struct Sight {
  bool refused = false, seen = false;
  double share = 0.0;  // of a limit, the largest; above 1 where it is seen, infinite where no number says how far
  std::string by;
  double moves = 0.0;                   // against the scenario as it is
  std::map<std::string, double> reach;  // the same by output: largest distance over its nominal
};

/// Makes runs of changed plans and looks at them with the checks that take part.
class Eye {
 public:
  static Result<Eye> Open(const Prepared& prepared, const Options& options) {
    Eye eye(prepared);
    for (const auto& check : prepared.checks) {
      const CheckKind* kind = prepared.registry->FindCheck(check->kind);
      if (kind != nullptr && kind->follows_plan && eye.without_.insert(check->kind).second)
        eye.skipped_.push_back(fmt::format("{} (its reference comes from the same plan)", check->kind));
    }
    for (const std::string& kind : options.without) {
      if (eye.without_.insert(kind).second) eye.skipped_.push_back(kind + " (--without)");
    }
    const Result<Sight> own = eye.Look(prepared.plan);
    if (!own.ok()) return own.failure();
    if (own->seen)
      return Failure{.message = fmt::format("does not pass as it is ({}): there is no sound run to change", own->by),
                     .signal = prepared.plan.id,
                     .exit_code = 1};
    if (eye.asked_.empty())
      return Failure{
          .message = fmt::format("no check takes part{}: state one against what does not follow the plan, as a golden "
                                 "trace (dynoproof bless), bounds, a peak's frequency, or a [record]",
                                 eye.skipped_.empty() ? "" : fmt::format(", not {}", fmt::join(eye.skipped_, ", "))),
          .signal = prepared.plan.id,
          .exit_code = 1};
    eye.base_ = own->share;
    return eye;
  }

  /// A failure is a scenario that breaks as it is; a changed one that breaks is seen.
  Result<Sight> Look(Plan plan) {
    Sight sight;
    Diagnostics refused;
    const std::unique_ptr<Prepared> changed = PrepareLike(prepared_, std::move(plan), refused);
    if (changed == nullptr) {
      sight.refused = true;
      return sight;
    }
    std::erase_if(changed->checks, [&](const auto& check) { return without_.contains(check->kind); });
    const bool first = own_.time.empty();
    RunOptions options;
    options.out = "";
    options.seen = [&](const Course& course, const ScenarioResult&) {
      if (first) {
        own_ = course.samples;
        magnitudes_ = MagnitudesOf(*prepared_.rig, own_);
      } else {
        sight.moves = DistanceTo(course.samples);
        sight.reach = ReachOf(course.samples);
      }
    };
    const ScenarioResult result = RunScenario(*changed, options);
    if (result.verdict == score::Verdict::kBroken && !result.broken.empty()) {
      if (first) return Failure{result.broken, prepared_.plan.id, {}, result.exit_code};
      sight.seen = true;
      sight.share = std::numeric_limits<double>::infinity();
      sight.by = "the run breaks";
      return sight;
    }
    for (const score::Check& check : result.checks) {
      // Counters say what an integrator cost. They change with any number and with the compiler, and do not judge the model.
      const bool of_records = check.stated.empty();
      if (check.kind == "counters" || without_.contains(of_records ? std::string("record") : check.stated)) continue;
      if (first) asked_.push_back(check.name);
      const double share = score::ShareOfLimit(check);
      const bool fails = check.verdict != score::Verdict::kPass;
      const double counted = !fails                                        ? (Within(share, 1.0) ? share : 0.0)
                             : std::isfinite(share) && Reaches(share, 1.0) ? share
                                                                           : std::numeric_limits<double>::infinity();
      sight.seen = sight.seen || fails;
      if (sight.by.empty() || counted > sight.share) {
        sight.share = counted;
        sight.by = check.name;
      }
    }
    return sight;
  }

  /// By output, the largest distance of the other solver's run over the nominal; empty where it cannot be built or breaks.
  std::map<std::string, double> OtherSolver() const {
    Plan plan = prepared_.plan;
    plan.root["run"]["solver"] = Value(prepared_.rig->run.solver == "reference" ? "realtime" : "reference");
    Diagnostics refused;
    const std::unique_ptr<Prepared> other = PrepareLike(prepared_, std::move(plan), refused);
    if (other == nullptr) return {};
    const Result<Course> course = Play(*other);
    return course.ok() ? ReachOf(course->samples) : std::map<std::string, double>();
  }

  double base() const { return base_; }
  const Magnitudes& magnitudes() const { return magnitudes_; }
  const std::vector<std::string>& asked() const { return asked_; }
  const std::vector<std::string>& skipped() const { return skipped_; }

 private:
  explicit Eye(const Prepared& prepared) : prepared_(prepared) {}

  /// The largest distance of an output, RMS over its own spread; of an output that stands still over a part of its nominal.
  double DistanceTo(const Samples& other) const {
    double most = 0.0;
    for (std::size_t i = 0; i < own_.outputs.size(); ++i) {
      const std::vector<double>&own = own_.outputs[i], &its = other.outputs[i];
      if (its.size() != own.size()) return std::numeric_limits<double>::infinity();
      double sum = 0.0;
      for (std::size_t k = 0; k < own.size(); ++k) sum += (its[k] - own[k]) * (its[k] - own[k]);
      const OutputLine& line = prepared_.rig->outputs[i];
      const double spread = std::max(magnitudes_.output_spread.at(line.name), kStill * line.nominal);
      most = std::max(most, std::sqrt(sum / static_cast<double>(own.size())) / spread);
    }
    return most;
  }

  std::map<std::string, double> ReachOf(const Samples& other) const {
    std::map<std::string, double> reach;
    for (std::size_t i = 0; i < own_.outputs.size(); ++i) {
      const std::vector<double>&own = own_.outputs[i], &its = other.outputs[i];
      const OutputLine& line = prepared_.rig->outputs[i];
      if (its.size() != own.size() || line.nominal == 0.0) continue;
      double most = 0.0;
      for (std::size_t k = 0; k < own.size(); ++k) most = std::max(most, std::abs(its[k] - own[k]));
      reach[line.name] = most / line.nominal;
    }
    return reach;
  }

  const Prepared& prepared_;
  std::set<std::string> without_;
  std::vector<std::string> asked_, skipped_;
  Samples own_;
  Magnitudes magnitudes_;
  double base_ = 0.0;
};

/// The search for the size from which a mutation is seen.
class Search {
 public:
  Search(Eye& eye, const Plan& plan, const Mutation& mutation, const Options& options)
      : eye_(eye), plan_(plan), mutation_(mutation) {
    // A limit has a logarithm for a size: where it is neutral nothing happens, where it starts it bites.
    lower_ = mutation.falling ? 1e-3 : options.least_usual;
    upper_ = mutation.falling ? mutation.largest : std::min(mutation.largest, options.most_usual);
  }

  Finding Run() {
    Finding finding{.name = mutation_.name,
                    .place = mutation_.place,
                    .unit = mutation_.unit,
                    .sign = mutation_.sign,
                    .sized = mutation_.sized(),
                    .falling = mutation_.falling,
                    .usual = mutation_.usual};
    if (mutation_.sized()) {
      Bracket(std::clamp(1.0, lower_, upper_));
      LookBelow();
    } else {
      At(1.0);
    }
    finding.runs = runs_;
    finding.reach = reach_;
    finding.by = seen_.by;
    finding.moves = unseen_.moves;
    const bool any = unseen_size_ > 0.0 || seen_size_ > 0.0;
    finding.state = !any                             ? State::kRefused
                    : seen_size_ > 0.0               ? State::kSeen
                    : Within(usual_moves_, kNoTrace) ? State::kNoTrace
                                                     : State::kUnseen;
    finding.size = seen_size_ <= 0.0     ? unseen_size_
                   : unseen_size_ <= 0.0 ? seen_size_
                                         : std::sqrt(unseen_size_ * seen_size_);
    finding.at_once = seen_size_ > 0.0 && unseen_size_ <= 0.0;
    finding.strength = mutation_.sized() ? mutation_.StrengthAt(finding.size) : 0.0;
    finding.parameters = mutation_.parameters(finding.size);
    return finding;
  }

 private:
  /// Looks at a size; false where no such model can be built.
  bool At(double size) {
    Plan plan = plan_;
    mutation_.apply(plan, size);
    ++runs_;
    const Result<Sight> sight = eye_.Look(std::move(plan));
    if (!sight.ok() || sight->refused) return false;
    if (usual_moves_ < 0.0) {  // the first look is at what is usual
      usual_moves_ = sight->moves;
      reach_ = sight->reach;
    }
    if (sight->seen) {
      seen_ = *sight;
      seen_size_ = size;
    } else {
      unseen_ = *sight;
      unseen_size_ = size;
    }
    return true;
  }

  /// A little beyond where the share of the limit would be 1 if it grew in proportion; a stride where it tells no slope.
  static double Proportional(const Sight& sight, double base, double size) {
    const bool tells = std::isfinite(sight.share) && sight.share > kFlat * base;
    const double factor = tells ? kBeyond * std::max(sight.share, 1.0 / sight.share) : std::sqrt(kStride);
    return sight.seen ? size / std::min(factor, kStride) : size * std::min(factor, kStride);
  }

  void Bracket(double size) {
    while (runs_ < kMostRuns) {
      // Beyond what can be built the bound is nearer than the effect says.
      if (!At(size)) {
        if (unseen_size_ <= 0.0 && seen_size_ <= 0.0 && runs_ > 8) return;
        upper_ = size;
        size = unseen_size_ > 0.0 ? std::sqrt(size * unseen_size_) : size / 4.0;
        if (unseen_size_ > 0.0 && Within(upper_, kClose * unseen_size_)) return;
        continue;
      }
      if (seen_size_ > 0.0 && unseen_size_ > 0.0) {
        if (Within(seen_size_, kClose * unseen_size_)) return;
        size = Between();
      } else if (seen_size_ > 0.0) {
        if (seen_size_ <= lower_) return;  // from the least on
        size = std::max(Proportional(seen_, eye_.base(), seen_size_), lower_);
      } else {
        if (unseen_size_ >= upper_) return;  // nowhere
        size = std::min(Proportional(unseen_, eye_.base(), unseen_size_), upper_);
      }
    }
  }

  /// What no line has followed may be seen at less, too, and not in between: play lets go of a load and takes it up again.
  void LookBelow() {
    if (!(seen_size_ > 0.0 && unseen_size_ > 0.0) || lines_ <= kFewLines) return;
    const Sight unseen = unseen_;
    const double unseen_size = unseen_size_;
    for (const double factor : {1.2, 1.5, 2.0, 4.0}) {
      const double size = unseen_size / factor, seen_before = seen_size_;
      if (size < lower_ || runs_ >= kMostRuns || !At(size)) return;
      if (seen_size_ < seen_before) {
        unseen_size_ = 0.0;
        lines_ = 0;
        return Bracket(std::max(lower_, seen_size_ / 2.0));
      }
      unseen_ = unseen;  // the bracket stays
      unseen_size_ = unseen_size;
    }
  }

  /// In a bracket: a little beyond where the line through both, in logarithms, reaches the limit, on the side that is still far;
  /// in the middle where there is no such line or it has not helped.
  double Between() {
    const double low = std::log(unseen_size_), high = std::log(seen_size_);
    const bool tells = std::isfinite(seen_.share) && unseen_.share > kFlat * eye_.base() && unseen_.share > 0.0;
    if (++lines_ > kMostLines || !tells) return std::exp(0.5 * (low + high));
    const double at = low - std::log(unseen_.share) / std::log(seen_.share / unseen_.share) * (high - low);
    const double margin = std::log(kBeyond), edge = 0.05 * (high - low);
    return std::exp(std::clamp(high - at > 2.0 * margin ? at + margin : at - margin, low + edge, high - edge));
  }

  Eye& eye_;
  const Plan& plan_;
  const Mutation& mutation_;
  double lower_ = 0.0, upper_ = 0.0;
  Sight seen_, unseen_;
  double seen_size_ = 0.0, unseen_size_ = 0.0;  // 0: none yet
  double usual_moves_ = -1.0;                   // of an output, at the usual strength
  std::map<std::string, double> reach_;
  int runs_ = 0, lines_ = 0;
};

/// Holes first, those that matter most before; then what is seen, the strongest needed before; what cannot be at the end.
void Sort(std::vector<Finding>& findings) {
  const auto rank = [](const Finding& one) {
    const bool never = one.state == State::kUnseen;
    return std::tuple(!one.IsHole(), one.state == State::kRefused, one.state == State::kNoTrace, !never, -one.size);
  };
  std::ranges::stable_sort(findings, [&](const Finding& a, const Finding& b) { return rank(a) < rank(b); });
}

}  // namespace

std::string_view ToString(State state) {
  constexpr std::string_view kNames[] = {"seen", "unseen", "no_trace", "refused"};
  return kNames[static_cast<int>(state)];
}

bool Finding::IsHole() const { return state == State::kUnseen || (state == State::kSeen && sized && size > 1.0); }

Result<Probed> Probe(const Prepared& prepared, const Options& options) {
  Result<Eye> eye = Eye::Open(prepared, options);
  if (!eye.ok()) return eye.failure();
  std::vector<Mutation> mutations = MutationsOf(prepared.plan, *prepared.registry, eye->magnitudes());
  if (!options.effects.empty())
    std::erase_if(mutations, [&](const Mutation& one) { return std::ranges::count(options.effects, one.name) == 0; });
  Probed probed{eye->asked(), eye->skipped(), std::vector<Finding>(mutations.size()), 1};
  std::mutex one_at_a_time;
  std::size_t done = 0;
  ParallelFor(mutations.size(), options.threads, [&](std::size_t i) {
    const Mutation& mutation = mutations[i];
    const auto known = std::ranges::find_if(options.known, [&](const Finding& one) {
      return one.name == mutation.name && one.place == mutation.place && one.sign == mutation.sign;
    });
    const bool new_one = known == options.known.end();
    probed.findings[i] = new_one ? Search(*eye, prepared.plan, mutation, options).Run() : *known;
    const std::lock_guard lock(one_at_a_time);
    probed.runs += new_one ? probed.findings[i].runs : 0;
    if (options.found) options.found(probed.findings[i], ++done, mutations.size());
  });
  Sort(probed.findings);
  if (std::ranges::any_of(probed.findings, &Finding::IsHole)) probed.apart = eye->OtherSolver();
  return probed;
}

}  // namespace dynoproof::probe
