// The noise of the sensors: its colour as an autoregressive model by channel (Ljung, System Identification, section 4.2), and
// the level that the highest frequencies of a signal show.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace dynoproof::identification {

/// e[i] = sum_k a[k] e[i-1-k] + sigma n[i], n white with variance 1.
struct ArModel {
  std::vector<double> a;
  double sigma = 1.0;
};
/// Burg's method; `order` is cut to a tenth of the record. A residual of zeros gets the smallest sigma that divides.
ArModel FitAr(const Eigen::Ref<const Eigen::VectorXd>& residual, int order);

/// Root mean square of the rows of a channel. Unit of the residual.
double RmsOf(const Eigen::Ref<const Eigen::VectorXd>& rows);
/// Standard deviation of white noise that would give the spectrum between 0.7 and 0.95 of the Nyquist frequency, where
/// no drive line moves; the median over the bins, so that tones do not count. Unit of the residual.
double HighFrequencyFloor(const Eigen::Ref<const Eigen::VectorXd>& residual);

/// A signal without its mean and straight trend. Neither is noise: an offset that counted as colour would never be seen
/// again.
Eigen::VectorXd WithoutTrend(const Eigen::Ref<const Eigen::VectorXd>& x);
/// Squared magnitudes of the discrete Fourier transform at the bins 1 ... n/2 - 1, the mean removed.
std::vector<double> Periodogram(const Eigen::Ref<const Eigen::VectorXd>& x);

}  // namespace dynoproof::identification
