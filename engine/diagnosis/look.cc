#include "diagnosis/look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "experiment/prepare.h"
#include "score/spectrum.h"

namespace dynoproof::diagnosis {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using Values = std::vector<double>;

Values Part(const Eigen::VectorXd& all, const ComparedOutput& channel) {
  return {all.data() + channel.begin, all.data() + channel.begin + channel.count};
}

Values Minus(const Values& a, const Values& b) {
  Values difference(a.size());
  std::transform(a.begin(), a.end(), b.begin(), difference.begin(), std::minus<>());
  return difference;
}

Curve Named(const std::string& label, Values x, Values y, Curve::Style style = Curve::Style::kLine) {
  Curve curve;
  curve.label = label;
  curve.x = std::move(x);
  curve.y = std::move(y);
  curve.style = style;
  return curve;
}

Curve SpectrumOf(const std::string& label, const Values& time, const Values& residual) {
  const score::Spectrum spectrum = score::AmplitudeSpectrum({time, residual}, score::Window::kHann, true);
  if (!spectrum.ok() || spectrum.frequency_hz.size() < 2) return Named(label, {}, {});
  // Without the mean: the axis is logarithmic.
  return Named(label, {spectrum.frequency_hz.begin() + 1, spectrum.frequency_hz.end()},
               {spectrum.amplitude.begin() + 1, spectrum.amplitude.end()});
}

/// The mean of `residual` where `over` lies in each of 40 equal bins; bins of fewer than 8 samples are gaps.
Curve MeanOver(const std::string& label, const Values& over, const Values& residual) {
  constexpr int kBins = 40, kFewest = 8;
  const auto [low, high] = std::minmax_element(over.begin(), over.end());
  Values sum(kBins, 0.0), count(kBins, 0.0), x(kBins), y(kBins, kNaN);
  const double width = (*high - *low) / kBins;
  if (!(width > 0.0)) return Named(label, {}, {});
  for (std::size_t i = 0; i < over.size(); ++i) {
    const int bin = std::min(kBins - 1, static_cast<int>((over[i] - *low) / width));
    sum[bin] += residual[i];
    count[bin] += 1.0;
  }
  for (int bin = 0; bin < kBins; ++bin) {
    x[bin] = *low + (bin + 0.5) * width;
    if (count[bin] >= kFewest) y[bin] = sum[bin] / count[bin];
  }
  return Named(label, std::move(x), std::move(y));
}

struct Courses {
  Values time, measured, nominal, extended;  // extended: empty without one
};

void AddOf(const ComparedOutput& channel, const std::string& title, const Courses& c, std::vector<Picture>& pictures) {
  const Axis time{"t", "s"}, value{channel.name, channel.unit};
  const Values before = Minus(c.measured, c.nominal);
  Picture overlay{.key = "overlay:" + title, .title = title, .x = time, .y = value, .course = true};
  overlay.curves = {Named("measured", c.time, c.measured), Named("simulated", c.time, c.nominal)};
  Picture residual{
      .key = "residual:" + title, .title = title + ": measured - simulated", .x = time, .y = value, .course = true};
  residual.curves = {Named("before", c.time, before)};
  Picture spectrum{
      .key = "spectrum:" + title, .title = title + ": spectrum of the residual", .x = {"f", "Hz"}, .y = value};
  spectrum.y.logarithmic = true;
  spectrum.curves = {SpectrumOf("before", c.time, before)};
  if (!c.extended.empty()) {
    const Values after = Minus(c.measured, c.extended);
    overlay.curves.push_back(Named("extended", c.time, c.extended, Curve::Style::kDashed));
    residual.curves.push_back(Named("after", c.time, after));
    spectrum.curves.push_back(SpectrumOf("after", c.time, after));
  }
  pictures.insert(pictures.end(), {overlay, residual});
  if (!spectrum.curves.front().x.empty()) pictures.push_back(spectrum);  // uneven steps have none
}

/// The plan as the records were found to start.
Plan Started(Plan plan, const Diagnosis& found) {
  for (const Refitted& value : found.refitted) {
    const std::size_t dot = value.path.rfind('.');
    Value* parent = plan.root.FindPath(value.path.substr(0, dot));
    if (value.start && parent != nullptr && parent->is_table())
      (*parent)[value.path.substr(dot + 1)] = Value(value.value);
  }
  return plan;
}

}  // namespace

Result<std::vector<Picture>> Look(const Plan& nominal, const std::vector<MappedRecord>& records, const Diagnosis& found,
                                  const Registry& registry) {
  const EstimationProblem problem(nominal, records, registry);
  const Result<Eigen::VectorXd> before = problem.PredictPlan(Started(nominal, found));
  if (!before.ok()) return before.failure();
  std::optional<Eigen::VectorXd> after;
  if (const std::string& file = found.extended_scenario; !file.empty()) {
    Diagnostics diagnostics;
    const std::unique_ptr<Prepared> extended = Prepare(file, {}, registry, diagnostics);
    if (extended == nullptr) return Failure{.message = diagnostics.Format(), .signal = file};
    Result<Eigen::VectorXd> predicted = problem.PredictPlan(Started(extended->plan, found));
    if (!predicted.ok()) return predicted.failure();
    after = std::move(*predicted);
  }
  std::vector<Picture> pictures;
  const auto courses = [&](const ComparedOutput& channel) {
    Courses c{{problem.time_s().begin() + channel.begin, problem.time_s().begin() + channel.begin + channel.count},
              Part(problem.measured(), channel),
              Part(*before, channel),
              {}};
    if (after) c.extended = Part(*after, channel);
    return c;
  };
  for (const ComparedOutput& channel : problem.channels()) {
    const std::string title =
        records.size() > 1 ? fmt::format("{}, record {}", channel.name, channel.record + 1) : channel.name;
    const Courses own = courses(channel);
    AddOf(channel, title, own, pictures);
    for (const ComparedOutput& other : problem.channels()) {
      if (other.record != channel.record || other.count != channel.count) continue;
      const Courses along = courses(other);
      Picture picture{.key = "over:" + title + ":" + other.name,
                      .title = fmt::format("{}: mean residual over {}", title, other.name),
                      .x = {other.name, other.unit},
                      .y = {channel.name, channel.unit}};
      // Over what the best model says: a sensor's noise on both axes would pass for a slope.
      const Values& over = after ? along.extended : along.measured;
      picture.curves = {MeanOver("before", over, Minus(own.measured, own.nominal))};
      if (after) {
        picture.curves.push_back(MeanOver("after", over, Minus(own.measured, own.extended)));
        picture.curves.push_back(MeanOver("extended - simulated", over, Minus(own.extended, own.nominal)));
        picture.curves.back().style = Curve::Style::kDashed;
      }
      if (!picture.curves.front().x.empty()) pictures.push_back(std::move(picture));
    }
  }
  return pictures;
}

}  // namespace dynoproof::diagnosis
