// Candidate of candidates.h: one resonance of the plant moved or changed its damping between reference and test.
//
//   test = k F(reference),  F = [1 - 2 r0 cos(t0) z^-1 + r0^2 z^-2] / [1 - 2 r1 cos(t1) z^-1 + r1^2 z^-2], scaled to
//   F(1) = 1
//
// takes the old pole pair out of the reference and puts the new one in. For a plant with well separated modes the ratio
// of the two responses near the mode is just that, whatever the excitation was.
#include "score/resonance.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "score/fft.h"
#include "score/residual_tests.h"

namespace dynoproof::score {
namespace {

using std::numbers::pi;
using Parameters = Eigen::Vector4d;  // ln omega0, ln zeta0, ln omega1, ln zeta1; omega in rad per sample

struct Quadratic {
  double c1, c2;
  Quadratic(double omega, double zeta) {
    const double r = std::exp(-zeta * omega);
    c1 = -2.0 * r * std::cos(omega * std::sqrt(std::max(0.0, 1.0 - zeta * zeta)));
    c2 = r * r;
  }
};

// F(x), at rest on x[0] before the record starts.
Eigen::VectorXd Exchange(std::span<const double> x, const Parameters& p) {
  const Quadratic zero(std::exp(p[0]), std::exp(p[1])), pole(std::exp(p[2]), std::exp(p[3]));
  const double scale = (1.0 + pole.c1 + pole.c2) / (1.0 + zero.c1 + zero.c2);
  Eigen::VectorXd out(x.size());
  double x1 = 0.0, x2 = 0.0, y1 = 0.0, y2 = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = x[i] - x[0];
    const double y = scale * (u + zero.c1 * x1 + zero.c2 * x2) - pole.c1 * y1 - pole.c2 * y2;
    x2 = x1;
    x1 = u;
    y2 = y1;
    y1 = y;
    out(i) = y + x[0];
  }
  return out;
}

struct Fit {
  Parameters p;
  double gain = 1.0;
  double left = 0.0;  // sum of squares
  Eigen::VectorXd residual;
};

Fit Evaluate(std::span<const double> x, const Eigen::VectorXd& y, const Parameters& p) {
  Fit fit{p, 1.0, 0.0, {}};
  const Eigen::VectorXd f = Exchange(x, p);
  const double square = f.squaredNorm();
  fit.gain = square > 0.0 ? f.dot(y) / square : 0.0;
  fit.residual = y - fit.gain * f;
  fit.left = fit.residual.squaredNorm();
  if (!std::isfinite(fit.left)) fit.left = std::numeric_limits<double>::infinity();
  return fit;
}

enum class Free { kBoth, kFrequency, kDamping };

// The parameters that move for a unit step of each free direction.
Eigen::MatrixXd Directions(Free free) {
  Eigen::MatrixXd m;
  if (free == Free::kBoth) return Eigen::MatrixXd::Identity(4, 4);
  m = Eigen::MatrixXd::Zero(4, 3);
  if (free == Free::kFrequency) {
    m(0, 0) = m(2, 1) = m(1, 2) = m(3, 2) = 1.0;  // one damping ratio for both
  } else {
    m(0, 0) = m(2, 0) = m(1, 1) = m(3, 2) = 1.0;  // one frequency for both
  }
  return m;
}

bool Inside(const Parameters& p) {
  return p[0] < std::log(0.9 * pi) && p[2] < std::log(0.9 * pi) && p[1] < std::log(0.4) && p[3] < std::log(0.4) &&
         p[1] > std::log(1e-4) && p[3] > std::log(1e-4);
}

// Levenberg-Marquardt; the gain is eliminated in every evaluation.
Fit Descend(std::span<const double> x, const Eigen::VectorXd& y, const Parameters& start, Free free) {
  const Eigen::MatrixXd directions = Directions(free);
  Fit best = Evaluate(x, y, start);
  double damping = 1e-3;
  for (int iteration = 0; iteration < 40; ++iteration) {
    Eigen::MatrixXd jacobian(y.size(), directions.cols());
    for (int k = 0; k < directions.cols(); ++k) {
      const double step = 1e-6;
      jacobian.col(k) = (Evaluate(x, y, best.p + step * directions.col(k)).residual - best.residual) / step;
    }
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd slope = jacobian.transpose() * best.residual;
    bool moved = false;
    const double before = best.left;
    for (int attempt = 0; attempt < 8 && !moved; ++attempt) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() *= 1.0 + damping;
      damped.diagonal().array() += 1e-12 * normal.diagonal().maxCoeff();
      const Parameters trial = best.p - directions * damped.ldlt().solve(slope);
      if (trial.allFinite() && Inside(trial)) {
        Fit fit = Evaluate(x, y, trial);
        if (fit.left < best.left) {
          best = std::move(fit);
          damping = std::max(1e-9, 0.2 * damping);
          moved = true;
          continue;
        }
      }
      damping *= 6.0;
    }
    if (!moved || before - best.left < 1e-5 * before) break;
  }
  return best;
}

// Smoothed amplitude spectrum over rad per sample, for peaks that belong to resonances and not to single lines.
struct Smoothed {
  std::vector<double> level;
  double bin = 0.0;

  double Mean(double from, double to) const {
    const auto first = std::min(level.size() - 1, static_cast<std::size_t>(from / bin + 0.5));
    const auto last = std::min(level.size() - 1, static_cast<std::size_t>(to / bin + 0.5));
    return score::Mean(std::span<const double>(level).subspan(first, last - first + 1));
  }
};

Smoothed SmoothedSpectrum(std::span<const double> v) {
  const double mean = Mean(v);
  std::vector<std::complex<double>> x(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) x[i] = (v[i] - mean) * (1.0 - std::cos(2.0 * pi * Num(i) / Num(v.size())));
  x = Fft(x);
  const std::size_t half = v.size() / 2;
  std::vector<double> sums(half + 1, 0.0);
  for (std::size_t k = 0; k < half; ++k) sums[k + 1] = sums[k] + std::norm(x[k]);
  Smoothed out;
  out.bin = 2.0 * pi / Num(v.size());
  for (std::size_t k = 0; k < half; ++k) {
    const std::size_t reach = 2 + k / 100;  // a constant part of the frequency
    const std::size_t from = k > reach ? k - reach : 0, to = std::min(half, k + reach + 1);
    out.level.push_back(std::sqrt((sums[to] - sums[from]) / Num(to - from)));
  }
  return out;
}

// Up to `count` peaks (rad per sample) between two frequencies, strongest first.
std::vector<double> PeaksBetween(const Smoothed& s, double from, double to, std::size_t count) {
  std::vector<std::size_t> found;
  for (std::size_t k = 4; k + 4 < s.level.size(); ++k) {
    const double omega = s.bin * Num(k);
    if (omega < from || omega > to) continue;
    const std::size_t reach = 3 + k / 50, left = k > reach ? k - reach : 0,
                      right = std::min(s.level.size(), k + reach + 1);
    if (*std::max_element(s.level.begin() + left, s.level.begin() + right) == s.level[k]) found.push_back(k);
  }
  std::sort(found.begin(), found.end(), [&](std::size_t a, std::size_t b) { return s.level[a] > s.level[b]; });
  std::vector<double> out;
  for (std::size_t k : found)
    if (out.size() < count) out.push_back(s.bin * Num(k));
  return out;
}

// A resonance at omega stands 3 dB above the spectrum a fifth to a half further off, on both sides; band means, because
// the excitation may be noisy itself.
bool StandsOut(const Smoothed& s, double omega, double zeta) {
  const double width = std::clamp(zeta, 0.005, 0.1);
  const double off = std::max(0.2, 4.0 * zeta);
  const double top = s.Mean(omega * (1.0 - width), omega * (1.0 + width));
  return top > 1.41 * s.Mean(omega / (1.5 + off), omega / (1.0 + off)) &&
         top > 1.41 * s.Mean(omega * (1.0 + off), omega * (1.5 + off));
}

// Narrow-band signals have few degrees of freedom, and five parameters fit many of them by chance. So the fit to the
// first half of the difference's energy must also predict the second half.
bool Predicts(std::span<const double> x, const Eigen::VectorXd& y, std::span<const double> d, const Fit& fit,
              Free free) {
  double square = 0.0, sum = 0.0;
  for (double v : d) square += v * v;
  std::size_t half = 0;
  while (half < d.size() && sum < 0.5 * square) {
    sum += d[half] * d[half];
    ++half;
  }
  if (half < 64 || half + 16 > d.size()) return false;
  const Fit early = Descend(x.first(half), y.head(static_cast<Eigen::Index>(half)), fit.p, free);
  const Eigen::VectorXd predicted = early.gain * Exchange(x, early.p);
  const auto rest = static_cast<Eigen::Index>(d.size() - half);
  return (y - predicted).tail(rest).squaredNorm() < 0.08 * (square - sum);
}

// Either next to nothing is left, or what is left is white, and smaller than the response that was fitted.
bool Convinces(const Fit& fit, const Eigen::VectorXd& y, double square) {
  if (fit.left < 0.035 * square) return true;
  std::vector<double> centred(fit.residual.data(), fit.residual.data() + fit.residual.size());
  const double mean = Mean(centred);
  for (double& v : centred) v -= mean;
  return fit.left < 0.1 * square && 3.0 * fit.left < (y - fit.residual).squaredNorm() &&
         WhitenessScore(centred, 40) < 3.1;
}

constexpr std::size_t kLongest = 32768;  // samples that are fitted: those with the greatest difference

std::size_t WindowStart(std::span<const double> d) {
  if (d.size() <= kLongest) return 0;
  double sum = 0.0, best = -1.0;
  std::size_t start = 0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    sum += d[i] * d[i];
    if (i >= kLongest) sum -= d[i - kLongest] * d[i - kLongest];
    if (i + 1 >= kLongest && sum > best) {
      best = sum;
      start = i + 1 - kLongest;
    }
  }
  return start;
}

Fit BestFit(std::span<const double> x, const Eigen::VectorXd& y, const Smoothed& sx, const Smoothed& sy,
            double centre) {
  Fit best;
  best.left = std::numeric_limits<double>::infinity();
  std::vector<double> old_peaks = PeaksBetween(sx, 0.7 * centre, 1.4 * centre, 2);
  std::vector<double> new_peaks = PeaksBetween(sy, 0.7 * centre, 1.4 * centre, 2);
  for (double w0 : old_peaks) {
    for (double w1 : new_peaks) {
      for (double zeta : {0.008, 0.05}) {
        const Parameters start{std::log(w0), std::log(zeta), std::log(w1), std::log(zeta)};
        Fit fit = Descend(x, y, start, Free::kBoth);
        if (fit.left < best.left) best = std::move(fit);
      }
    }
  }
  return best;
}

}  // namespace

void AddResonance(const Pair& pair, Candidates& out) {
  const std::size_t start = WindowStart(pair.d), n = std::min(pair.d.size(), kLongest);
  const auto x = std::span<const double>(pair.x).subspan(start, n);
  const auto d = std::span<const double>(pair.d).subspan(start, n);
  const Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(pair.y.data() + start, static_cast<Eigen::Index>(n));
  if (n < 256) return;
  const Smoothed sx = SmoothedSpectrum(x), sy = SmoothedSpectrum({y.data(), n}), sd = SmoothedSpectrum(d);
  const std::vector<double> centre = PeaksBetween(sd, 8.0 * sd.bin, 0.8 * pi, 1);
  if (centre.empty()) return;
  const Fit full = BestFit(x, y, sx, sy, centre[0]);
  double square = 0.0;
  for (double v : d) square += v * v;
  if (!Convinces(full, y, square)) return;

  // Of the three statements the simpler ones count unless both parameters are needed.
  Fit chosen = full;
  Cause cause = Cause::kResonanceMoved;
  Free free = Free::kBoth;
  const double w0 = full.p[0], w1 = full.p[2], z0 = full.p[1], z1 = full.p[3], w = 0.5 * (w0 + w1), z = 0.5 * (z0 + z1);
  const Fit moved = Descend(x, y, {w0, z, w1, z}, Free::kFrequency);
  const Fit damped = Descend(x, y, {w, z0, w, z1}, Free::kDamping);
  const double enough = 1.3 * full.left + 1e-3 * square;
  if (damped.left <= enough && damped.left <= moved.left) {
    chosen = damped;
    cause = Cause::kDampingChanged;
    free = Free::kDamping;
  } else if (moved.left <= enough) {
    chosen = moved;
    free = Free::kFrequency;
  } else if (damped.left < 0.5 * moved.left) {
    cause = Cause::kDampingChanged;  // both changed; the damping did more of it
  }
  const double omega0 = std::exp(chosen.p[0]), omega1 = std::exp(chosen.p[2]);
  const double zeta0 = std::exp(chosen.p[1]), zeta1 = std::exp(chosen.p[3]);
  // A resonance, not a filter: it stands out before and after, is not gone by more than a quarter, and is no mere pole.
  if (!StandsOut(sx, omega0, zeta0) || !StandsOut(sy, omega1, zeta1)) return;
  if (std::abs(std::log(omega1 / omega0)) > std::log(1.25) || std::max(zeta0, zeta1) > 0.3 ||
      std::min(zeta0, zeta1) < 2e-4)
    return;
  if (!Convinces(chosen, y, square) || !Predicts(x, y, d, chosen, free)) return;

  Candidate c;
  c.cause = cause;
  c.complexity = 5;
  c.unexplained = chosen.left / square;
  c.structural = false;  // neighbouring modes leave something that follows the reference; the peaks were seen instead
  c.residual.assign(chosen.residual.data(), chosen.residual.data() + chosen.residual.size());
  c.first = start;
  const double to_hz = 1.0 / (2.0 * pi * pair.step_s);
  const Quantity old_f{"frequency_before", omega0 * to_hz, "Hz"}, new_f{"frequency", omega1 * to_hz, "Hz"};
  const Quantity old_z{"damping_ratio_before", zeta0, "1"}, new_z{"damping_ratio", zeta1, "1"};
  if (cause == Cause::kResonanceMoved) {
    c.quantities = {new_f, old_f, new_z, old_z};
    c.text = fmt::format("resonance moved from {:.5g} to {:.5g} Hz", old_f.value, new_f.value);
  } else {
    c.quantities = {new_z, old_z, new_f, old_f};
    c.text = fmt::format("damping ratio of the resonance at {:.5g} Hz changed from {:.4g} to {:.4g}", new_f.value,
                         zeta0, zeta1);
  }
  out.push_back(std::move(c));
}

}  // namespace dynoproof::score
