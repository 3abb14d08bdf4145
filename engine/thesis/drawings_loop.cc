#include "thesis/drawings_loop.h"

#include <fmt/format.h>

#include <cmath>
#include <complex>

#include "control10k/core.h"
#include "control10k/notch.h"
#include "linear/modes.h"
#include "linear/zeros.h"
#include "thesis/constants.h"
#include "thesis/suppression_loop.h"

namespace dynoproof {
namespace {

constexpr double kFirst_Hz = 100.0, kLast_Hz = 1500.0;

std::vector<double> Frequencies() {
  std::vector<double> f;
  for (double x = kFirst_Hz; x <= kLast_Hz; x += 1.0) f.push_back(x);
  return f;
}

/// Fig. 5.2: the printed gains are not in the text; these are the ones of Secs. 5.3.1, 5.6.3 and 5.6.4.
Result<Picture> LoopGains(const Registry&) {
  Picture picture{.key = "loop_gains",
                  .title = "Open loop, magnitude for several gains",
                  .note = "actuator of 1 ms, sampled at 10 kHz; the gains of Secs. 5.3.1, 5.6.3 and 5.6.4",
                  .x = {"frequency", "Hz", false, kFirst_Hz, kLast_Hz},
                  .y = {"magnitude", "dB"}};
  picture.marks.push_back({0.0, "0 dB", true});
  const std::vector<double> f = Frequencies();
  for (const double k_V : {9.7, 4.3, 2.1}) {
    const auto loop = OpenLoop(R2RPlant(), k_V, 0, {}, f);
    if (!loop.ok()) return loop.failure();
    Curve curve{fmt::format("k_V = {:g}", k_V), f, {}};
    for (const std::complex<double>& value : *loop) curve.y.push_back(20.0 * std::log10(std::abs(value)));
    picture.curves.push_back(std::move(curve));
  }
  return picture;
}

/// The phase without jumps at +-180 degrees; at any frequency, as marks need it.
class PhaseCurve {
 public:
  PhaseCurve(const std::vector<double>& f, const std::vector<std::complex<double>>& gain) : f_(f) {
    double last = 0.0;
    for (const std::complex<double>& value : gain) {
      double degrees = std::arg(value) * 360.0 / kTurn;
      degrees += 360.0 * std::round((last - degrees) / 360.0);
      degrees_.push_back(degrees);
      last = degrees;
    }
  }
  const std::vector<double>& degrees() const { return degrees_; }
  double At(double f) const {
    return degrees_[static_cast<std::size_t>(std::lround((f - f_.front()) / (f_[1] - f_[0])))];
  }

 private:
  std::vector<double> f_, degrees_;
};

/// A curve of the line alone, with crosses at its poles and circles at its transfer zeros.
Status AddLine(const SuppressionPlant& plant, const std::string& label, Picture& picture) {
  const mechanics::Output output{mechanics::OutputKind::kEdgeTorque, plant.shaft_edge};
  const auto transfer = mechanics::TransferFunction::Build(plant.network, plant.airgap, output);
  const auto modal = mechanics::Modes(plant.network);
  const auto zeros = mechanics::TransferZeros(plant.network, plant.airgap, output);
  if (!transfer.ok()) return transfer.failure();
  if (!modal.ok()) return modal.failure();
  if (!zeros.ok()) return zeros.failure();
  const std::vector<double> f = Frequencies();
  std::vector<std::complex<double>> gain;
  for (const double x : f) gain.push_back(transfer->AtFrequency(x));
  const PhaseCurve phase(f, gain);
  Curve crosses{"poles, " + label, {}, {}, Curve::Style::kCrosses},
      circles{"zeros, " + label, {}, {}, Curve::Style::kCircles};
  const auto put = [&](Curve& curve, double frequency) {
    if (frequency < kFirst_Hz || frequency > kLast_Hz) return;
    curve.x.push_back(frequency);
    curve.y.push_back(phase.At(frequency));
  };
  for (const mechanics::Mode& mode : modal->modes) put(crosses, mode.frequency_hz);
  for (const mechanics::Zero& zero : zeros->zeros) {
    if (zero.oscillatory) put(circles, zero.frequency_hz);
  }
  picture.curves.push_back({label, f, phase.degrees()});
  picture.curves.push_back(std::move(crosses));
  if (!circles.x.empty()) picture.curves.push_back(std::move(circles));
  return {};
}

/// Fig. 5.3: the loop with its actuator, the line alone, and the line with the torque on the left quarter of its rotor.
Result<Picture> LoopPhases(const Registry&) {
  Picture picture{.key = "loop_phases",
                  .title = "Open loop, phase: with actuator, line alone, torque on a quarter of the rotor",
                  .note = "actuator of 1 ms, sampled at 10 kHz",
                  .x = {"frequency", "Hz", false, kFirst_Hz, kLast_Hz},
                  .y = {"phase", "deg"}};
  picture.marks.push_back({-180.0, "-180 degrees", true});
  const std::vector<double> f = Frequencies();
  const SuppressionPlant plant = R2RPlant();
  const auto loop = OpenLoop(plant, 1.0, 0, {}, f);
  if (!loop.ok()) return loop.failure();
  picture.curves.push_back({"1: with actuator", f, PhaseCurve(f, *loop).degrees()});
  if (const Status broken = AddLine(plant, "2: line alone", picture)) return *broken;
  // A quarter of 70 slices, from the left: 1 to 18.
  SuppressionPlant quarter = plant;
  constexpr int kSlices = 18;
  quarter.airgap.setZero();
  quarter.airgap.head(kSlices).setConstant(1.0 / kSlices);
  if (const Status broken = AddLine(quarter, "3: slices 1 to 18", picture)) return *broken;
  return picture;
}

/// Fig. D.1 for the filter at the second resonance, with the radius of the thesis and the smallest advisable one.
Result<Picture> NotchPoles(const Registry&) {
  constexpr double kNotch_Hz = 832.0;
  Picture picture{.key = "notch_poles",
                  .title = "Poles and zeros of the notch filter at 832 Hz",
                  .note = "sampled at 10 kHz; the axes differ in scale",
                  .x = {"Re z", "1", false, -2.4, 2.4},
                  .y = {"Im z", "1", false, -1.2, 1.2}};
  Curve circle{"unit circle", {}, {}, Curve::Style::kDashed};
  for (int i = 0; i <= 360; ++i) {
    circle.x.push_back(std::cos(kTurn * i / 360.0));
    circle.y.push_back(std::sin(kTurn * i / 360.0));
  }
  picture.curves.push_back(std::move(circle));
  // Roots of z^2 + p z + q, a conjugate pair.
  const auto add = [&picture](std::string label, double p, double q, Curve::Style style) {
    const double im = std::sqrt(q - 0.25 * p * p);
    picture.curves.push_back({std::move(label), {-0.5 * p, -0.5 * p}, {im, -im}, style});
  };
  for (const double r : {0.995, control10k::kSmallestAdvisableRadius}) {
    control10k::NotchCoefficients c;
    if (!control10k::DesignNotch(kTurn * kNotch_Hz * kPeriod_s, r, c)) {
      return Failure{.message = "no notch filter", .signal = "notch_poles", .exit_code = 2};
    }
    if (picture.curves.size() == 1) add("zeros", c.b1 / c.b0, c.b2 / c.b0, Curve::Style::kCircles);
    add(fmt::format("poles, r = {:g}", r), c.a1, c.a2, Curve::Style::kCrosses);
  }
  return picture;
}

/// A loop in which something swings, and what becomes of it when a filter is put on its frequency at 0.3 s (Fig. E.1).
struct Swinging {
  std::string key, title, note;
  double I5, k_V, notch_Hz, load_Nm;  // load: a tone at notch_Hz
};
Result<Picture> Filtered(const Swinging& swinging) {
  constexpr double kFilter_s = 0.3, kEnd_s = 0.9, kKick_Nm = 50.0, kKick_s = 1e-3;
  control10k::CoreConfig config;
  config.speed = {20.0, 20.0, 4000.0};  // as scenarios/suppression
  Result<SuppressionLoop> made = SuppressionLoop::Create(R2RPlant(swinging.I5), config);
  if (!made.ok()) return made.failure();
  Picture picture{.key = swinging.key,
                  .title = swinging.title,
                  .note = swinging.note,
                  .x = {"time", "s"},
                  .y = {"T_shaft", "N m", false, -2700.0, 2700.0}};  // one ordinate for both
  picture.marks.push_back({kFilter_s, "filter on"});
  Curve curve{"T_shaft", {}, {}};
  for (int n = 0; n * kPeriod_s < kEnd_s; ++n) {
    const double t = n * kPeriod_s;
    if (n == static_cast<int>(std::lround(kFilter_s / kPeriod_s))) {
      control10k::Notch& notch = made->core_state().suppression.notch[0];
      if (!notch.Retune(kTurn * swinging.notch_Hz * kPeriod_s, 0.995, made->T_shaft_Nm()))
        return Failure{.message = "no notch filter", .signal = swinging.key, .exit_code = 2};
    }
    // A short kick begins what the loop makes of itself.
    const double load = (t < kKick_s ? kKick_Nm : 0.0) + swinging.load_Nm * std::sin(kTurn * swinging.notch_Hz * t);
    made->Step(load, 0.0, swinging.k_V, false);
    curve.x.push_back(t);
    curve.y.push_back(made->T_shaft_Nm());
  }
  picture.curves.push_back(std::move(curve));
  return picture;
}
Result<Picture> FilterOnResonance(const Registry&) {
  return Filtered({"filter_on_resonance", "A filter on an oscillation of the loop",
                   "first test flange, k_V = 4.3, unstable at 535.7 Hz, filter at 534 Hz, r = 0.995", 0.171, 4.3, 534.0,
                   0.0});
}
Result<Picture> FilterOnExcitation(const Registry&) {
  return Filtered({"filter_on_excitation", "A filter on an oscillation from outside",
                   "no flange, k_V = 2.1, a load of 1 kN m at 450 Hz, filter there, r = 0.995", 0.081, 2.1, 450.0,
                   1000.0});
}

}  // namespace

DrawingTable LoopDrawings() {
  return {{"filter_on_excitation", FilterOnExcitation},
          {"filter_on_resonance", FilterOnResonance},
          {"loop_gains", LoopGains},
          {"loop_phases", LoopPhases},
          {"notch_poles", NotchPoles}};
}

}  // namespace dynoproof
