// Fits a hypothesis to the records by its free-run error. Effect parameters are found by Levenberg-Marquardt (Ceres)
// within their bounds; the doubtful nominal values follow linearly at each step (variable projection), so that an
// evaluation costs one simulation however many doubts there are.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "diagnosis/noise.h"
#include "diagnosis/study.h"

namespace dynoproof::diagnosis {

/// How the doubts of a study enter: linearised about a point. Columns of fixed doubts are left out.
struct DoubtModel {
  std::vector<double> z0;       // where
  std::vector<double> freedom;  // by doubt: prior standard deviation in units of its spread; 0: fixed
  std::vector<int> free;        // the doubts with a column
  Eigen::VectorXd predicted;    // there
  Eigen::MatrixXd jacobian;     // d predicted / d z
};
/// Step of their differences, in spreads. Sharp resonances ring for a second: 1e-6 of a stiffness turns their phase by
/// some 0.005 rad in that time: linear; and it stands far above the round-off of a free run.
inline constexpr double kDoubtStep = 1e-4;
/// The doubts that have a column.
std::vector<int> FreeOf(const std::vector<double>& freedom);
/// Forward differences about `at`, one simulation a free doubt.
Result<DoubtModel> LineariseDoubts(const Study& study, const Hypothesis& at, std::vector<double> freedom);
/// Whether an effect changes what the nominal values are values of, and sets them free.
bool ChangesStructure(const Assumed& assumed);
/// The usual freedom of the doubts under a set of effects: 1; 0 for a number that an effect changes itself, and for
/// dampings that are nominally zero; wide where an effect changes the structure.
std::vector<double> FreedomOf(const Study& study, const std::vector<Assumed>& effects);

/// The projection onto the doubts: for a whitened error it gives the doubts that fit best, and what is left.
class Projection {
 public:
  Projection(const DoubtModel& doubts, const Whitener& whitener);

  /// Shift of the free doubts for a whitened error.
  Eigen::VectorXd Shift(const Eigen::VectorXd& error) const;
  /// The error without its part along the doubts, then the doubts over their prior.
  Eigen::VectorXd Residual(const Eigen::VectorXd& error, const Eigen::VectorXd& shift) const;
  /// A whitened signature without what the doubts can mimic: how Residual() falls as the signature grows. The last rows
  /// are the doubts over their prior; without them a signature that a doubt mimics at a price would seem to be none.
  Eigen::VectorXd Free(const Eigen::VectorXd& white) const;
  double log_det() const { return log_det_; }

 private:
  Eigen::MatrixXd white_;
  Eigen::VectorXd prior_, centre_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  double log_det_ = 0.0;
};

struct Fit {
  Hypothesis hypothesis;
  DoubtModel doubts;
  Eigen::VectorXd predicted;  // simulated; Evaluate() and Optimise() add the linear shift of the doubts instead
  double log_det = 0.0;       // of the doubts: what their freedom costs
  double chi2 = 0.0;          // whitened squares, and the doubts' prior
  double criterion = 0.0;     // -2 log evidence: chi2 + log det of the doubts + p log n
  int simulations = 0;
  bool settled = false;  // Polish() came to an end before its rounds did
  std::string broken;    // why there is no fit
  /// By parameter of all effects in order, then by free doubt: whitened Jacobian at the optimum. Filled by Derive().
  Eigen::MatrixXd jacobian;
  Eigen::MatrixXd covariance;

  bool ok() const { return broken.empty(); }
  std::string Name() const;
  int parameters() const;
  /// Of a parameter of all effects, in order; after Derive().
  double StandardDeviation(Eigen::Index parameter) const;
};

/// Whether an effect changes the very number that a doubt is about.
bool Changes(const Assumed& assumed, const Doubt& doubt);
/// A hypothesis as it stands, simulated; its doubts are not linearised and nothing is weighed yet.
Fit FitAt(const Study& study, Hypothesis hypothesis);
/// The noise's colour, as what a fit leaves has it; `order` 0: white.
Whitener WhitenerOf(const Study& study, const Fit& fit, int order = Whitener::kOrder);
/// What the doubts of a fit cost by their prior.
double PriorChi2(const Fit& fit);
/// An effect of the fit that changes the doubt's own number, in spreads of the doubt.
std::optional<double> AsDoubt(const Doubt& doubt, const Fit& fit);
/// How far the most doubtful nominal value lies off, in spreads that the hypothesis allows it; starts do not count.
double Farthest(const Study& study, const Fit& fit);

inline constexpr double kTwoSided95 = 1.959964;  // standard deviations
/// How far the optimum may lie off for the solver's step, by parameter of all effects: twice what half the step
/// changes, as far as that is linear. Of a fit with its covariance.
Eigen::VectorXd SolverBias(const Study& study, const Fit& fit);
/// Whether no strength of effect number `effect` has a 95 % interval that leaves out the neutral value: what is gained
/// then comes from computing the nominal model another way. Of a fit with its covariance; false for effects without
/// strengths.
/// A second effect has to be larger than what the solver's step makes of it, too.
bool IsNothing(const Study& study, const Fit& fit, std::size_t effect);

/// What a search may move.
enum class Moves { kAll, kDoubts };

class Fitter {
 public:
  Fitter(const Study& study, Whitener whitener) : study_(study), whitener_(std::move(whitener)) {}

  const Whitener& whitener() const { return whitener_; }

  /// The doubts alone, at given effects.
  Fit Evaluate(const std::vector<Assumed>& effects, const DoubtModel& doubts) const;
  Fit Evaluate(const std::vector<Assumed>& effects, const DoubtModel& doubts, const Projection& projection) const;
  /// From the effects as given, within the bounds.
  Fit Optimise(const std::vector<Assumed>& effects, const DoubtModel& doubts, int iterations = 12) const;
  /// Effects and doubts together, until nothing changes (or `rounds` steps): each is simulated, and shortened where it
  /// went too far, because a resonance that moves by its own width is not linear any more. `held`: the parameter of
  /// all effects, in order, that stays as it is.
  Fit Polish(Fit fit, int rounds, Moves moves = Moves::kAll, std::optional<Eigen::Index> held = std::nullopt) const;
  /// The same fit under this whitener, without another simulation.
  void Weigh(Fit& fit) const;
  /// Jacobian and covariance of a fit; the covariance is that of white residuals (what the whitener makes of them).
  void Derive(Fit& fit) const;

 private:
  const Study& study_;
  Whitener whitener_;
};

/// Polished under its own noise as long as there is anything to gain: an interval about a place that is not the best
/// one would be none.
Fit ToItsPlace(const Study& study, Fit fit);

}  // namespace dynoproof::diagnosis
