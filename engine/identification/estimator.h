// Fits a hypothesis to the records by its free-run error. Effect parameters are found by Levenberg-Marquardt (Ceres)
// within their bounds; the nuisance parameters follow linearly at each step (variable projection), so that an
// evaluation costs one simulation however many nuisance parameters there are.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "identification/estimation_problem.h"
#include "identification/noise_model.h"

namespace dynoproof::identification {

/// How the nuisance parameters of a problem enter: linearised about a point. Columns of fixed nuisance parameters are
/// left out.
struct NuisanceModel {
  std::vector<double> z0;       // where
  std::vector<double> freedom;  // by nuisance parameter: prior standard deviation in units of its spread; 0: fixed
  std::vector<int> free;        // the nuisance parameters with a column
  Eigen::VectorXd predicted;    // there
  Eigen::MatrixXd jacobian;     // d predicted / d z
};
/// Step of their differences, in spreads. Sharp resonances ring for a second: 1e-6 of a stiffness turns their phase by
/// some 0.005 rad in that time: linear; and it stands far above the round-off of a free run.
inline constexpr double kNuisanceStep = 1e-4;
/// The nuisance parameters that have a column.
std::vector<int> FreeOf(const std::vector<double>& freedom);
/// Forward differences about `at`, one simulation a free nuisance parameter.
Result<NuisanceModel> LineariseNuisances(const EstimationProblem& problem, const Hypothesis& at,
                                         std::vector<double> freedom);
/// Whether an effect changes what the nominal values are values of, and sets them free.
bool ChangesStructure(const EffectInstance& instance);
/// The usual freedom of the nuisance parameters under a set of effects: 1; 0 for a number that an effect changes
/// itself, and for dampings that are nominally zero; wide where an effect changes the structure.
std::vector<double> FreedomOf(const EstimationProblem& problem, const std::vector<EffectInstance>& effects);

/// The projection onto the nuisance parameters: for a whitened error it gives the nuisance parameters that fit best,
/// and what is left.
class Projection {
 public:
  Projection(const NuisanceModel& nuisances, const Whitener& whitener);

  /// Shift of the free nuisance parameters for a whitened error.
  Eigen::VectorXd Shift(const Eigen::VectorXd& error) const;
  /// The error without its part along the nuisance parameters, then the nuisance parameters over their prior.
  Eigen::VectorXd Residual(const Eigen::VectorXd& error, const Eigen::VectorXd& shift) const;
  /// A whitened signature without what the nuisance parameters can mimic: how Residual() falls as the signature grows.
  /// The last rows are the nuisance parameters over their prior; without them a signature that a nuisance parameter
  /// mimics at a price would seem to be none.
  Eigen::VectorXd Free(const Eigen::VectorXd& white) const;
  double log_det() const { return log_det_; }

 private:
  Eigen::MatrixXd white_;
  Eigen::VectorXd prior_, centre_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  double log_det_ = 0.0;
};

struct Estimate {
  Hypothesis hypothesis;
  NuisanceModel nuisances;
  Eigen::VectorXd
      predicted;         // simulated; Evaluate() and Optimise() add the linear shift of the nuisance parameters instead
  double log_det = 0.0;  // of the nuisance parameters: what their freedom costs
  double chi2 = 0.0;     // whitened squares, and the nuisance parameters' prior
  double criterion = 0.0;  // -2 log evidence: chi2 + log det of the nuisance parameters + p log n
  int simulations = 0;
  bool settled = false;  // Refine() came to an end before its rounds did
  std::string broken;    // why there is no fit
  /// By parameter of all effects in order, then by free nuisance parameter: whitened Jacobian at the optimum. Filled by
  /// Derive().
  Eigen::MatrixXd jacobian;
  Eigen::MatrixXd covariance;

  bool ok() const { return broken.empty(); }
  std::string Name() const;
  int parameters() const;
  /// Of a parameter of all effects, in order; after Derive().
  double StandardDeviation(Eigen::Index parameter) const;
};

/// Whether an effect changes the very number that a nuisance parameter is about.
bool Changes(const EffectInstance& instance, const Nuisance& nuisance);
/// A hypothesis as it stands, simulated; its nuisance parameters are not linearised and nothing is weighed yet.
Estimate EstimateAt(const EstimationProblem& problem, Hypothesis hypothesis);
/// Gives an estimate on `to` the derivatives that another point of `from` has: `to` is the same records or their first
/// part. Without a column for one of its free nuisance parameters it gets none.
void TakeSlopes(const EstimationProblem& from, const NuisanceModel& known, const EstimationProblem& to, Estimate& fit);
/// The noise's colour, as what a fit leaves has it; `order` 0: white.
Whitener WhitenerOf(const EstimationProblem& problem, const Estimate& fit, int order = Whitener::kOrder);
/// What the nuisance parameters of a fit cost by their prior.
double PriorChi2(const Estimate& fit);
/// An effect of the fit that changes the nuisance parameter's own number, in standard deviations of its prior.
std::optional<double> AsNuisance(const Nuisance& nuisance, const Estimate& fit);
/// Largest deviation of a nominal value, in the prior standard deviations that the hypothesis allows; starts do not count.
double LargestDeviation(const EstimationProblem& problem, const Estimate& fit);

inline constexpr double kTwoSided95 = 1.959964;  // standard deviations
/// How far the optimum may lie off for the solver's step, by parameter of all effects: twice what half the step
/// changes, as far as that is linear. Of a fit with its covariance.
Eigen::VectorXd SolverBias(const EstimationProblem& problem, const Estimate& fit);
/// Whether no strength of effect number `effect` has a 95 % interval that leaves out the neutral value: what is gained
/// then comes from computing the nominal model another way. Of a fit with its covariance; false for effects without
/// strengths.
/// A second effect has to be larger than what the solver's step makes of it, too.
bool IsNothing(const EstimationProblem& problem, const Estimate& fit, std::size_t effect);

/// What a search may move.
enum class Moves { kAll, kNuisances };
/// Where its first derivatives come from: differences at the start, or for the nuisance parameters what the estimate
/// holds of a point near by (TakeSlopes). Known ones cost no simulation; where they foretell too little, differences
/// replace them.
enum class Slopes { kDifferences, kKnown };
struct RefineOptions {
  Moves moves = Moves::kAll;
  std::optional<Eigen::Index> held = std::nullopt;  // the parameter of all effects, in order, that stays as it is
  Slopes slopes = Slopes::kDifferences;
};

class Estimator {
 public:
  Estimator(const EstimationProblem& problem, Whitener whitener) : problem_(problem), whitener_(std::move(whitener)) {}

  const Whitener& whitener() const { return whitener_; }

  /// The nuisance parameters alone, at given effects.
  Estimate Evaluate(const std::vector<EffectInstance>& effects, const NuisanceModel& nuisances) const;
  Estimate Evaluate(const std::vector<EffectInstance>& effects, const NuisanceModel& nuisances,
                    const Projection& projection) const;
  /// From the effects as given, within the bounds.
  Estimate Optimise(const std::vector<EffectInstance>& effects, const NuisanceModel& nuisances,
                    int iterations = 12) const;
  /// Effects and nuisance parameters together, until nothing changes (or `rounds` steps): each is simulated, and
  /// shortened where it went too far, because a resonance that moves by its own width is not linear any more.
  Estimate Refine(Estimate fit, int rounds, const RefineOptions& options = {}) const;
  /// The same fit under this whitener, without another simulation.
  void Score(Estimate& fit) const;
  /// Jacobian and covariance of a fit; the covariance is that of white residuals (what the whitener makes of them).
  void Derive(Estimate& fit) const;

 private:
  const EstimationProblem& problem_;
  Whitener whitener_;
};

/// Alternates noise model and refinement until chi2 improves no further: an interval is valid only at the optimum.
Estimate Converged(const EstimationProblem& problem, Estimate fit);

}  // namespace dynoproof::identification
