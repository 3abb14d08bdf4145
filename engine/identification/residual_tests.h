// Residual analysis (Ljung, System Identification, section 16.6): what is left of a record must be noise, which is independent
// of the inputs, has no line in its spectrum, and is no larger than sensors make it.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "identification/estimation_problem.h"

namespace dynoproof::identification {

/// P value of the Ljung-Box statistic over the first `lags` autocorrelations of the residuals `w` of a model with
/// `fitted` coefficients: chi-squared with lags - fitted degrees of freedom, lags > fitted. Nothing for fewer than four
/// rows a lag, and for zeros.
std::optional<double> LjungBoxPValue(const Eigen::VectorXd& w, int lags, int fitted);

/// What is not noise in the residual of one channel.
struct Structure {
  std::string signal;
  bool tested = false;     // false: too short, or no more than the rounding of the simulations; the rest says nothing
  double explained = 0.0;  // share of the whitened variance that functions of inputs and outputs predict
  double p_value = 1.0;    // of that share (F test), corrected for the number of features
  double line_p_value = 1.0;  // of the highest line of the whitened spectrum (Fisher's g test)
  double line_hz = 0.0;
  double line_share = 0.0;                  // of the whitened variance
  std::optional<double> ljung_box_p_value;  // of the whitened residual; not part of found(), see there
  double rings = 1.0;                       // variance of the residual over that of its one-step prediction error
  double over_floor = 1.0;                  // RMS of the residual over HighFrequencyFloor()
  double bursts = 3.0;                      // kurtosis of that prediction error; of a sensor's noise 3
  double size = 0.0;                        // RMS of the residual over the signal's spread

  bool FollowsInputs() const { return p_value < 1e-6 && explained > (bursts > 3.3 ? 0.003 : 0.01); }
  bool HasLine() const { return line_p_value < 1e-6 && line_share > 0.005; }
  /// Above chance by far, and not so small that it cannot matter: with 1e5 samples everything is significant. Less will
  /// do where the rest comes in bursts, as impacts leave them and sensors do not.
  /// Whiteness does not decide: an output-error model is right when its residual is independent of the inputs, whatever
  /// the noise's colour.
  bool found() const { return FollowsInputs() || HasLine() || TooLarge(); }
  /// Which of the tests found something, with their numbers: "T_shaft has a line at 97.4 Hz". Empty: none did.
  std::string Text() const;
  /// Follows from its own past nearly without error, as a resonance of the machine does, or is far larger than the
  /// highest frequencies allow. Sensors' noise is not: of a first-order lag with 20 samples (pole 0.95) it is 10 times
  /// its prediction error in variance, and 6 times the floor. What is no number is too large.
  bool TooLarge() const { return !(rings <= 30.0 && over_floor <= 12.0) && !(size <= 1e-3); }
};
bool AnyFound(const std::vector<Structure>& structure);
/// The texts of all channels in which something was found.
std::string TextOf(const std::vector<Structure>& structure);
/// Regresses the one-step prediction error of every channel on what noise cannot know: the inputs, the predicted
/// outputs, their past, squares, magnitudes and signs.
std::vector<Structure> FindStructure(const EstimationProblem& problem, const Eigen::VectorXd& residual,
                                     const Eigen::VectorXd& predicted);

/// The tests of the residual, each with its least p value over the signals; absent where no signal could be tested.
struct ResidualTests {
  static constexpr double kLevel = 1e-3;     // a hypothesis with a smaller p value is rejected
  std::optional<double> ljung_box_p_value;   // that the residual after its autoregressive noise model is white
  std::optional<double> regression_p_value;  // F test: that it is independent of inputs, predicted outputs, their past
  std::optional<double> line_p_value;        // Fisher's g test: that its spectrum has no line
  std::optional<bool> white() const { return Holds(ljung_box_p_value); }
  std::optional<bool> independent_of_inputs() const { return Holds(regression_p_value); }

 private:
  static std::optional<bool> Holds(const std::optional<double>& p) {
    return p ? std::optional(*p > kLevel) : std::nullopt;
  }
};
ResidualTests TestsOf(const std::vector<Structure>& structure);

}  // namespace dynoproof::identification
