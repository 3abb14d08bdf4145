// What there is to see of a run, as values: curves, areas and marks with labels and units. How they are drawn is the
// report's matter (reports/).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiment/run_scenario.h"

namespace dynoproof {

struct Axis {
  std::string label, unit;
  bool logarithmic = false;
  std::optional<double> from = {}, to = {};  // what is shown at first; all of it when left out
};

struct Curve {
  /// kSamples: of another curve that they are compared with; left out as long as they could not be told apart.
  enum class Style { kLine, kDashed, kHold, kPoints, kSamples, kCrosses, kCircles };
  std::string label;
  std::vector<double> x, y;  // equal lengths; NaN in y is a gap
  Style style = Style::kLine;
  bool shown = true;  // at first; a reader may switch it
};

/// A closed polygon, filled: a tube, an activation area.
struct Area {
  std::string label;
  std::vector<double> x, y;
};

/// A line across the picture: a limit (horizontal), an event or a resonance (vertical).
struct Mark {
  double at = 0.0;
  std::string label;
  bool horizontal = false;
};

struct Picture {
  std::string key;    // stable within a scenario: "time:T_shaft", "phase_plane"; figures of the atlas name it
  std::string title;  // plain text, as all texts here
  std::string note = {};
  Axis x, y;
  bool course = false;  // x is the time of the run: all such pictures of a scenario are looked at together
  std::vector<Curve> curves = {};
  std::vector<Area> areas = {};
  std::vector<Mark> marks = {};
};

struct RunPictures {
  std::vector<Picture> pictures;
  std::vector<std::string> constant;  // "k_V = 9.7": signals that never change need no picture
};

/// All pictures of a run, the courses first. `checks` are those of the run with their evidence: what they judged is
/// drawn as they judged it. Pictures that cannot be computed are left out: the checks say why.
RunPictures PicturesOf(const Prepared& prepared, const Course& course, std::span<const score::Check> checks);

/// The pictures of a scenario without its checks: the run, made anew.
Result<RunPictures> PicturesOf(const Prepared& prepared, const Progress& progress = {});

/// Two traces one over the other, those that part first; where they part close up, and their distances over the limits of the
/// checks that compared them.
RunPictures PicturesOfTraces(const trace::Trace& reference, const trace::Trace& test,
                             std::span<const score::Check> checks);

/// Draws what a layer above adds to the pictures of every run where it applies; drawn before the timing, in the order
/// of these calls. One that is known already is not added again.
using PictureMaker = void (*)(const Prepared& prepared, const Course& course, RunPictures& pictures);
void AddPictureMaker(PictureMaker maker);

/// The parts, each appending what applies to the scenario.
void AddCourses(const Prepared& prepared, const Course& course, std::span<const score::Check> checks,
                RunPictures& pictures);
void AddComparisons(const Rig& rig, std::span<const score::Check> checks, RunPictures& pictures);
void AddTiming(const Course& course, RunPictures& pictures);

}  // namespace dynoproof
