// What in a residual is noise: its colour as an autoregressive model, the floor that sensors set, and what is left that
// noise cannot be: a relation to the inputs, or a line in the spectrum.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/study.h"

namespace dynoproof::diagnosis {

/// e[i] = sum_k a[k] e[i-1-k] + sigma n[i], n white with variance 1.
struct ArModel {
  std::vector<double> a;
  double sigma = 1.0;
};
/// Burg's method; `order` is cut to a tenth of the record. A residual of zeros gets the smallest sigma that divides.
ArModel FitAr(const Eigen::Ref<const Eigen::VectorXd>& residual, int order);

/// One AR model a channel of a study. Whitened rows have variance 1 under the model; the first rows of a channel, which
/// have no complete past, become 0 and do not count.
class Whitener {
 public:
  static constexpr int kOrder = 30;  // resonances of a drive line below 2 kHz at 10 kHz: some ten pole pairs

  /// Fits to the residual of the best model so far; `order` 0: white. `least`: smallest sigma over the channel's
  /// spread; what a simulation is good for, so that synthetic records without noise do not ask for more digits than
  /// there are.
  Whitener(const std::vector<Channel>& channels, const Eigen::VectorXd& residual, int order = kOrder,
           double least = 1e-6);

  Eigen::VectorXd operator()(const Eigen::VectorXd& rows) const;
  /// Rows that count.
  double rows() const { return rows_; }
  const std::vector<ArModel>& models() const { return models_; }

 private:
  std::vector<Channel> channels_;
  std::vector<ArModel> models_;
  double rows_ = 0.0;
};

/// Root mean square of the rows of a channel. Unit of the residual.
double RmsOf(const Eigen::Ref<const Eigen::VectorXd>& rows);
/// Standard deviation of white noise that would give the spectrum between 0.7 and 0.95 of the Nyquist frequency, where
/// no drive line moves; the median over the bins, so that tones do not count. Unit of the residual.
double HighFrequencyFloor(const Eigen::Ref<const Eigen::VectorXd>& residual);

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
  /// its prediction error in variance, and 6 times the floor.
  bool TooLarge() const { return (rings > 30.0 || over_floor > 12.0) && size > 1e-3; }
};
bool AnyFound(const std::vector<Structure>& structure);
/// The texts of all channels in which something was found.
std::string TextOf(const std::vector<Structure>& structure);
/// Regresses the one-step prediction error of every channel on what noise cannot know: the inputs, the predicted
/// outputs, their past, squares, magnitudes and signs.
std::vector<Structure> FindStructure(const Study& study, const Eigen::VectorXd& residual,
                                     const Eigen::VectorXd& predicted);

}  // namespace dynoproof::diagnosis
