#include "thesis/landmarks.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>

#include "identification/noise_model.h"
#include "identification/step_spectrum.h"
#include "linear/symmetric_eigen.h"
#include "score/peaks.h"

namespace dynoproof::identification {
namespace {

constexpr double kProminence_dB = 6.0;
constexpr double kPeak = 0.95;  // coherence at a resonance: among hundreds of bins noise reaches kCoherent

std::string Because(const std::string& reason) { return reason.empty() ? "" : ": " + reason; }

std::size_t BinOf(const score::Response& response, double hz) {
  const auto at = std::lower_bound(response.frequency_hz.begin(), response.frequency_hz.end(), hz);
  return std::min(static_cast<std::size_t>(at - response.frequency_hz.begin()), response.frequency_hz.size() - 1);
}

/// The line without its dampings as a sum over its modes: G(w^2) = sum of share / (square - w^2), real. An output that
/// is a speed has the same zeros as its angle.
struct Undamped {
  Eigen::ArrayXd squares, shares;  // by mode, rising: squared angular eigenfrequency, part of the response

  explicit Undamped(const mechanics::TransferFunction& transfer) {
    const mechanics::Network& network = transfer.network();
    const Eigen::VectorXd root = network.Inertias().cwiseSqrt().cwiseInverse();
    mechanics::SymmetricEigen eigen =
        mechanics::SolveSymmetric(root.asDiagonal() * network.StiffnessMatrix() * root.asDiagonal());
    const Eigen::MatrixXd shapes = root.asDiagonal() * eigen.vectors;
    const auto index = static_cast<Eigen::Index>(transfer.output().index);
    const Eigen::RowVectorXd seen = transfer.output().kind == mechanics::OutputKind::kEdgeTorque
                                        ? Eigen::RowVectorXd(network.Incidence().row(index) * shapes)
                                        : Eigen::RowVectorXd(shapes.row(index));
    squares = eigen.values;
    shares = seen.transpose().array() * (shapes.transpose() * transfer.input()).array();
  }

  double At(double hz) const {
    const double w = 2.0 * std::numbers::pi * hz;
    return (shares / (squares - w * w)).sum();
  }

  /// Eigenfrequencies [Hz] without the rigid body's, rising.
  std::vector<double> Frequencies() const {
    constexpr double kRigid = 1e-12;  // of the largest: round-off of a zero
    std::vector<double> frequencies;
    for (const double square : squares) {
      if (square > kRigid * squares[squares.size() - 1])
        frequencies.push_back(std::sqrt(square) / (2.0 * std::numbers::pi));
    }
    return frequencies;
  }

  /// Zeros [Hz] where the response changes its sign between two neighbouring poles, from those that begin below
  /// `to_hz`: a pair of zeros within is not seen.
  std::vector<double> Zeros(std::vector<double> poles_hz, double to_hz) const {
    constexpr double kBeside = 1e-7;
    poles_hz.insert(poles_hz.begin(), 0.0);
    std::vector<double> zeros;
    for (std::size_t i = 1; i < poles_hz.size() && poles_hz[i - 1] < to_hz; ++i) {
      double low = std::max(poles_hz[i - 1] * (1.0 + kBeside), 1e-3 * poles_hz[i]);
      double high = poles_hz[i] * (1.0 - kBeside);
      if (low >= high || At(low) * At(high) >= 0.0) continue;
      for (const bool rising = At(high) > 0.0; high - low > 1e-12 * high;) {
        const double middle = 0.5 * (low + high);
        ((At(middle) > 0.0) == rising ? high : low) = middle;
      }
      zeros.push_back(0.5 * (low + high));
    }
    return zeros;
  }
};

/// Largest gain within a few percent of a frequency: a practical resonance (2.2.2), where there is one.
double GainNear(const mechanics::TransferFunction& transfer, double hz) {
  constexpr double kWithin = 0.03;
  const double at =
      boost::math::tools::brent_find_minima([&](double f) { return -std::log(std::abs(transfer.AtFrequency(f))); },
                                            hz * (1.0 - kWithin), hz * (1.0 + kWithin), 30)
          .first;
  return std::abs(transfer.AtFrequency(at));
}

class Resonances : public ResponseMisfit {
 public:
  Resonances(const EstimationProblem& problem, Landmarks measured)
      : ResponseMisfit(problem), measured_(std::move(measured)) {}

 protected:
  const Landmarks measured_;
};

class Frequencies : public Resonances {
 public:
  using Resonances::Resonances;
  Eigen::Index size() const override {
    return static_cast<Eigen::Index>(measured_.resonances_hz.size() + measured_.zeros_hz.size());
  }

 protected:
  Eigen::VectorXd ErrorOf(const mechanics::TransferFunction& model, double to_hz) const override {
    const Undamped undamped(model);
    const std::vector<double> modes = undamped.Frequencies(), zeros = undamped.Zeros(modes, to_hz);
    Eigen::VectorXd error(size());
    Eigen::Index row = 0;
    const auto compare = [&](const std::vector<double>& wanted, const std::vector<double>& offered) {
      const std::vector<int> chosen = Assigned(wanted, offered);
      for (std::size_t i = 0; i < wanted.size(); ++i)
        error[row++] = chosen[i] < 0 ? kMissing : std::log(wanted[i] / offered[static_cast<std::size_t>(chosen[i])]);
    };
    compare(measured_.resonances_hz, modes);
    compare(measured_.zeros_hz, zeros);
    return error;
  }
};

class Gains : public Resonances {
 public:
  using Resonances::Resonances;
  Eigen::Index size() const override { return static_cast<Eigen::Index>(measured_.gains.size()); }

 protected:
  Eigen::VectorXd ErrorOf(const mechanics::TransferFunction& model, double) const override {
    const std::vector<double> modes = Undamped(model).Frequencies();
    const std::vector<int> chosen = Assigned(measured_.resonances_hz, modes);
    Eigen::VectorXd error(size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const double gain = chosen[i] < 0 ? 0.0 : GainNear(model, modes[static_cast<std::size_t>(chosen[i])]);
      error[static_cast<Eigen::Index>(i)] = LogGain(measured_.gains[i] / gain);
    }
    return error;
  }
};

/// Whether the response changes its sign at a dip between two resonances, or between its begin and the first: two modes
/// that add up make a dip, too, but no zero. Seen half-way to either, where both have to be more than noise.
bool ChangesItsSign(const score::Response& response, double below_hz, double dip_hz, double above_hz) {
  const auto half_way = [&](double hz) { return BinOf(response, std::sqrt(hz * dip_hz)); };
  const std::size_t low = half_way(below_hz), high = half_way(above_hz);
  return std::min(response.coherence[low], response.coherence[high]) >= kCoherent &&
         std::real(response.gain[high] * std::conj(response.gain[low])) < 0.0;
}

/// The share of the output that is no noise, at each frequency of the response.
std::vector<double> ShareAboveNoise(const score::Response& response, const std::vector<double>& values, double step_s) {
  const Eigen::Map<const Eigen::VectorXd> rows(values.data(), static_cast<Eigen::Index>(values.size()));
  const double floor = HighFrequencyFloor(rows), seconds = step_s * static_cast<double>(rows.size());
  const std::vector<std::complex<double>> lines = StepLines(rows, values.size() - 1);
  constexpr std::ptrdiff_t kAround = 4;  // lines to either side, as the response is smoothed
  std::vector<double> share;
  for (const double hz : response.frequency_hz) {
    const auto middle = static_cast<std::ptrdiff_t>(std::lround(hz * seconds));
    double power = 0.0, count = 0.0;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(1, middle - kAround); k <= middle + kAround; ++k) {
      if (k >= static_cast<std::ptrdiff_t>(lines.size() / 2)) break;
      power += std::norm(lines[static_cast<std::size_t>(k)]), count += 1.0;
    }
    const double noise = count * StepNoisePower(rows.size(), floor, hz * step_s);
    share.push_back(power > 0.0 ? std::max(0.0, 1.0 - noise / power) : 0.0);
  }
  return share;
}

}  // namespace

Result<Landmarks> MeasuredLandmarks(const EstimationProblem& problem) {
  Result<MeasuredCurve> seen = MeasuredResponse(problem);
  if (!seen.ok()) return seen.failure();
  seen->response.coherence = ShareAboveNoise(seen->response, *seen->output, seen->step_s);
  // What is smoothed over four lines to either side makes one peak within them.
  const double line_hz = 1.0 / (seen->step_s * static_cast<double>(seen->output->size()));
  Result<Landmarks> landmarks = LandmarksOf(seen->response, 8.0 * line_hz);
  if (!landmarks.ok())
    return Failure{.message = landmarks.failure().message, .signal = problem.plan().id, .exit_code = 2};
  return landmarks;
}

Result<Landmarks> LandmarksOf(const score::Response& response, double apart_hz) {
  constexpr double kSmallest = 1e-3;  // of the highest peak: below, a sweep's ends ripple
  const score::PeakList found = score::FindPeaks(response.frequency_hz, response.Magnitude(), kProminence_dB);
  std::vector<score::Peak> peaks;
  for (const score::Peak& peak : found.peaks) {
    if (peak.kind == score::PeakKind::kResonance && response.coherence[BinOf(response, peak.frequency_hz)] >= kPeak)
      peaks.push_back(peak);
  }
  const auto lower = [](const score::Peak& a, const score::Peak& b) { return a.height < b.height; };
  Landmarks landmarks;
  if (peaks.empty()) return Failure{.message = "the measured response shows no resonance" + Because(found.reason)};
  const double highest = std::max_element(peaks.begin(), peaks.end(), lower)->height;
  for (const score::Peak& peak : peaks) {
    const bool first = std::none_of(peaks.begin(), peaks.end(), [&](const score::Peak& other) {
      return other.height > peak.height && std::abs(other.frequency_hz - peak.frequency_hz) < apart_hz;
    });
    if (!first || peak.height < kSmallest * highest) continue;
    landmarks.resonances_hz.push_back(peak.frequency_hz);
    landmarks.gains.push_back(peak.height);
  }
  // Of several dips between two resonances the deepest: the others are noise in it.
  double below_hz = response.frequency_hz.front();
  for (const double above_hz : landmarks.resonances_hz) {
    std::optional<score::Peak> zero;
    for (const score::Peak& dip : found.peaks) {
      if (dip.kind == score::PeakKind::kAntiResonance && dip.frequency_hz >= below_hz && dip.frequency_hz < above_hz &&
          ChangesItsSign(response, below_hz, dip.frequency_hz, above_hz) && (!zero || lower(dip, *zero)))
        zero = dip;
    }
    if (zero) landmarks.zeros_hz.push_back(zero->frequency_hz);
    below_hz = above_hz;
  }
  return landmarks;
}

std::vector<int> Assigned(const std::vector<double>& wanted, const std::vector<double>& offered) {
  // least[i][j]: of the first i wanted ones and the first j offered ones.
  const std::size_t n = wanted.size(), m = offered.size();
  std::vector<std::vector<double>> least(n + 1, std::vector<double>(m + 1, 0.0));
  const auto pair = [&](std::size_t i, std::size_t j) {
    return least[i - 1][j - 1] + std::abs(std::log(offered[j - 1] / wanted[i - 1]));
  };
  for (std::size_t i = 1; i <= n; ++i) {
    least[i][0] = kMissing * static_cast<double>(i);
    for (std::size_t j = 1; j <= m; ++j)
      least[i][j] = std::min({pair(i, j), least[i - 1][j] + kMissing, least[i][j - 1]});
  }
  std::vector<int> chosen(n, -1);
  for (std::size_t i = n, j = m; i > 0;) {
    if (j > 0 && least[i][j] == pair(i, j)) {
      chosen[--i] = static_cast<int>(--j);
    } else if (j > 0 && least[i][j] == least[i][j - 1]) {
      --j;
    } else {
      --i;
    }
  }
  return chosen;
}

std::unique_ptr<Objective> FrequencyObjective(const EstimationProblem& problem, Landmarks measured) {
  return std::make_unique<Frequencies>(problem, std::move(measured));
}
std::unique_ptr<Objective> GainObjective(const EstimationProblem& problem, Landmarks measured) {
  return std::make_unique<Gains>(problem, std::move(measured));
}

}  // namespace dynoproof::identification
