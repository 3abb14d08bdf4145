#include "experiment/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "experiment/golden.h"
#include "score/tube.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The [[check]] tables of one kind.
std::vector<const Value*> ChecksOf(const Plan& plan, std::string_view kind) {
  std::vector<const Value*> found;
  const Value* checks = plan.root.Find("check");
  if (checks == nullptr || !checks->is_array()) return found;
  for (const Value& check : checks->array()) {
    if (check.TextOr("kind") == kind) found.push_back(&check);
  }
  return found;
}

/// The golden trace and its tolerances, where the scenario is compared with one.
struct Golden {
  trace::Trace trace;
  std::map<std::string, GoldenTolerances::OfSignal> tolerances;

  GoldenTolerances::OfSignal Of(const std::string& signal) const {
    const auto found = tolerances.find(signal);
    return found == tolerances.end() ? GoldenTolerances::OfSignal{} : found->second;
  }
};
std::optional<Golden> ReadGolden(const Prepared& prepared) {
  if (ChecksOf(prepared.plan, "golden").empty()) return std::nullopt;
  Result<trace::Trace> trace = trace::ReadTrace(prepared.golden.trace);
  Result<GoldenTolerances> tolerances = ReadTolerances(prepared.golden.tolerances);
  if (!trace.ok() || !tolerances.ok()) return std::nullopt;
  return Golden{std::move(*trace), tolerances->For(prepared.rig->run.solver)};
}

std::vector<double> ToVector(std::span<const double> values) { return {values.begin(), values.end()}; }

bool IsConstant(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [&values](double value) { return value == values.front(); });
}

/// "notch" of "notch_2": signals that are numbered belong together.
std::string Family(const std::string& name) {
  const std::size_t end = name.find_last_not_of("0123456789");
  if (end == std::string::npos || end + 1 == name.size() || name[end] != '_') return name;
  return name.substr(0, end);
}

Curve::Style StyleOf(const trace::Signal& signal) {
  return signal.interpolation == trace::Interpolation::kHold ? Curve::Style::kHold : Curve::Style::kLine;
}

std::string Constant(const std::string& name, double value, const std::string& unit) {
  return fmt::format("{} = {:.6g}{}{}", name, value, unit == "1" ? "" : " ", unit == "1" ? "" : unit);
}

std::string Titled(const std::string& name, const std::string& description) {
  return description.empty() ? name : name + ": " + description;
}

/// The largest |value| of each of at most `most` equal stretches, at its own time: what a distance is judged by.
Curve Envelope(std::string label, std::span<const double> time, const std::vector<double>& values,
               std::size_t most = 1500) {
  Curve curve{std::move(label), {}, {}};
  const std::size_t length = std::max<std::size_t>(1, (values.size() + most - 1) / most);
  for (std::size_t i = 0; i < values.size(); i += length) {
    std::size_t largest = i;
    for (std::size_t k = i; k < std::min(values.size(), i + length); ++k) {
      if (std::abs(values[k]) > std::abs(values[largest])) largest = k;
    }
    curve.x.push_back(time[largest]);
    const double size = std::abs(values[largest]);
    curve.y.push_back(size > 0.0 ? size : kNaN);  // zero has no place on a logarithmic axis
  }
  return curve;
}

/// A comparison that did not pass, close up: both curves with the tube between which the run should be, and their
/// difference. Both have the times of the reference.
std::vector<Picture> CloseUp(const std::string& title, const std::string& signal, const std::string& unit,
                             const Curve& reference, const Curve& run, double half_width, double first_s) {
  Picture both{.key = "close_up:" + signal, .title = title, .x = {"time", "s"}, .y = {signal, unit}};
  both.note = "zoomed to the place where the two part; 0 shows the whole run";
  both.course = true;
  const double span = run.x.back() - run.x.front();
  both.x.from = std::max(run.x.front(), first_s - 0.01 * span);
  both.x.to = std::min(run.x.back(), first_s + 0.02 * span);
  both.marks.push_back({first_s, "first apart"});
  Picture residual = both;
  residual.key = "residual:" + signal;
  residual.title = fmt::format("{}: {} minus {}", signal, run.label, reference.label);
  residual.y.label = "difference of " + signal;
  residual.marks.push_back({half_width, "limit", true});
  residual.marks.push_back({-half_width, "", true});

  Area tube{"tube", reference.x, {}};
  for (const double value : reference.y) tube.y.push_back(value + half_width);
  for (std::size_t i = reference.x.size(); i-- > 0;) {
    tube.x.push_back(reference.x[i]);
    tube.y.push_back(reference.y[i] - half_width);
  }
  both.areas.push_back(std::move(tube));
  both.curves = {run, reference};
  Curve difference{"difference", reference.x, {}};
  for (std::size_t i = 0; i < reference.y.size(); ++i) difference.y.push_back(run.y[i] - reference.y[i]);
  residual.curves.push_back(std::move(difference));
  return {std::move(both), std::move(residual)};
}

/// Distances of a run from what it is compared with, each over its limit.
class Comparisons {
 public:
  explicit Comparisons(const Course& course, const Rig& rig) : course_(course), rig_(rig) {
    picture_ = {.key = "distances",
                .title = "Distances over their limits",
                .note =
                    "golden: over the half-width of the tube, which no sample may leave; solvers and oracles: over "
                    "the limit of the RMS",
                .x = {"time", "s"},
                .y = {"distance / limit", "1", true}};
    picture_.course = true;
    picture_.marks.push_back({1.0, "limit", true});
  }

  void AddGolden(const Golden& golden, const trace::Signal& want) {
    const trace::Signal* have = course_.trace.Find(want.name);
    if (have == nullptr) return;
    const score::Series reference{golden.trace.TimeOf(want), want.values},
        run{course_.trace.TimeOf(*have), have->values,
            have->interpolation == trace::Interpolation::kHold ? score::Interpolation::kHold
                                                               : score::Interpolation::kLinear};
    if (!score::FaultOf(reference, "golden").empty() || !score::FaultOf(run, "run").empty()) return;
    const GoldenTolerances::OfSignal tolerance = golden.Of(want.name);
    const double half_width = tolerance.relative_width * want.nominal;
    const std::vector<double> test = score::SampleAt(run, reference.time_s);
    std::vector<double> ratio(test.size());
    // Distance from the range of the golden values within the tube's half-width in time.
    std::size_t begin = 0, end = 0;
    for (std::size_t i = 0; i < test.size(); ++i) {
      const double t = reference.time_s[i], w = tolerance.time_half_width_s;
      while (reference.time_s[begin] < t - w) ++begin;
      while (end < test.size() && reference.time_s[end] <= t + w) ++end;
      const auto [low, high] = std::minmax_element(reference.values.begin() + static_cast<std::ptrdiff_t>(begin),
                                                   reference.values.begin() + static_cast<std::ptrdiff_t>(end));
      ratio[i] = std::max({0.0, test[i] - *high, *low - test[i]}) / half_width;
    }
    Add("golden " + want.name, reference.time_s, ratio);
    const score::TubeResult tube = score::CompareTube(reference, {reference.time_s, test, run.interpolation},
                                                      {.relative_width = tolerance.relative_width,
                                                       .nominal = want.nominal,
                                                       .time_half_width_s = tolerance.time_half_width_s});
    if (!tube.first) return;
    AddCloseUp(CloseUp(want.name + " leaves the tube around the golden trace", want.name, want.unit,
                       {"golden", ToVector(reference.time_s), ToVector(reference.values), Curve::Style::kDashed},
                       {"run", ToVector(reference.time_s), test}, half_width, tube.first->time_s));
  }

  /// `limit` is that of the RMS over the spread of `reference`; both have the ticks of `time`.
  void AddNrmse(const std::string& kind, const std::string& other, const std::string& signal,
                std::span<const double> time, std::span<const double> reference, std::span<const double> test,
                double limit, bool own_is_reference) {
    const double allowed = limit * score::StandardDeviation(reference);
    if (!(allowed > 0.0)) return;
    std::vector<double> ratio(test.size());
    double square = 0.0;
    std::size_t first = test.size();
    for (std::size_t i = 0; i < test.size(); ++i) {
      ratio[i] = (test[i] - reference[i]) / allowed;
      square += ratio[i] * ratio[i];
      if (first == test.size() && std::abs(ratio[i]) > 1.0) first = i;
    }
    Add(kind + " " + signal, time, ratio);
    if (square <= static_cast<double>(test.size()) || first == test.size()) return;
    const OutputLine& line = rig_.outputs[static_cast<std::size_t>(FindOutput(rig_, signal))];
    Curve a{own_is_reference ? "run" : other, ToVector(time), ToVector(reference), Curve::Style::kDashed},
        b{own_is_reference ? other : "run", ToVector(time), ToVector(test)};
    AddCloseUp(CloseUp(fmt::format("{}: run and {} part", signal, other), signal, line.unit, std::move(a), std::move(b),
                       allowed, time[first]));
  }

  void Finish(RunPictures& pictures) {
    pictures.pictures.insert(pictures.pictures.begin(), std::make_move_iterator(close_ups_.begin()),
                             std::make_move_iterator(close_ups_.end()));
    if (!picture_.curves.empty()) pictures.pictures.push_back(std::move(picture_));
  }

 private:
  void Add(const std::string& label, std::span<const double> time, const std::vector<double>& ratio) {
    picture_.curves.push_back(Envelope(label, time, ratio));
  }

  void AddCloseUp(std::vector<Picture> pictures) {
    std::move(pictures.begin(), pictures.end(), std::back_inserter(close_ups_));
  }

  const Course& course_;
  const Rig& rig_;
  Picture picture_;
  std::vector<Picture> close_ups_;
};

}  // namespace

void AddCourses(const Prepared& prepared, const Course& course, RunPictures& pictures) {
  const Rig& rig = *prepared.rig;
  const trace::Trace& trace = course.trace;
  const std::optional<Golden> golden = ReadGolden(prepared);
  const auto curve = [&trace](const trace::Signal& signal, std::string label) {
    return Curve{std::move(label), ToVector(trace.TimeOf(signal)), signal.values, StyleOf(signal)};
  };
  const auto open = [](std::string name, std::string title, std::string unit) {
    Picture picture{.key = "time:" + name, .title = std::move(title), .x = {"time", "s"}, .y = {name, std::move(unit)}};
    picture.course = true;
    return picture;
  };

  // Outputs, each with its variants, its set point and the golden samples; numbered ones without variants together.
  std::map<std::string, std::size_t> families;
  std::vector<Picture> outputs;
  for (const OutputLine& line : rig.outputs) {
    const trace::Signal& signal = *trace.Find(line.name);
    if (prepared.variants.empty() && IsConstant(signal.values)) {
      pictures.constant.push_back(Constant(line.name, signal.values.front(), line.unit));
      continue;
    }
    const std::string family = Family(line.name) + " " + line.unit;
    if (prepared.variants.empty() && families.contains(family)) {
      Picture& picture = outputs[families[family]];
      picture.title += ", " + Titled(line.name, line.description);
      picture.y.label = Family(line.name);
      picture.curves.push_back(curve(signal, line.name));
      continue;
    }
    families[family] = outputs.size();
    Picture picture = open(line.name, Titled(line.name, line.description), line.unit);
    picture.curves.push_back(curve(signal, line.name));
    for (const Prepared::Variant& variant : prepared.variants) {
      const trace::Signal* other = trace.Find(line.name + "_" + variant.name);
      if (other == nullptr) continue;
      if (other->values == signal.values) {
        picture.curves.front().label = variant.name;
        continue;
      }
      picture.curves.push_back(curve(*other, variant.name));
      // Three of them are told apart at a glance, and the relative of the scenario's own law.
      picture.curves.back().shown =
          picture.curves.size() <= 3 || variant.name.find(picture.curves.front().label) != std::string::npos;
    }
    for (const Value* check : ChecksOf(prepared.plan, "follows")) {
      const trace::Signal* wanted = trace.Find(check->TextOr("reference"));
      if (check->TextOr("signal") != line.name || wanted == nullptr) continue;
      picture.curves.push_back(curve(*wanted, wanted->name));
      picture.curves.back().style = Curve::Style::kDashed;
    }
    if (const trace::Signal* kept = golden ? golden->trace.Find(line.name) : nullptr; kept != nullptr) {
      picture.curves.push_back({"golden", ToVector(golden->trace.TimeOf(*kept)), kept->values, Curve::Style::kSamples});
    }
    outputs.push_back(std::move(picture));
  }

  // Inputs of one unit together.
  std::map<std::string, std::size_t> units;
  std::vector<Picture> inputs;
  for (const InputLine& line : rig.inputs) {
    const trace::Signal& signal = *trace.Find(line.name);
    if (IsConstant(signal.values)) {
      pictures.constant.push_back(Constant(line.name, signal.values.front(), line.unit));
      continue;
    }
    if (units.contains(line.unit)) {
      Picture& picture = inputs[units[line.unit]];
      picture.title += ", " + Titled(line.name, line.description);
      picture.y.label = "inputs";
      picture.curves.push_back(curve(signal, line.name));
      continue;
    }
    units[line.unit] = inputs.size();
    Picture picture = open(line.name, Titled(line.name, line.description), line.unit);
    picture.curves.push_back(curve(signal, line.name));
    inputs.push_back(std::move(picture));
  }
  // What [analysis] looks at comes first.
  if (const Value* first = prepared.plan.root.FindPath("analysis.output"); first != nullptr && first->is_string()) {
    std::stable_partition(outputs.begin(), outputs.end(),
                          [&](const Picture& picture) { return picture.y.label == first->string(); });
  }
  std::move(outputs.begin(), outputs.end(), std::back_inserter(pictures.pictures));
  std::move(inputs.begin(), inputs.end(), std::back_inserter(pictures.pictures));
}

void AddComparisons(const Prepared& prepared, const Course& course, CheckContext& context, RunPictures& pictures) {
  Comparisons comparisons(course, *prepared.rig);
  if (const std::optional<Golden> golden = ReadGolden(prepared)) {
    for (const trace::Signal& signal : golden->trace.signals) {
      // Hull curves follow from the signal they belong to.
      if (FindOutput(*prepared.rig, signal.name) >= 0) comparisons.AddGolden(*golden, signal);
    }
  }
  const std::vector<double>& time = course.samples.time;
  const auto own = [&](const std::string& signal) -> const std::vector<double>& {
    return course.samples.outputs[static_cast<std::size_t>(FindOutput(*prepared.rig, signal))];
  };
  const auto limit = [](const Value& check) {
    const Value* value = check.Find("nrmse");
    return value != nullptr && value->is_number() ? value->number() : kNaN;
  };
  if (const Samples* other = context.OtherIfMade()) {
    const bool own_is_reference = context.solver() == "reference";
    for (const Value* check : ChecksOf(prepared.plan, "solvers")) {
      const std::string signal = check->TextOr("signal");
      const std::vector<double>& others = other->outputs[static_cast<std::size_t>(FindOutput(*prepared.rig, signal))];
      if (others.size() != time.size()) continue;
      comparisons.AddNrmse("solvers", own_is_reference ? "realtime" : "reference", signal, time,
                           own_is_reference ? own(signal) : others, own_is_reference ? others : own(signal),
                           limit(*check), own_is_reference);
    }
  }
  for (const Value* check : ChecksOf(prepared.plan, "oracle")) {
    const std::string signal = check->TextOr("signal");
    const Result<std::vector<double>> answer = context.Oracle(check->TextOr("oracle"), signal);  // known by now
    if (!answer.ok() || answer->size() != time.size()) continue;
    const Value* until = check->Find("until_s");
    std::size_t rows = time.size();
    if (until != nullptr && until->is_number() && until->number() > 0.0) {
      rows = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), until->number()) - time.begin());
    }
    comparisons.AddNrmse("oracle", check->TextOr("oracle"), signal, std::span(time).first(rows),
                         std::span(*answer).first(rows), std::span(own(signal)).first(rows), limit(*check), false);
  }
  comparisons.Finish(pictures);
}

void AddTiming(const Course& course, RunPictures& pictures) {
  Curve counts;
  counts.label = "periods";
  counts.style = Curve::Style::kHold;
  const auto& bins = course.times.counts;
  const auto bin_us = [](int bin) {
    return 1e6 * StepTimes::kLeast_s * std::pow(10.0, static_cast<double>(bin) / StepTimes::kBinsPerDecade);
  };
  int first = StepTimes::kBins, last = -1;
  for (int i = 0; i < StepTimes::kBins; ++i) {
    if (bins[i] == 0) continue;
    first = std::min(first, i);
    last = i;
  }
  if (last < 0) return;
  for (int i = std::max(0, first - 1); i <= last + 1; ++i) {
    counts.x.push_back(bin_us(i));
    counts.y.push_back(i < StepTimes::kBins ? static_cast<double>(bins[i]) : 0.0);
  }
  Picture picture{.key = "timing",
                  .title = "Time of a period",
                  .note =
                      "on the machine of this run, with whatever else it was doing: a look, no verdict; `dynoproof "
                      "bench` judges",
                  .x = {"time of a period", "us", true},
                  .y = {"periods", "1"}};
  picture.curves.push_back(std::move(counts));
  pictures.pictures.push_back(std::move(picture));
}

namespace {

std::vector<PictureMaker>& PictureMakers() {
  static std::vector<PictureMaker> makers;
  return makers;
}

}  // namespace

void AddPictureMaker(PictureMaker maker) {
  std::vector<PictureMaker>& makers = PictureMakers();
  if (std::find(makers.begin(), makers.end(), maker) == makers.end()) makers.push_back(maker);
}

RunPictures PicturesOf(const Prepared& prepared, const Course& course, CheckContext* context) {
  RunPictures pictures;
  AddCourses(prepared, course, pictures);
  if (context != nullptr) AddComparisons(prepared, course, *context, pictures);
  AddPhasePlanes(prepared, course, pictures);
  AddSpectra(prepared, course, pictures);
  AddResponses(prepared, course, pictures);
  for (const PictureMaker maker : PictureMakers()) maker(prepared, course, pictures);
  AddTiming(course, pictures);
  return pictures;
}

Result<RunPictures> PicturesOf(const Prepared& prepared, const Progress& progress) {
  const Result<Course> course = Play(prepared, progress);
  if (!course.ok()) return course.failure();
  return PicturesOf(prepared, *course, nullptr);
}

}  // namespace dynoproof
