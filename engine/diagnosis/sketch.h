// A sketch of a candidate by a few runs beside the null, without a fit: how large the record asks for it to be, and which
// share of the error it would remove that nominal values cannot.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "diagnosis/contestant.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/trial.h"

namespace dynoproof::diagnosis {

/// An effect as a column [rows]: `change` is how it moves the innovations e of the null, weighted as these are, and `rest` the part of
/// it that nominal values cannot make up for within their priors: rest = change - J H^-1 J' change, J the null's columns but for
/// the number that the effect changes itself, H = J'J + 1. `size`: the factor at which it fits best, s = (change'e - (H^-1 J' change)'
/// (J'e + q)) / rest'change, q the deviations of nominal values from their priors, which count as rows do (score test, Rao 1948).
/// `removes`: of the null's squares, rows and deviations, s^2 rest'change / (e'e + q'q), linear, and the deviation of the number that
/// the effect changes itself; -1: the run breaks, or nothing is left of it. `moves`: the largest change of a channel, RMS over what
/// noise alone causes there.
struct Signature {
  bool ran = false;
  double size = 0.0, removes = -1.0, moves = 0.0;
  Eigen::VectorXd change, rest;
};

/// The squares that a model leaves at a level: of its weighted innovations, and of what its nominal values are off.
double SquaresOf(const Contestant& one, std::size_t level);

/// The null at a level where it holds; both outlive it.
class Screen {
 public:
  Screen(const Contestant& null, const estimation::Predictor& predictor, std::size_t level);

  /// By one run. `q`: coordinates of the candidate's hypothesis, which is the null with one more effect.
  Signature Of(const Trial& candidate, const Eigen::VectorXd& q) const;
  /// The share of the squares of the null's rows that it removes in a run in which nominal values have followed it by one step, within their
  /// bounds; not below that in the run without. `signature`: at q.
  double Removed(const Trial& candidate, const Eigen::VectorXd& q, const Signature& signature) const;
  /// The candidate's numbers at q, and nominal values where they then go by one step, within their bounds.
  Eigen::VectorXd Followed(const Trial& candidate, const Eigen::VectorXd& q, const Signature& signature) const;

 private:
  /// The inverse curvature of the null's numbers, without the one that a candidate changes itself: its row and column are 0.
  Eigen::MatrixXd InverseBeside(const Trial& candidate) const;

  const Contestant& null_;
  const estimation::Predictor& predictor_;
  const estimation::Estimate& estimate_;
  Eigen::MatrixXd inverse_;
  Eigen::VectorXd off_;  // coordinates of the numbers that have a prior; 0: the others
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
  std::optional<double> next = {};  // what it removes at the next level, linear

  /// A run more.
  void Saw(const Signature& signature);
  /// At no size that was tried does it move an output so that it shows beside the noise.
  bool IsSilent() const;
};

/// The entry of `not_testable` for a candidate whose sketch is silent.
NotTestable Silence(const Trial& candidate);

/// The best of the candidate's starts at the size that comes out of it, on either screen. `from`: coordinates of its hypothesis.
Sketch SketchOf(const Trial& candidate, const Screens& screens, const Eigen::VectorXd& from);

}  // namespace dynoproof::diagnosis
