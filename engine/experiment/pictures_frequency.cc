// Pictures over frequency: hull curve and response of a chirp, spectra, the plant's frequency response, poles and
// zeros.
#include "experiment/pictures_frequency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "experiment/analysis.h"
#include "score/response.h"
#include "score/spectrum.h"

namespace dynoproof {
namespace {

/// The sweep of an input that is driven by a linear chirp alone.
struct Sweep {
  double start_Hz, end_Hz, rate_Hz_per_s, start_time_s;
  double At(double time_s) const { return start_Hz + rate_Hz_per_s * (time_s - start_time_s); }
};
std::optional<Sweep> SweepOf(const Plan& plan, const std::string& input) {
  const Value* source = plan.root.FindPath("input." + input + ".source");
  if (source == nullptr || source->TextOr("type") != "chirp") return std::nullopt;
  Sweep sweep{source->NumberOr("start_Hz", 0.0), source->NumberOr("end_Hz", 0.0),
              source->NumberOr("rate_Hz_per_s", 0.0), source->NumberOr("start_time_s", 0.0)};
  const double duration_s = source->NumberOr("duration_s", 0.0);
  if (duration_s > 0.0) sweep.rate_Hz_per_s = (sweep.end_Hz - sweep.start_Hz) / duration_s;
  if (!(sweep.rate_Hz_per_s > 0.0) || sweep.end_Hz <= sweep.start_Hz) return std::nullopt;
  return sweep;
}

/// Frequencies from..to, denser around the resonances, whose tops a plain grid would cut off.
std::vector<double> Grid(double from, double to, const std::vector<mechanics::Resonance>& resonances) {
  std::vector<double> grid;
  constexpr int kPoints = 1500;
  for (int i = 0; i <= kPoints; ++i) grid.push_back(from + (to - from) * i / kPoints);
  for (const mechanics::Resonance& resonance : resonances) {
    for (int i = -40; i <= 40; ++i) {
      const double f = resonance.frequency_hz * (1.0 + 2e-5 * i * std::abs(i));
      if (f > from && f < to) grid.push_back(f);
    }
  }
  std::sort(grid.begin(), grid.end());
  return grid;
}

void AddHull(const Course& course, const AnalysisSettings& settings, const Sweep& sweep, RunPictures& pictures) {
  const trace::Signal *upper = course.trace.Find(settings.output + "_hull_upper"),
                      *lower = course.trace.Find(settings.output + "_hull_lower");
  if (upper == nullptr || lower == nullptr) return;
  Picture picture{.key = "hull:" + settings.output,
                  .title = fmt::format("Hull curve of {} over the chirp's frequency", settings.output),
                  .x = {"frequency of the chirp", "Hz"},
                  .y = {settings.output, upper->unit}};
  Curve above{"upper hull", {}, {}}, below{"lower hull", {}, {}};
  const std::span<const double> time = course.trace.TimeOf(*upper);
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double f = sweep.At(time[i]);
    if (f < sweep.start_Hz || f > sweep.end_Hz) continue;
    above.x.push_back(f);
    above.y.push_back(upper->values[i]);
    below.x.push_back(f);
    below.y.push_back(lower->values[i]);
  }
  Area between{"hull", above.x, above.y};
  between.x.insert(between.x.end(), below.x.rbegin(), below.x.rend());
  between.y.insert(between.y.end(), below.y.rbegin(), below.y.rend());
  picture.areas.push_back(std::move(between));
  picture.curves = {std::move(above), std::move(below)};
  pictures.pictures.push_back(std::move(picture));
}

/// Amplitude and phase of the plant from the analysed input to its output; of a chirp the run's beside them, where there is one.
void AddBode(const Prepared& prepared, const Course* course, const AnalysisSettings& settings,
             const mechanics::TransferFunction& transfer, const std::vector<mechanics::Resonance>& resonances,
             RunPictures& pictures) {
  const Rig& rig = *prepared.rig;
  const std::optional<Sweep> sweep = SweepOf(prepared.plan, settings.input);
  const double nyquist = 0.5 / rig.run.period_s;
  const double to = std::min(sweep ? std::min(sweep->end_Hz, settings.to_Hz) : settings.to_Hz, 0.98 * nyquist);
  const OutputLine& output = rig.outputs[static_cast<std::size_t>(FindOutput(rig, settings.output))];
  const InputLine& input = rig.inputs[static_cast<std::size_t>(FindInput(rig, settings.input))];
  const std::string ratio = fmt::format("{} / {}", settings.output, settings.input);
  const std::string unit = output.unit == input.unit ? "1" : fmt::format("{} / ({})", output.unit, input.unit);
  Picture amplitude{.key = "response",
                    .title = "Amplitude response of the plant, " + ratio,
                    .x = {"frequency", "Hz", false, settings.from_Hz, to},
                    .y = {"|" + ratio + "|", unit, true}};
  Picture phase{.key = "phase",
                .title = "Phase response of the plant, " + ratio,
                .x = {"frequency", "Hz", false, settings.from_Hz, to},
                .y = {"phase", "deg"}};
  Curve gain{"frequency response of the model", Grid(settings.from_Hz, to, resonances), {}},
      angle{"frequency response of the model", gain.x, {}};
  double last = 0.0;
  for (const double f : gain.x) {
    const std::complex<double> value = transfer.AtFrequency(f);
    gain.y.push_back(std::abs(value));
    double degrees = std::arg(value) * 180.0 / std::numbers::pi;
    if (!angle.y.empty()) degrees += 360.0 * std::round((last - degrees) / 360.0);  // no jumps at +-180 degrees
    angle.y.push_back(degrees);
    last = degrees;
  }
  if (sweep && course != nullptr) {
    const trace::Signal *u = course->trace.Find(settings.input), *y = course->trace.Find(settings.output);
    const score::Response seen = score::EstimateResponse(course->trace.time, u->values, y->values,
                                                         {.from_hz = std::max(0.0, settings.from_Hz), .to_hz = to});
    if (seen.ok()) {
      amplitude.title = "Amplitude response, chirp run and model, " + ratio;
      amplitude.curves.push_back({"chirp run", seen.frequency_hz, seen.Magnitude()});
      gain.style = Curve::Style::kDashed;
      // The command is held for a period: the run shows the plant times sinc(f period).
      for (std::size_t i = 0; i < gain.x.size(); ++i) {
        const double x = std::numbers::pi * gain.x[i] * rig.run.period_s;
        gain.y[i] *= std::abs(std::sin(x) / x);
      }
    }
  }
  for (const mechanics::Resonance& resonance : resonances) {
    if (resonance.frequency_hz < to) {
      amplitude.marks.push_back({resonance.frequency_hz, fmt::format("{:.1f} Hz", resonance.frequency_hz)});
    }
  }
  amplitude.curves.push_back(std::move(gain));
  phase.curves.push_back(std::move(angle));
  pictures.pictures.push_back(std::move(amplitude));
  pictures.pictures.push_back(std::move(phase));
}

void AddPoles(const LinearAnalysis& analysis, double to_Hz, RunPictures& pictures) {
  Picture picture{.key = "poles",
                  .title = "Poles and zeros of the plant",
                  .note = "upper half plane; damping grows to the left",
                  .x = {"Re s", "1/s"},
                  .y = {"Im s / 2 pi", "Hz"}};
  Curve poles{"poles", {}, {}, Curve::Style::kCrosses}, zeros{"zeros", {}, {}, Curve::Style::kCircles};
  const auto add = [to_Hz](Curve& curve, std::complex<double> s) {
    const double f = s.imag() / (2.0 * std::numbers::pi);
    if (f < 0.0 || f > to_Hz || std::abs(s) > 4.0 * std::numbers::pi * to_Hz) return;
    curve.x.push_back(s.real());
    curve.y.push_back(f);
  };
  for (const mechanics::Mode& mode : analysis.modal.modes) {
    add(poles, mode.damped.first);
    if (mode.damped.second.imag() == 0.0) add(poles, mode.damped.second);
  }
  for (const mechanics::Zero& zero : analysis.zeros.zeros) {
    if (zero.oscillatory) add(zeros, zero.s.imag() < 0.0 ? std::conj(zero.s) : zero.s);
  }
  picture.curves = {std::move(poles), std::move(zeros)};
  pictures.pictures.push_back(std::move(picture));
}

/// The nodes as one walks along the shafts, branch by branch, from the first end of a line on.
std::vector<int> WalkOf(const mechanics::Network& network) {
  std::vector<std::vector<int>> neighbours(network.nodes.size());
  for (const mechanics::Edge& edge : network.edges) {
    if (edge.to == mechanics::kGround) continue;
    neighbours[static_cast<std::size_t>(edge.from)].push_back(edge.to);
    neighbours[static_cast<std::size_t>(edge.to)].push_back(edge.from);
  }
  std::vector<int> walk, ahead, starts(network.nodes.size());
  std::iota(starts.begin(), starts.end(), 0);
  std::ranges::stable_partition(starts,
                                [&](int node) { return neighbours[static_cast<std::size_t>(node)].size() < 2; });
  std::vector<char> seen(network.nodes.size());
  for (const int start : starts) {
    ahead.push_back(start);
    while (!ahead.empty()) {
      const int node = ahead.back();
      ahead.pop_back();
      if (std::exchange(seen[static_cast<std::size_t>(node)], 1) != 0) continue;
      walk.push_back(node);
      const std::vector<int>& next = neighbours[static_cast<std::size_t>(node)];
      ahead.insert(ahead.end(), next.rbegin(), next.rend());
    }
  }
  return walk;
}

bool AreJoined(const mechanics::Network& network, int a, int b) {
  return std::ranges::any_of(network.edges, [&](const mechanics::Edge& edge) {
    return (edge.from == a && edge.to == b) || (edge.from == b && edge.to == a);
  });
}

/// The shapes of the modes that swing below `to_Hz`, the lowest at first.
void AddShapes(const LinearAnalysis& analysis, double to_Hz, RunPictures& pictures) {
  constexpr std::size_t kShown = 4, kMost = 12;
  const mechanics::Network& network = *analysis.network;
  Picture picture{.key = "shapes",
                  .title = "Shapes of the modes along the line",
                  .note = "the largest swing of each is 1; a gap is where a branch begins",
                  .x = {"mass along the line", ""},
                  .y = {"swing", "1"}};
  std::vector<int> nodes;  // in the order of the axis; -1: a gap
  for (const int node : WalkOf(network)) {
    if (!nodes.empty() && !AreJoined(network, nodes.back(), node)) {
      const auto joint =
          std::ranges::find_if(nodes, [&](int one) { return one >= 0 && AreJoined(network, one, node); });
      const int again = joint != nodes.end() ? *joint : -1;
      nodes.push_back(-1);
      if (again >= 0) nodes.push_back(again);  // a branch is drawn from the joint on that it begins at
    }
    nodes.push_back(node);
  }
  std::vector<double> places(nodes.size());
  std::iota(places.begin(), places.end(), 1.0);
  std::string part;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::string own = nodes[i] < 0 ? "" : ElementOf(network.nodes[static_cast<std::size_t>(nodes[i])].name);
    if (own != part && !own.empty()) picture.marks.push_back({places[i], own});
    part = own;
  }
  for (const mechanics::Mode& mode : analysis.modal.modes) {
    if (mode.frequency_hz == 0.0 || mode.frequency_hz > to_Hz || picture.curves.size() == kMost) continue;
    Curve curve{fmt::format("{:.1f} Hz", mode.frequency_hz), places, {}};
    for (const int node : nodes)
      curve.y.push_back(node < 0 ? std::numeric_limits<double>::quiet_NaN() : mode.shape[node]);
    curve.shown = picture.curves.size() < kShown;
    picture.curves.push_back(std::move(curve));
  }
  if (!picture.curves.empty()) pictures.pictures.push_back(std::move(picture));
}

}  // namespace

void AddResponses(const Prepared& prepared, const Course& course, RunPictures& pictures) {
  Diagnostics ignored;  // Prepare() has reported them
  const std::optional<AnalysisSettings> settings = ReadAnalysis(prepared.plan, *prepared.rig, ignored);
  if (!settings) return;
  if (const std::optional<Sweep> sweep = SweepOf(prepared.plan, settings->input)) {
    AddHull(course, *settings, *sweep, pictures);
  }
  const Result<mechanics::TransferFunction> transfer = TransferOf(*prepared.rig, *settings);
  const Result<LinearAnalysis> analysis = Analyse(*prepared.rig, *settings);
  if (!transfer.ok() || !analysis.ok()) return;
  AddBode(prepared, &course, *settings, *transfer, analysis->resonances, pictures);
  AddPoles(*analysis, settings->to_Hz, pictures);
}

std::vector<Picture> PicturesOfModes(const Prepared& prepared, const AnalysisSettings& settings,
                                     const LinearAnalysis& analysis) {
  RunPictures pictures;
  const Result<mechanics::TransferFunction> transfer = TransferOf(*prepared.rig, settings);
  if (transfer.ok()) AddBode(prepared, nullptr, settings, *transfer, analysis.resonances, pictures);
  AddShapes(analysis, settings.to_Hz, pictures);
  AddPoles(analysis, settings.to_Hz, pictures);
  return pictures.pictures;
}

void AddSpectra(const Prepared& prepared, const Course& course, RunPictures& pictures) {
  const Value* checks = prepared.plan.root.Find("check");
  for (const Value& check : checks != nullptr && checks->is_array() ? checks->array() : Value::Array{}) {
    const std::string kind = check.TextOr("kind"), name = check.TextOr("signal");
    const bool peak = kind == "peak";
    if (!peak && kind != "growth" && kind != "placements") continue;
    const trace::Signal* signal = course.trace.Find(name);
    if (signal == nullptr) continue;
    std::size_t begin = 0, end = course.trace.time.size();
    std::string when;
    if (const Value* during = check.Find("during_s"); during != nullptr && during->is_array()) {
      const auto row = [&](std::size_t i) {
        const std::vector<double>& time = course.trace.time;
        return static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), during->array()[i].number() - 1e-9) -
                                        time.begin());
      };
      begin = row(0);
      end = std::min(end, row(1) + 1);
      when = fmt::format(", {:g} to {:g} s", during->array()[0].number(), during->array()[1].number());
    }
    const std::span<const double> time = std::span(course.trace.time).subspan(begin, end - begin);
    const score::Spectrum spectrum = score::AmplitudeSpectrum(
        {time, std::span(signal->values).subspan(begin, end - begin)}, score::Window::kHann, true);
    if (!spectrum.ok()) continue;
    double from = 0.0, to = std::min(2500.0, 0.5 * spectrum.frequency_hz.back());
    if (peak) {  // below the band a ramp's own lines would hide the oscillation
      from = check.Find("band_Hz")->array()[0].number();
      to = std::min(to, 6.0 * check.Find("between_Hz")->array()[1].number());
    }
    Picture picture{.key = "spectrum:" + name,
                    .title = fmt::format("Amplitude spectrum of {}{}", name, when),
                    .note = "Hann window, mean removed",
                    .x = {"frequency", "Hz", false, 0.0, to},
                    .y = {"amplitude of " + name, signal->unit, !peak}};
    Curve curve{name, {}, {}};
    for (std::size_t i = 1; i < spectrum.frequency_hz.size() && spectrum.frequency_hz[i] <= 2.0 * to; ++i) {
      if (spectrum.frequency_hz[i] < from) continue;
      curve.x.push_back(spectrum.frequency_hz[i]);
      curve.y.push_back(spectrum.amplitude[i]);
    }
    picture.curves.push_back(std::move(curve));
    pictures.pictures.push_back(std::move(picture));
  }
}

}  // namespace dynoproof
