// Pictures of the torque-feedthrough loop of thesis chapter 5: open loop, Nyquist curve, poles, phase of the filters.
#include "thesis/pictures_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "control10k/classical.h"
#include "experiment/analysis.h"
#include "thesis/constants.h"
#include "thesis/suppression_loop.h"

namespace dynoproof {
namespace {

/// The loop of a scenario, as the studies of chapter 5 compute it.
struct Loop {
  SuppressionPlant plant;
  double k_V = 0.0, period_s = 0.0;
  int delay_samples = 0;
  std::vector<double> notch_Hz;  // of the filters in use when the run ends
  double radius = 0.0;

  std::vector<control10k::NotchCoefficients> Filters(double r) const {
    std::vector<control10k::NotchCoefficients> filters;
    for (const double f : notch_Hz) {
      control10k::NotchCoefficients c;
      if (control10k::DesignNotch(kTurn * f * period_s, r, c)) filters.push_back(c);
    }
    return filters;
  }
};

/// One way of the command to the line: dead time, gain, first-order lag, in any order.
struct Way {
  double delay_s = 0.0, gain = 1.0, tau_s = 0.0;
};
std::optional<Way> WayOf(const Value& input) {
  Way way;
  const Value* stages = input.Find("actuator");
  Value::Array list;
  if (stages != nullptr && stages->is_array()) list = stages->array();
  if (stages != nullptr && stages->is_table()) list = {*stages};
  for (const Value& stage : list) {
    const std::string type = stage.TextOr("type");
    if (type == "delay") {
      way.delay_s += stage.NumberOr("delay_s", 0.0);
    } else if (type == "gain") {
      way.gain *= stage.NumberOr("gain", 1.0);
    } else if (type == "first_order_lag" && way.tau_s == 0.0) {
      way.tau_s = stage.NumberOr("tau_s", 0.0);
    } else {
      return std::nullopt;
    }
  }
  return way;
}

/// Nothing where the scenario has no core in its loop, or an actuator that SuppressionPlant does not have.
std::optional<Loop> LoopOf(const Prepared& prepared, const Course& course, mechanics::TransferFunction& transfer) {
  const Value &root = prepared.plan.root, *core = root.FindPath("control.core"), *inputs = root.Find("input");
  if (core == nullptr || inputs == nullptr || transfer.output().kind != mechanics::OutputKind::kEdgeTorque) return {};
  const std::string type = core->TextOr("type");
  const trace::Signal* k_V = course.trace.Find("k_V");
  if ((type != "core_10k" && type != "classical_core") || k_V == nullptr) return {};
  Loop loop;
  loop.period_s = prepared.rig->run.period_s;
  loop.k_V = k_V->values.back();
  loop.radius = core->NumberOr("radius", type == "core_10k" ? control10k::CoreConfig{}.suppression.radius
                                                            : control10k::ClassicalConfig{}.radius);
  loop.plant.network = transfer.network();
  loop.plant.airgap = transfer.input();
  loop.plant.shaft_edge = transfer.output().index;
  loop.plant.direct = 0.0;
  double total = 0.0, delay_s = -1.0;
  bool lagging = false;
  for (const Value::Entry& input : inputs->table()) {
    if (input.value.TextOr("from") != "control.core.T_ref") continue;
    const std::optional<Way> way = WayOf(input.value);
    if (!way || (delay_s >= 0.0 && way->delay_s != delay_s)) return {};
    delay_s = way->delay_s;
    total += way->gain;
    if (way->tau_s == 0.0) {
      loop.plant.direct += way->gain;
    } else if (lagging) {
      return {};
    } else {
      lagging = true;
      loop.plant.tau_a = way->tau_s;
    }
  }
  if (!lagging || std::abs(total - 1.0) > 1e-12) return {};
  loop.delay_samples = static_cast<int>(std::lround(delay_s / loop.period_s));
  for (const OutputLine& line : prepared.rig->outputs) {
    const std::string of = root.Find("output")->Find(line.name)->TextOr("of");
    if (!of.starts_with("control.core.notch_")) continue;
    const std::vector<double>& f = course.trace.Find(line.name)->values;
    if (f.back() != f.front()) loop.notch_Hz.push_back(f.back());
  }
  return loop;
}

Curve Decibels(std::string label, const std::vector<double>& f, const std::vector<std::complex<double>>& gain,
               Curve::Style style = Curve::Style::kLine) {
  Curve curve{std::move(label), f, {}, style};
  for (const std::complex<double>& value : gain) curve.y.push_back(20.0 * std::log10(std::abs(value)));
  return curve;
}

Curve Degrees(std::string label, const std::vector<double>& f, const std::vector<std::complex<double>>& gain,
              Curve::Style style = Curve::Style::kLine) {
  Curve curve{std::move(label), f, {}, style};
  double last = 0.0;
  for (const std::complex<double>& value : gain) {
    double degrees = std::arg(value) * 360.0 / kTurn;
    degrees += 360.0 * std::round((last - degrees) / 360.0);  // no jumps at +-180 degrees
    curve.y.push_back(degrees);
    last = degrees;
  }
  return curve;
}

Curve NyquistCurve(std::string label, const std::vector<std::complex<double>>& gain) {
  Curve curve{std::move(label), {}, {}};
  for (const std::complex<double>& value : gain) {
    curve.x.push_back(value.real());
    curve.y.push_back(value.imag());
  }
  return curve;
}

Curve Poles(std::string label, const std::vector<FilteredLoopMode>& modes, Curve::Style style) {
  Curve curve{std::move(label), {}, {}, style};
  for (const FilteredLoopMode& mode : modes) {
    if (mode.frequency_hz > 2500.0 || mode.growth_per_s < -2000.0) continue;
    curve.x.push_back(mode.growth_per_s);
    curve.y.push_back(mode.frequency_hz);
  }
  return curve;
}

/// Phase of the filters for a few pole radii, that of the scenario first (thesis Fig. 5.5).
Picture FilterPhase(const Loop& loop) {
  Picture picture{.key = "notch_phase",
                  .title = "Phase of the notch filters for several pole radii r",
                  .x = {"frequency", "Hz", false, 100.0, 1500.0},
                  .y = {"phase", "deg"}};
  for (const double r : {loop.radius, 0.98, 0.95}) {
    const std::vector<control10k::NotchCoefficients> filters = loop.Filters(r);
    Curve curve{fmt::format("r = {:g}", r), {}, {}};
    for (double f = 50.0; f < 2000.0; f += 1.0) {
      const std::complex<double> z = std::polar(1.0, kTurn * f * loop.period_s);
      double degrees = 0.0;  // of each filter alone: its phase jumps by 180 degrees at its zero and nowhere else
      for (const control10k::NotchCoefficients& c : filters) {
        degrees += std::arg((c.b0 + c.b1 / z + c.b2 / (z * z)) / (1.0 + c.a1 / z + c.a2 / (z * z))) * 360.0 / kTurn;
      }
      curve.x.push_back(f);
      curve.y.push_back(degrees);
    }
    picture.curves.push_back(std::move(curve));
  }
  return picture;
}

}  // namespace

void AddLoop(const Prepared& prepared, const Course& course, RunPictures& pictures) {
  Diagnostics ignored;  // Prepare() has reported them
  const std::optional<AnalysisSettings> settings = ReadAnalysis(prepared.plan, *prepared.rig, ignored);
  if (!settings) return;
  Result<mechanics::TransferFunction> transfer = TransferOf(*prepared.rig, *settings);
  if (!transfer.ok()) return;
  const std::optional<Loop> loop = LoopOf(prepared, course, *transfer);
  if (!loop) return;
  std::vector<double> f;
  for (double x = 50.0; x <= 2200.0; x += 1.0) f.push_back(x);
  const auto bare = OpenLoop(loop->plant, loop->k_V, loop->delay_samples, {}, f);
  const auto bare_modes = FilteredLoopModes(loop->plant, loop->k_V, loop->delay_samples, {});
  if (!bare.ok() || !bare_modes.ok()) return;
  double largest = 1.25;  // the point -1 is always in sight
  for (const std::complex<double>& value : *bare) largest = std::max(largest, std::abs(value));
  std::vector<std::complex<double>> mechanical;
  for (const double x : f) mechanical.push_back(loop->k_V * transfer->AtFrequency(x));

  const std::string at = fmt::format("k_V = {:g}", loop->k_V);
  Picture magnitude{.key = "loop_magnitude",
                    .title = "Open loop, magnitude, " + at,
                    .note = "an oscillation grows where the loop is above 0 dB while its phase passes -180 degrees",
                    .x = {"frequency", "Hz", false, 100.0, 1500.0},
                    .y = {"magnitude", "dB"}};
  Picture phase{.key = "loop_phase",
                .title = "Open loop, phase, " + at,
                .x = {"frequency", "Hz", false, 100.0, 1500.0},
                .y = {"phase", "deg"}};
  Picture nyquist{.key = "nyquist",
                  .title = "Nyquist curve of the open loop, " + at,
                  .note = "the loop closes with a minus: it is unstable when the curve goes round -1",
                  .x = {"Re L", "1", false, -1.2 * largest, 1.2 * largest},
                  .y = {"Im L", "1", false, -0.7 * largest, 0.7 * largest}};
  Picture poles{.key = "loop_poles",
                .title = "Poles of the closed loop, " + at,
                .note = "of the sampled loop, s = log(z) / T_d; oscillations to the right of 0 grow",
                .x = {"growth rate", "1/s", false, -250.0, 50.0},
                .y = {"frequency", "Hz", false, 0.0, 2100.0}};
  magnitude.marks.push_back({0.0, "0 dB", true});
  phase.marks.push_back({-180.0, "-180 degrees", true});
  poles.marks.push_back({0.0, "stable to the left"});
  magnitude.curves = {Decibels("loop", f, *bare), Decibels("plant alone", f, mechanical, Curve::Style::kDashed)};
  phase.curves = {Degrees("loop", f, *bare), Degrees("plant alone", f, mechanical, Curve::Style::kDashed)};
  nyquist.curves = {{"-1", {-1.0}, {0.0}, Curve::Style::kCrosses}, NyquistCurve("loop", *bare)};
  poles.curves = {Poles("loop", *bare_modes, Curve::Style::kCrosses)};

  const std::vector<control10k::NotchCoefficients> filters = loop->Filters(loop->radius);
  if (!filters.empty()) {
    std::string label;
    for (const double notch : loop->notch_Hz) label += fmt::format("{}{:.1f}", label.empty() ? "" : ", ", notch);
    label = fmt::format("with filters at {} Hz", label);
    const auto filtered = OpenLoop(loop->plant, loop->k_V, loop->delay_samples, filters, f);
    const auto modes = FilteredLoopModes(loop->plant, loop->k_V, loop->delay_samples, filters);
    if (filtered.ok() && modes.ok()) {
      magnitude.curves.push_back(Decibels(label, f, *filtered));
      phase.curves.push_back(Degrees(label, f, *filtered));
      nyquist.curves.push_back(NyquistCurve(label, *filtered));
      poles.curves.push_back(Poles(label, *modes, Curve::Style::kCircles));
    }
  }
  for (Picture* picture : {&magnitude, &phase, &nyquist, &poles}) pictures.pictures.push_back(std::move(*picture));
  if (!filters.empty()) pictures.pictures.push_back(FilterPhase(*loop));
}

}  // namespace dynoproof
