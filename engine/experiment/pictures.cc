#include "experiment/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <set>

#include "experiment/golden.h"
#include "experiment/pictures_frequency.h"
#include "experiment/pictures_phase_plane.h"
#include "score/evidence.h"

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

/// A comparison that did not pass, close up: both curves with the band between which the run should be, and their
/// difference.
std::vector<Picture> CloseUp(const std::string& title, const score::Evidence& judged) {
  const std::vector<double>& time = judged.time_s;
  const double first_s = time[*judged.first], worst_s = time[judged.worst], span = time.back() - time.front();
  Picture both{.key = "close_up:" + judged.signal,
               .title = title,
               .note = "zoomed to the worst place; 0 shows the whole run",
               .x = {"time", "s"},
               .y = {judged.signal, judged.unit}};
  both.course = true;
  both.x.from = std::max(time.front(), worst_s - 0.03 * span);
  both.x.to = std::min(time.back(), worst_s + 0.03 * span);
  both.marks.push_back({first_s, "first apart"});
  if (worst_s != first_s) both.marks.push_back({worst_s, "worst"});
  Picture residual = both;
  residual.key = "residual:" + judged.signal;
  residual.title = fmt::format("{}: {} minus {}", judged.signal, judged.test_name, judged.reference_name);
  residual.y.label = "difference of " + judged.signal;
  residual.marks.push_back({judged.half_width, "limit", true});
  residual.marks.push_back({-judged.half_width, "", true});

  Area tube{"tube", time, judged.upper};
  tube.x.insert(tube.x.end(), time.rbegin(), time.rend());
  tube.y.insert(tube.y.end(), judged.lower.rbegin(), judged.lower.rend());
  both.areas.push_back(std::move(tube));
  both.curves = {{judged.test_name, time, judged.test},
                 {judged.reference_name, time, judged.reference, Curve::Style::kDashed}};
  Curve difference{"difference", time, {}};
  for (std::size_t i = 0; i < time.size(); ++i) difference.y.push_back(judged.test[i] - judged.reference[i]);
  residual.curves.push_back(std::move(difference));
  return {std::move(both), std::move(residual)};
}

/// The caption of the close-up of a failed comparison.
std::string Parting(const score::Check& check) {
  const score::Evidence& judged = *check.evidence;
  const std::string text =
      IsOfGolden(check) ? judged.signal + " leaves the tube around the golden trace"
      : judged.reference_name == "run"
          ? fmt::format("{}: run and {} part", judged.signal, judged.test_name)
          : fmt::format("{}: {} and {} part", judged.signal, judged.test_name, judged.reference_name);
  return check.cause.empty() ? text : text + ": " + check.cause;
}

}  // namespace

void AddCourses(const Prepared& prepared, const Course& course, std::span<const score::Check> checks,
                RunPictures& pictures) {
  const Rig& rig = *prepared.rig;
  const trace::Trace& trace = course.trace;
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
    for (const score::Check& check : checks) {
      if (check.evidence == nullptr || !IsOfGolden(check) || check.evidence->signal != line.name) continue;
      picture.curves.push_back({"golden", check.evidence->time_s, check.evidence->reference, Curve::Style::kSamples});
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

namespace {

/// Where two courses part, close up, and all distances over their limits.
void AddDistances(std::span<const score::Check> checks, RunPictures& pictures) {
  Picture distances{.key = "distances",
                    .title = "Distances over their limits",
                    .note =
                        "golden and followed courses: over the half-width of the tube, which no sample may leave; "
                        "solvers, oracles and records: over the limit of the RMS",
                    .x = {"time", "s"},
                    .y = {"distance / limit", "1", true}};
  distances.course = true;
  distances.marks.push_back({1.0, "limit", true});
  std::vector<Picture> close_ups;
  for (const score::Check& check : checks) {
    if (check.evidence == nullptr) continue;
    const score::Evidence& judged = *check.evidence;
    Curve distance = Envelope(check.stated + " " + judged.signal, judged.time_s, judged.distance);
    // A run that is its golden trace to the last bit has nothing to draw.
    if (std::any_of(distance.y.begin(), distance.y.end(), [](double y) { return std::isfinite(y); }))
      distances.curves.push_back(std::move(distance));
    if (check.verdict == score::Verdict::kPass || !judged.first) continue;
    for (Picture& picture : CloseUp(Parting(check), judged)) close_ups.push_back(std::move(picture));
  }
  pictures.pictures.insert(pictures.pictures.begin(), std::make_move_iterator(close_ups.begin()),
                           std::make_move_iterator(close_ups.end()));
  if (!distances.curves.empty()) pictures.pictures.push_back(std::move(distances));
}

}  // namespace

void AddComparisons(const Rig& rig, std::span<const score::Check> checks, RunPictures& pictures) {
  std::vector<score::Check> of_outputs;
  // Hull curves, which the golden trace holds besides, follow from the signal they belong to.
  std::ranges::copy_if(checks, std::back_inserter(of_outputs), [&rig](const score::Check& check) {
    return check.evidence != nullptr && FindOutput(rig, check.evidence->signal) >= 0;
  });
  AddDistances(of_outputs, pictures);
}

RunPictures PicturesOfTraces(const trace::Trace& reference, const trace::Trace& test,
                             std::span<const score::Check> checks) {
  RunPictures pictures;
  for (const trace::Signal& wanted : reference.signals) {
    const trace::Signal* seen = test.Find(wanted.name);
    if (seen == nullptr) continue;
    if (IsConstant(wanted.values) && IsConstant(seen->values) && wanted.values.front() == seen->values.front()) {
      pictures.constant.push_back(Constant(wanted.name, wanted.values.front(), wanted.unit));
      continue;
    }
    Picture picture{.key = "time:" + wanted.name,
                    .title = Titled(wanted.name, wanted.description),
                    .x = {"time", "s"},
                    .y = {wanted.name, wanted.unit}};
    picture.course = true;
    picture.curves = {{"B", ToVector(test.TimeOf(*seen)), seen->values, StyleOf(*seen)},
                      {"A, the reference", ToVector(reference.TimeOf(wanted)), wanted.values, Curve::Style::kDashed}};
    pictures.pictures.push_back(std::move(picture));
  }
  std::ranges::stable_partition(pictures.pictures, [&checks](const Picture& picture) {
    return std::ranges::any_of(checks, [&picture](const score::Check& check) {
      return check.verdict != score::Verdict::kPass && check.evidence && check.evidence->signal == picture.y.label;
    });
  });
  std::vector<score::Check> named(checks.begin(), checks.end());
  for (score::Check& check : named) {
    if (check.evidence == nullptr) continue;
    auto evidence = std::make_shared<score::Evidence>(*check.evidence);
    evidence->reference_name = "A", evidence->test_name = "B";
    check.evidence = std::move(evidence);
  }
  AddDistances(named, pictures);
  return pictures;
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

RunPictures PicturesOf(const Prepared& prepared, const Course& course, std::span<const score::Check> checks) {
  RunPictures pictures;
  AddCourses(prepared, course, checks, pictures);
  AddComparisons(*prepared.rig, checks, pictures);
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
  return PicturesOf(prepared, *course, {});
}

}  // namespace dynoproof
