// Candidate of candidates.h: the two started from other values, so their difference decays.
#include "score/start_value.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>

#include "score/fft.h"

namespace dynoproof::score {
namespace {

using std::numbers::pi;

struct Mode {
  double decay = 0.0;       // per sample
  double omega = 0.0;       // rad per sample; 0: a plain exponential
  double a = 0.0, b = 0.0;  // exp(-decay i) (a cos(omega i) + b sin(omega i))
};

// The next sample of a damped phasor, written out: the library's product also looks after infinities, at ten times the
// cost.
std::complex<double> Next(std::complex<double> z, std::complex<double> factor) {
  return {z.real() * factor.real() - z.imag() * factor.imag(), z.real() * factor.imag() + z.imag() * factor.real()};
}

// Least squares of a and b; returns the sum of squares left, of which `total` was there.
double FitAmplitudes(std::span<const double> r, double total, Mode& mode) {
  const std::complex<double> factor = std::exp(std::complex<double>(-mode.decay, mode.omega));
  std::complex<double> z = 1.0;
  double cc = 0.0, cs = 0.0, ss = 0.0, rc = 0.0, rs = 0.0;
  for (double value : r) {
    const double c = z.real(), s = z.imag();
    cc += c * c;
    cs += c * s;
    ss += s * s;
    rc += value * c;
    rs += value * s;
    z = Next(z, factor);
    if (std::norm(z) < 1e-32) break;  // decayed below round-off
  }
  const double determinant = cc * ss - cs * cs;
  if (mode.omega == 0.0 || !(determinant > 1e-12 * cc * ss)) {
    mode.a = cc > 0.0 ? rc / cc : 0.0;
    mode.b = 0.0;
    return total - mode.a * rc;
  }
  mode.a = (rc * ss - rs * cs) / determinant;
  mode.b = (rs * cc - rc * cs) / determinant;
  return total - mode.a * rc - mode.b * rs;
}

void AddTo(std::vector<double>& r, const Mode& mode, double sign) {
  const std::complex<double> factor = std::exp(std::complex<double>(-mode.decay, mode.omega));
  std::complex<double> z = 1.0;
  for (double& value : r) {
    value += sign * (mode.a * z.real() + mode.b * z.imag());
    z = Next(z, factor);
  }
}

// Shrinking pattern search over the logarithm of the decay and the frequency.
double Polish(std::span<const double> r, double total, Mode& mode, double omega_reach) {
  double best = FitAmplitudes(r, total, mode);
  double decay_step = 0.4, omega_step = mode.omega > 0.0 ? omega_reach : 0.0;
  const double slowest = 1.6 / Num(r.size());  // less decay over the record is no decay
  for (int round = 0; round < 60 && decay_step > 1e-7; ++round) {
    bool better = false;
    for (int k = 0; k < 4; ++k) {
      Mode trial = mode;
      if (k < 2) trial.decay *= std::exp(k == 0 ? decay_step : -decay_step);
      if (k >= 2) trial.omega += k == 2 ? omega_step : -omega_step;
      if (trial.decay < slowest || trial.decay > 3.0 || trial.omega < 0.0 || trial.omega > pi) continue;
      if (k >= 2 && omega_step == 0.0) continue;
      const double left = FitAmplitudes(r, total, trial);
      if (!(left < best)) continue;
      best = left;
      mode = trial;
      better = true;
    }
    if (!better) {
      decay_step *= 0.5;
      omega_step *= 0.5;
    }
  }
  return best;
}

// Best single mode of r: decays on a grid, frequencies zero or the spectrum's peak.
Mode BestMode(std::span<const double> r, bool ringing) {
  const double total = SumOfSquares(r);
  const std::size_t padded = std::bit_ceil(2 * r.size());
  double omega = 0.0;
  if (ringing) {
    std::vector<std::complex<double>> x(padded, 0.0);
    std::copy(r.begin(), r.end(), x.begin());
    x = Fft(x);
    std::size_t peak = 1;
    for (std::size_t k = 1; k < padded / 2; ++k)
      if (std::norm(x[k]) > std::norm(x[peak])) peak = k;
    omega = 2.0 * pi * Num(peak) / Num(padded);
  }
  Mode best;
  double least = total;
  for (double decay = 1.6 / Num(r.size()); decay < 2.0; decay *= 1.6) {
    Mode mode{decay, omega};
    const double left = FitAmplitudes(r, total, mode);
    if (left < least) {
      least = left;
      best = mode;
    }
  }
  if (best.decay > 0.0) Polish(r, total, best, 2.0 * pi / Num(padded));
  return best;
}

// Takes modes off one after the other, then lets each settle against the rest.
std::vector<Mode> Peel(const Pair& pair, int count, std::vector<double>& residual) {
  std::vector<Mode> modes;
  residual = pair.d;
  for (int k = 0; k < count; ++k) {
    const Mode mode = BestMode(residual, true);
    if (!(mode.decay > 0.0)) return modes;
    modes.push_back(mode);
    AddTo(residual, mode, -1.0);
  }
  for (int round = 0; round < 6 && count > 1; ++round) {
    for (Mode& mode : modes) {
      AddTo(residual, mode, 1.0);
      Polish(residual, SumOfSquares(residual), mode, 0.2 * mode.decay);
      AddTo(residual, mode, -1.0);
    }
  }
  return modes;
}

}  // namespace

void AddStartValue(const Pair& pair, const std::string& unit, Candidates& out) {
  // A cheap refusal: what decays has little left at the end, and never more than at the start.
  const std::span<const double> d(pair.d);
  const std::size_t quarter = d.size() / 4, block = d.size() / 10;
  if (SumOfSquares(d.last(quarter)) > 0.25 * SumOfSquares(d.first(quarter))) return;
  const double first = SumOfSquares(d.first(block));
  for (std::size_t b = 1; b < 10; ++b)
    if (SumOfSquares(d.subspan(b * block, block)) > 1.2 * first) return;
  for (int count = 0; count <= 3; ++count) {
    Candidate c;
    std::vector<Mode> modes;
    if (count == 0) {
      modes = {BestMode(pair.d, false)};
      c.residual = pair.d;
      AddTo(c.residual, modes[0], -1.0);
    } else {
      modes = Peel(pair, count, c.residual);
    }
    if (modes.empty() || !(modes[0].decay > 0.0)) continue;
    c.cause = Cause::kStartValue;
    c.complexity = count == 0 ? 2 : 4 * count;
    c.unexplained = SumOfSquares(c.residual) / pair.difference_square;
    double start = 0.0, slowest = modes[0].decay;
    for (const Mode& mode : modes) {
      start += mode.a;
      slowest = std::min(slowest, mode.decay);
    }
    c.quantities.push_back({"start_difference", start, unit});
    c.quantities.push_back({"time_constant", pair.step_s / slowest, "s"});
    c.text = fmt::format("another start value: a difference of {:.4g}{}{} decays with a time constant of {:.4g} s",
                         start, unit.empty() ? "" : " ", unit, pair.step_s / slowest);
    if (count > 0) c.quantities.push_back({"frequency", modes[0].omega / (2.0 * pi * pair.step_s), "Hz"});
    // Another mode pays only where the ones so far are on the way.
    const bool enough = c.unexplained<0.02, hopeless = count> 0 && c.unexplained > 0.7 - 0.2 * count;
    out.push_back(std::move(c));
    if (enough || hopeless) return;
  }
}

}  // namespace dynoproof::score
