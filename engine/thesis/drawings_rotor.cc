#include "thesis/drawings_rotor.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>

#include "experiment/prepare.h"
#include "linear/modes.h"
#include "scenario/find.h"
#include "thesis/constants.h"
#include "thesis/distributed.h"

namespace dynoproof {
namespace {

using std::numbers::pi;

/// Fig. 2.14: the elastic modes of the chain of Table A.1, each scaled to its largest entry.
Result<Picture> ModeShapes(const Registry& registry) {
  const std::string file =
      (std::filesystem::path(ScenarioFolder()) / "heavy_duty" / "straight_chain_setup_1.toml").string();
  Diagnostics diagnostics;
  const std::unique_ptr<Prepared> prepared = Prepare(file, {}, registry, diagnostics);
  if (prepared == nullptr) return Failure{.message = diagnostics.Format(), .signal = file, .exit_code = 2};
  const Result<mechanics::ModalAnalysis> modal =
      mechanics::Modes(*prepared->rig->FindBlock("plant")->component->network());
  if (!modal.ok()) return modal.failure();
  Picture picture{.key = "mode_shapes",
                  .title = "Mode shapes of the straight chain, Table A.1",
                  .note = "members whose entries have one sign move in phase; without damping",
                  .x = {"inertia", "1"},
                  .y = {"angle, scaled to its largest", "1"}};
  picture.marks.push_back({0.0, "", true});
  for (std::size_t m = static_cast<std::size_t>(modal->rigid); m < modal->modes.size(); ++m) {
    const mechanics::Mode& mode = modal->modes[m];
    Curve curve{fmt::format("{:.1f} Hz", mode.frequency_hz), {}, {}};
    for (Eigen::Index i = 0; i < mode.shape.size(); ++i) {
      curve.x.push_back(static_cast<double>(i + 1));
      curve.y.push_back(mode.shape[i]);
    }
    picture.curves.push_back(std::move(curve));
  }
  return picture;
}

/// y(x) above 0, with a gap where it leaves what is shown: at the poles of either side.
Curve Side(std::string label, const Picture& picture, const std::function<double(double)>& y) {
  Curve curve{std::move(label), {}, {}};
  constexpr int kPoints = 6000;
  for (int i = 1; i <= kPoints; ++i) {
    const double x = *picture.x.to * i / kPoints, value = y(x);
    curve.x.push_back(x);
    curve.y.push_back(value >= *picture.y.from && value <= *picture.y.to ? value : kNaN);
  }
  return curve;
}

double Left(double x) { return -x / std::tan(x); }

/// Fig. 2.30 with the heavy-duty rotor of Table A.5, I4 and I5 pinned to it, which is how Appendix A.3 begins.
Result<Picture> SpatialEquation(const Registry&) {
  constexpr double kInertia = 25.308, kEnd = 0.235 + 0.159, kStiffness = 16.5e6, kLast = 3.5 * pi;
  const double ratio = kInertia / kEnd, wave = std::sqrt(kStiffness / kInertia);  // nu = wave qL, (2.100)
  const auto roots = mechanics::SpatialEigenfrequencies(kInertia, kStiffness, kEnd, kLast * wave / (2.0 * pi));
  if (!roots.ok()) return roots.failure();
  Picture picture{.key = "spatial_equation",
                  .title = "Both sides of the spatial eigenfrequency equation (2.111)",
                  .note = "rotor of Table A.5 with I4 + I5 pinned to its end",
                  .x = {"qL", "rad", false, 0.0, kLast},
                  .y = {"sides of (2.111)", "1", false, -20.0, 100.0}};
  picture.curves.push_back(Side("-qL cot(qL)", picture, Left));
  picture.curves.push_back({"I_1 / I_5", {0.0, kLast}, {ratio, ratio}, Curve::Style::kDashed});
  Curve found{"eigenfrequencies", {}, {}, Curve::Style::kCircles};
  for (const double f : *roots) {
    const double x = 2.0 * pi * f / wave;
    found.x.push_back(x);
    found.y.push_back(ratio);
    picture.marks.push_back({x, fmt::format("{:.1f} Hz", f)});
  }
  picture.curves.push_back(std::move(found));
  return picture;
}

/// Fig. B.2 with Table B.1, beside the constant right side of (2.111).
Result<Picture> FrequencyDependentInertia(const Registry&) {
  constexpr double kInertia = 20.0, kStiffness = 30e6, kLast = 2.5 * pi;
  const mechanics::Oscillator oscillator{1e6, 0.35};
  const double wave = std::sqrt(kStiffness / kInertia), f_max = kLast * wave / (2.0 * pi);
  const auto roots = mechanics::HeuristicEigenfrequencies(kInertia, kStiffness, oscillator, f_max);
  const auto classical = mechanics::SpatialEigenfrequencies(kInertia, kStiffness, oscillator.inertia, f_max);
  if (!roots.ok()) return roots.failure();
  if (!classical.ok()) return classical.failure();
  const auto exact = mechanics::ExactEigenfrequencies({kInertia, kStiffness, 0.0, 0.0, {oscillator}}, f_max);
  if (!exact.ok()) return exact.failure();
  const double ratio = kInertia / oscillator.inertia;
  const double x_0 = std::sqrt(oscillator.stiffness / oscillator.inertia) / wave;  // (B.1), (B.2) over qL
  const double x_r = std::sqrt(oscillator.stiffness * (1.0 / kInertia + 1.0 / oscillator.inertia)) / wave;
  const auto right = [=](double x) { return ratio * (x - x_0) / (x - x_r); };
  Picture picture{.key = "dependent_inertia",
                  .title = "Eigenfrequency equation with a frequency-dependent inertia, Table B.1",
                  .note = fmt::format("the exact eigenfrequencies are {:.1f} Hz", fmt::join(*exact, ", ")),
                  .x = {"qL", "rad", false, 0.0, kLast},
                  .y = {"sides of (B.4)", "1", false, -60.0, 160.0}};
  picture.curves.push_back(Side("-qL cot(qL)", picture, Left));
  picture.curves.push_back(Side("right side of (B.4)", picture, right));
  picture.curves.push_back({"I_1 / I_5", {0.0, kLast}, {ratio, ratio}, Curve::Style::kDashed});
  Curve found{"roots of (B.4)", {}, {}, Curve::Style::kCircles},
      plain{"roots of (2.111)", {}, {}, Curve::Style::kCrosses};
  for (const double f : *roots) {
    const double x = 2.0 * pi * f / wave;
    found.x.push_back(x);
    found.y.push_back(right(x));
    picture.marks.push_back({x, fmt::format("{:.1f} Hz", f)});
  }
  for (const double f : *classical) {
    plain.x.push_back(2.0 * pi * f / wave);
    plain.y.push_back(ratio);
  }
  picture.curves.push_back(std::move(found));
  picture.curves.push_back(std::move(plain));
  return picture;
}

}  // namespace

DrawingTable RotorDrawings() {
  return {{"frequency_dependent_inertia", FrequencyDependentInertia},
          {"mode_shapes", ModeShapes},
          {"spatial_equation", SpatialEquation}};
}

}  // namespace dynoproof
