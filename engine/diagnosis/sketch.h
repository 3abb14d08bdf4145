// What a candidate promises, by a few runs beside the null and without a fit: how large the record asks for it to be, and which
// share of the error it would remove that nominal values cannot.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "diagnosis/contestant.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/trial.h"

namespace dynoproof::diagnosis {

/// What an effect adds to the innovations of the null, as a column: weighted as the null's are, without what nominal values make
/// up for [rows]. `size`: the factor at which it fits best; `removes`: of the null's squares, linear; -1: the run breaks, or
/// nothing is left of it; 0 where the null leaves nothing. `moves`: the largest change of a channel, RMS over what noise alone causes there.
struct Signature {
  bool ran = false;
  double size = 0.0, removes = -1.0, moves = 0.0;
  Eigen::VectorXd rows;
};

/// The null at a level where it holds; both outlive it.
class Screen {
 public:
  Screen(const Contestant& null, const estimation::Predictor& predictor, std::size_t level);

  /// By one run. `q`: coordinates of `hypothesis`, which is the null with one more effect.
  Signature Of(const estimation::Hypothesis& hypothesis, const Eigen::VectorXd& q) const;

 private:
  const estimation::Predictor& predictor_;
  const estimation::Estimate& estimate_;
  Eigen::MatrixXd inverse_;
};

/// A level and the next one: a strong correction leaves little of what only accumulates.
struct Screens {
  Screens(const Contestant& null, const Levels& levels, std::size_t level);

  Screen here;
  std::optional<Screen> next, free;  // free: the free run, where the null holds there
};

/// A point from which a candidate may be fitted, and the share of the error that it removes there, linear; -1: it changes
/// nothing, or breaks. 0: the record asks for what its bounds forbid. `moves`: the largest of all runs; nothing: each broke.
struct Sketch {
  Eigen::VectorXd q;
  double removes = -1.0;
  std::optional<double> moves = {};

  /// A run more.
  void Saw(const Signature& signature);
  /// At no size that was tried does it move an output so that it shows beside the noise.
  bool IsSilent() const;
};

/// What is told of a candidate whose sketch is silent.
NotTestable Silence(const Trial& candidate);

/// The best of the candidate's starts at the size that comes out of it, on either screen. `from`: coordinates of its hypothesis.
Sketch SketchOf(const Trial& candidate, const Screens& screens, const Eigen::VectorXd& from);

}  // namespace dynoproof::diagnosis
