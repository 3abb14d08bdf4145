#include "experiment/compare_traces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "base/status.h"
#include "base/text.h"
#include "base/units.h"
#include "experiment/thin.h"
#include "experiment/why.h"
#include "score/evidence.h"
#include "score/tube.h"

namespace dynoproof {
namespace {

/// Ends that differ by less than this many steps are the same: one program counts the last sample, another does not.
constexpr double kEndSlack = 1.5;
/// Of what a signal's second differences let the line between its samples be off. Where they are resolved (eight
/// samples a period and more) that is right to a tenth, on the shipped traces to two fifths.
constexpr double kInterpolationRoom = 2.0;
/// Of the reference's span: who shares less with it is no other raster of the same course.
constexpr double kLeastCommon = 0.5;

score::Interpolation ToScore(trace::Interpolation interpolation) {
  return interpolation == trace::Interpolation::kHold ? score::Interpolation::kHold : score::Interpolation::kLinear;
}

bool SameUnit(const std::string& a, const std::string& b) {
  const std::optional<Unit> of_a = ParseUnit(a), of_b = ParseUnit(b);
  if (!of_a || !of_b) return a == b;
  return of_a->exponents == of_b->exponents && of_a->factor == of_b->factor && of_a->offset == of_b->offset;
}

/// `times`, with those that meet a stamp of `grid` but for round-off exactly on it, each row of an instant on one of its
/// own.
std::vector<double> SnappedTo(std::span<const double> grid, std::span<const double> times) {
  std::vector<double> snapped(times.begin(), times.end());
  const double slack = kStampSlack * std::min(score::MedianStep(grid), score::MedianStep(times));
  double before = -std::numeric_limits<double>::infinity();
  for (double& time : snapped) {
    const double next = std::nextafter(before, std::numeric_limits<double>::infinity());
    const auto it = std::lower_bound(grid.begin(), grid.end(), std::max(time - slack, next));
    time = before = it != grid.end() && *it <= time + slack ? *it : std::max(time, next);
  }
  return snapped;
}

std::string Described(const score::Series& series) {
  return fmt::format("{} samples from {:.9g} to {:.9g} s", series.time_s.size(), series.time_s.front(),
                     series.time_s.back());
}

/// The span of time that two courses have in common, with the notes on it.
struct CommonSpan {
  std::vector<double> test_time_s;  // on the reference's stamps where it meets them
  double from_s = 0.0, to_s = 0.0;
  std::string note;   // how their time stamps differ; empty where they do not
  std::string fault;  // why a comparison over it is not enough
};

/// The stamps from `from` to `to`.
std::span<const double> StampsWithin(std::span<const double> times, double from, double to) {
  const auto first = std::lower_bound(times.begin(), times.end(), from);
  return {first, std::upper_bound(first, times.end(), to)};
}

/// Two sound courses over the span that both have; fails where that is nothing.
Result<CommonSpan> InCommon(const score::Series& reference, const score::Series& test) {
  CommonSpan common;
  common.test_time_s = SnappedTo(reference.time_s, test.time_s);
  const std::vector<double>& stamps = common.test_time_s;
  const double first = reference.time_s.front(), last = reference.time_s.back();
  const double from = common.from_s = std::max(first, stamps.front()), to = common.to_s = std::min(last, stamps.back());
  const auto both = [&] {
    return fmt::format("the reference has {}, the run {}", Described(reference), Described(test));
  };
  if (!(to > from)) return Failure{"nothing in common in time: " + both()};
  if (std::ranges::equal(reference.time_s, stamps)) return common;
  common.note = fmt::format("other time stamps, compared from {:.9g} to {:.9g} s: {}", from, to, both());
  // On one raster, what one of the two lacks was cut off; another program's raster may end elsewhere.
  const bool one_raster = std::ranges::equal(StampsWithin(reference.time_s, from, to), StampsWithin(stamps, from, to));
  const double slack = kEndSlack * std::max(score::MedianStep(reference.time_s), score::MedianStep(stamps));
  const bool lacks = to < last - slack || from > first + slack;
  const auto spans = fmt::format("from {:.9g} to {:.9g} s, the reference from {:.9g} to {:.9g} s", stamps.front(),
                                 stamps.back(), first, last);
  if (lacks && (one_raster || to - from < kLeastCommon * (last - first))) {
    common.fault = "the run is short: it goes " + spans;
  } else if (one_raster && (stamps.back() > last + slack || stamps.front() < first - slack)) {
    common.fault = "the run goes on: " + spans;
  }
  return common;
}

/// Least, greatest and mean of a signal by stretch, as a thinned reference holds them.
struct Wanted {
  std::span<const double> ends, least, greatest, mean;
};

/// The stretches that end by `end_s`.
Wanted UpTo(const Wanted& wanted, double end_s) {
  const auto n = static_cast<std::size_t>(std::ranges::upper_bound(wanted.ends, end_s) - wanted.ends.begin());
  return {wanted.ends.first(n), wanted.least.first(n), wanted.greatest.first(n), wanted.mean.first(n)};
}

score::Series UpTo(const score::Series& series, double end_s) {
  const auto n = static_cast<std::size_t>(std::ranges::upper_bound(series.time_s, end_s) - series.time_s.begin());
  return {series.time_s.first(n), series.values.first(n), series.interpolation};
}

/// Nothing where the reference tells nothing.
std::optional<Wanted> StretchesIn(const trace::Trace& reference, const trace::Signal& signal) {
  const auto [least, greatest, mean] = StretchNames(signal.name);
  const trace::Signal* of[] = {reference.Find(least), reference.Find(greatest), reference.Find(mean)};
  for (const trace::Signal* one : of) {
    if (one == nullptr || one->time_base != of[0]->time_base) return std::nullopt;
  }
  return Wanted{reference.TimeOf(*of[0]), of[0]->values, of[1]->values, of[2]->values};
}

/// The stretch in which a run is farthest from the reference.
struct Farthest {
  double distance = 0.0;  // in the unit of the signal
  std::string what;       // which of its values, and what it is instead
};

/// No sample is off by more than the tube allows exactly if no such run has another least, greatest or mean value by
/// more: each of the three moves by no more than the samples. Where the run may be early or late, its extremes stay
/// within those of the stretches around.
Farthest FarthestStretch(const Wanted& wanted, const Stretches& had, double time_half_width_s,
                         const std::string& unit) {
  Farthest farthest;
  const std::span<const double> stamps = wanted.ends;
  const auto take = [&](double distance, std::size_t i, const auto& what, double value, double instead) {
    if (distance <= farthest.distance) return;
    farthest = {distance, fmt::format("from t = {:.6g} to {:.6g} s {} is {:.6g}{}{}, and {:.6g} in the reference",
                                      stamps[i - 1], stamps[i], what(), value, unit.empty() ? "" : " ", unit, instead)};
  };
  const auto at = [](const char* extreme, double time_s) {
    return [extreme, time_s] { return fmt::format("the {} value, at t = {:.6g} s,", extreme, time_s); };
  };
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (time_half_width_s > 0.0) {
      std::size_t from = i, to = i;
      while (from > 0 && stamps[from - 1] > stamps[i - 1] - time_half_width_s) --from;
      while (to + 1 < stamps.size() && stamps[to] < stamps[i] + time_half_width_s) ++to;
      const double low = *std::min_element(wanted.least.begin() + from, wanted.least.begin() + to + 1);
      const double high = *std::max_element(wanted.greatest.begin() + from, wanted.greatest.begin() + to + 1);
      take(low - had.least[i], i, at("least", had.least_s[i]), had.least[i], low);
      take(had.greatest[i] - high, i, at("greatest", had.greatest_s[i]), had.greatest[i], high);
      continue;
    }
    take(std::abs(had.least[i] - wanted.least[i]), i, at("least", had.least_s[i]), had.least[i], wanted.least[i]);
    take(std::abs(had.greatest[i] - wanted.greatest[i]), i, at("greatest", had.greatest_s[i]), had.greatest[i],
         wanted.greatest[i]);
    take(
        std::abs(had.mean[i] - wanted.mean[i]), i, [] { return "the mean"; }, had.mean[i], wanted.mean[i]);
  }
  return farthest;
}

/// The deviation where it takes most of what is allowed, in the unit of the signal: half-widths tell a person nothing.
std::string WorstInItsUnit(const score::TubeResult& result, std::span<const double> wanted, double allowed,
                           const std::string& unit) {
  const auto at = std::find(result.time_s.begin(), result.time_s.end(), result.worst_time_s) - result.time_s.begin();
  const auto i = static_cast<std::size_t>(at);
  if (i >= result.test.size() || i >= wanted.size()) return "";
  const std::string shown = unit.empty() ? "" : " " + unit;
  return fmt::format("{:.3g}{} off at t = {:.6g} s ({:.3g}{} allowed)", std::abs(result.test[i] - wanted[i]), shown,
                     result.worst_time_s, allowed, shown);
}

/// The yardstick of a deviation.
struct Scale {
  double value;
  std::string note;  // where the reference does not state it
};

/// The nominal of a sound reference, or else how far its values range; of one that is constant that value, and of one
/// that is 0 throughout, 1 of its unit: nothing else is known.
Scale ScaleOf(const trace::Signal& signal) {
  if (signal.nominal_known) return {signal.nominal, ""};
  const auto [least, most] = std::minmax_element(signal.values.begin(), signal.values.end());
  const double range = *most - *least, constant = std::abs(*most);
  const double value = range > 0.0 ? range : constant > 0.0 ? constant : 1.0;
  return {value, fmt::format("\"{}\" has no nominal in the reference: {:.4g}{}{} is taken, {}", signal.name, value,
                             signal.unit.empty() ? "" : " ", signal.unit,
                             range > 0.0      ? "how far its values range"
                             : constant > 0.0 ? "its constant value"
                                              : "1 of its unit, since it is 0 throughout")};
}

void Note(const std::string& note, std::vector<std::string>* notes) {
  if (notes != nullptr && std::find(notes->begin(), notes->end(), note) == notes->end()) notes->push_back(note);
}

/// One signal that both traces have, in one unit.
class SignalComparison {
 public:
  SignalComparison(const trace::Signal& signal, std::string name, std::string kind, const SignalTolerance& tolerance)
      : signal_(signal),
        scale_(ScaleOf(signal)),
        name_(std::move(name)),
        kind_(std::move(kind)),
        tolerance_(tolerance) {
    options_.relative_width = tolerance.relative_width;
    options_.nominal = scale_.value;
    options_.time_half_width_s = tolerance.time_half_width_s;
  }

  score::Check Whole(const score::Series& reference, const score::Series& test, std::vector<std::string>* notes) const {
    const Result<CommonSpan> common = InCommon(reference, test);
    if (!common.ok()) return NotCompared(name_, kind_, common.failure().message);
    score::TubeOptions options = options_;
    // An adaptive step may be as long as it likes: the reference's samples within it are held against the line.
    options.max_gap_s = common->to_s - common->from_s;
    options.interpolation_room = kInterpolationRoom;
    options.from_s = common->from_s;
    options.to_s = common->to_s;
    score::Check check = Judge(reference, {common->test_time_s, test.values, test.interpolation}, options);
    if (!common->note.empty()) {
      Note(common->note, notes);
      check.explanation += (check.explanation.empty() ? "" : "; ") + common->note;
    }
    return common->fault.empty() ? check : InPart(common->fault, check);
  }

  const std::string& scale_note() const { return scale_.note; }

  /// A run that ends earlier or later is compared over what both have, and fails all the same.
  score::Check Thinned(const score::Series& reference, const std::optional<Wanted>& wanted,
                       const score::Series& test) const {
    const std::span<const double> raster = wanted ? wanted->ends : reference.time_s;
    const double slack = 0.5 * score::MedianStep(test.time_s), last = raster.back(), end = test.time_s.back();
    const auto after = std::ranges::upper_bound(raster, std::min(last, end) + slack);
    if (std::abs(end - last) <= slack || after == raster.begin()) return OfOneLength(reference, wanted, test);
    const double common = *std::prev(after) + slack;
    return InPart(fmt::format("the run {}: it ends at {:.9g} s, the reference at {:.9g} s",
                              end < last ? "is short" : "goes on", end, last),
                  OfOneLength(UpTo(reference, common), wanted ? std::optional(UpTo(*wanted, common)) : std::nullopt,
                              UpTo(test, common)));
  }

 private:
  /// What fails since only a part was compared; `of_part` says how that part is.
  score::Check InPart(const std::string& fault, const score::Check& of_part) const {
    score::Check failed = of_part.verdict == score::Verdict::kPass ? NotCompared(name_, kind_, "") : of_part;
    failed.explanation =
        fault + "; " +
        (of_part.verdict == score::Verdict::kPass ? "what both have is within the tube" : of_part.explanation);
    failed.evidence = of_part.evidence;
    return failed;
  }

  score::Check OfOneLength(const score::Series& reference, const std::optional<Wanted>& wanted,
                           const score::Series& test) const {
    const std::optional<std::vector<double>> samples = SamplesAt(reference.time_s, test.time_s, test.values);
    const std::optional<Stretches> had =
        wanted ? StretchesOf(wanted->ends, test.time_s, test.values) : std::optional<Stretches>();
    if (!samples || (wanted && !had)) {
      return NotCompared(name_, kind_,
                         fmt::format("other time stamps: the reference has {}, thinned out, the run {}",
                                     Described(reference), Described(test)));
    }
    if (!wanted && samples->size() < test.values.size()) {
      return NotCompared(name_, kind_,
                         fmt::format("the reference keeps {} of {} samples, and nothing of what lies between: an "
                                     "earlier version blessed it; bless the scenario anew",
                                     samples->size(), test.values.size()));
    }
    score::Check check = Judge(reference, {reference.time_s, *samples, reference.interpolation}, options_, &test);
    if (had) JudgeBetween(FarthestStretch(*wanted, *had, options_.time_half_width_s, signal_.unit), check);
    return check;
  }

  /// The tube. Where it fails, `all` samples of a test that was judged at some of them tell why: they show a delay that
  /// is shorter than a step of the reference.
  score::Check Judge(const score::Series& reference, const score::Series& test, const score::TubeOptions& options,
                     const score::Series* all = nullptr) const {
    const score::TubeResult result = score::CompareTube(reference, test, options);
    score::Check check = score::TubeCheck(result, name_, tolerance_.origin);
    check.kind = kind_ == "golden" ? "tube" : kind_;
    check.evidence = score::TubeEvidence({signal_.name, signal_.unit, kind_, "run"}, reference, result, options);
    if (check.verdict == score::Verdict::kPass || !result.first) return check;
    const std::vector<double> everywhere = score::SampleAt(reference, result.time_s);
    const score::Series wanted{result.time_s, everywhere, reference.interpolation};
    const score::Series had{result.time_s, result.test, reference.interpolation};
    const double threshold = options.relative_width * options.nominal;
    check.shown = WorstInItsUnit(result, everywhere, threshold, signal_.unit);
    Why(wanted, all != nullptr ? *all : had, threshold, signal_.unit, result.first->time_s).To(check);
    check.explanation += fmt::format("; allowed: {:.3g}{}{}", threshold, signal_.unit.empty() ? "" : " ", signal_.unit);
    if (options.time_half_width_s > 0.0) check.explanation += fmt::format(", {:.3g} s", options.time_half_width_s);
    return check;
  }

  /// Where a run is out of the tube between the samples of a thinned reference, the check fails by that.
  void JudgeBetween(const Farthest& between, score::Check& check) const {
    const double allowed = options_.relative_width * options_.nominal, ratio = between.distance / allowed;
    if (ratio <= 1.0) return;
    check.verdict = score::Verdict::kFail;
    if (ratio < check.value) return;  // the kept samples tell of a worse place
    check.explanation = check.explanation.empty() ? fmt::format("{}; allowed: {:.3g}{}{}", between.what, allowed,
                                                                signal_.unit.empty() ? "" : " ", signal_.unit)
                                                  : between.what + "; " + check.explanation;
    check.value = ratio;
    check.shown = fmt::format("{:.3g}{}{} off between two kept samples ({:.3g} allowed)", between.distance,
                              signal_.unit.empty() ? "" : " ", signal_.unit, allowed);
  }

  const trace::Signal& signal_;
  Scale scale_;
  std::string name_, kind_;
  const SignalTolerance& tolerance_;
  score::TubeOptions options_;
};

/// The signal that a tolerance was meant for: one of a similar name, one whose name begins it or which it begins, or
/// the only one that has no tolerance.
std::optional<std::string> Meant(const std::string& name, const std::vector<std::string>& signals,
                                 const SignalTolerances& tolerances) {
  std::vector<std::string> free;
  std::copy_if(signals.begin(), signals.end(), std::back_inserter(free),
               [&](const std::string& signal) { return !tolerances.contains(signal); });
  if (const auto near = Closest(name, signals)) return near;
  for (const std::string& signal : free) {
    if (signal.starts_with(name) || name.starts_with(signal)) return signal;
  }
  return free.size() == 1 ? std::optional(free[0]) : std::nullopt;
}

}  // namespace

score::Check NotCompared(const std::string& name, const std::string& kind, std::string why) {
  score::Check check;
  check.name = name;
  check.kind = kind;
  check.value = std::numeric_limits<double>::quiet_NaN();
  check.limit = 1.0;
  check.unit = "1";
  check.origin = "a comparison that does not happen proves nothing";
  check.shown = "not compared";
  check.explanation = std::move(why);
  return check;
}

std::vector<score::Check> CompareTraces(const trace::Trace& reference, const trace::Trace& test,
                                        const SignalTolerances& tolerances, const std::string& kind,
                                        ReferenceIs reference_is, std::vector<std::string>* notes) {
  static const SignalTolerance kDefault;
  std::vector<score::Check> checks;
  for (const trace::Signal& want : reference.signals) {
    if (reference_is == ReferenceIs::kThinned && IsOfStretches(reference, want)) continue;
    const std::string name = kind + " " + want.name;
    const trace::Signal* have = test.Find(want.name);
    if (have == nullptr) {
      checks.push_back(NotCompared(name, kind, fmt::format("the run has no signal \"{}\"", want.name)));
      continue;
    }
    if (!SameUnit(have->unit, want.unit)) {
      checks.push_back(NotCompared(name, kind, fmt::format("unit \"{}\" instead of \"{}\"", have->unit, want.unit)));
      continue;
    }
    // The reference says what the signal does between two samples.
    const score::Series golden{reference.TimeOf(want), want.values, ToScore(want.interpolation)};
    const score::Series run{test.TimeOf(*have), have->values, golden.interpolation};
    std::string fault = score::FaultOf(golden, "reference");
    if (fault.empty()) fault = score::FaultOf(run, "run");
    if (!fault.empty()) {
      checks.push_back(NotCompared(name, kind, fault));
      continue;
    }
    const auto found = tolerances.find(want.name);
    const SignalComparison comparison(want, name, kind, found == tolerances.end() ? kDefault : found->second);
    checks.push_back(reference_is == ReferenceIs::kThinned
                         ? comparison.Thinned(golden, StretchesIn(reference, want), run)
                         : comparison.Whole(golden, run, notes));
    if (const std::string& note = comparison.scale_note(); !note.empty()) {
      Note(note, notes);
      std::string& explanation = checks.back().explanation;
      explanation += (explanation.empty() ? "" : "; ") + note;
    }
  }
  for (const trace::Signal& have : test.signals) {
    if (reference.Find(have.name) != nullptr) continue;
    checks.push_back(
        NotCompared(kind + " " + have.name, kind, fmt::format("the reference has no signal \"{}\"", have.name)));
  }
  return checks;
}

void CheckTolerances(const SignalTolerances& tolerances, const trace::Trace& reference, const trace::Trace& test,
                     Diagnostics& diagnostics) {
  std::vector<std::string> names;
  for (const trace::Trace* trace : {&reference, &test}) {
    for (const trace::Signal& signal : trace->signals) names.push_back(signal.name);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  for (const auto& [name, tolerance] : tolerances) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    const std::optional<std::string> near = Meant(name, names, tolerances);
    diagnostics.Error(
        tolerance.where, fmt::format("there is a tolerance for \"{}\", and neither trace has such a signal", name),
        near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("the traces have {}", fmt::join(names, ", ")));
  }
}

}  // namespace dynoproof
