#include "control10k/classical.h"

#include <cmath>
#include <type_traits>

namespace control10k {
namespace {

constexpr double kForget = 0.99;  // means over 100 samples

static_assert(std::is_trivially_copyable_v<ClassicalState> && sizeof(ClassicalState) % sizeof(double) == 0);

}  // namespace

bool IsUsable(const ClassicalConfig& c) {
  const double nyquist = 0.5 / c.period_s;
  return c.period_s > 0.0 && c.notches >= 1 && c.notches <= kMaxNotches && c.radius > 0.0 && c.radius < 1.0 &&
         c.lowest_Hz > 0.0 && c.lowest_Hz < c.highest_Hz && c.highest_Hz * c.spread < nyquist && c.initial_Hz > 0.0 &&
         c.initial_Hz >= c.lowest_Hz && c.initial_Hz <= c.highest_Hz && c.mu >= 0.0 && c.increment_Hz >= 0.0 &&
         c.damping > 0.0 && c.spread > 1.0 && c.window >= 1 && c.window <= kMaxWindow;
}

void Classical::Start(ClassicalState& state) const {
  state = {};
  for (ClassicalNotch& notch : state.notch) notch.nu_0 = kTwoPi * config_.initial_Hz * config_.period_s;
}

double Classical::Change(ClassicalNotch& n, double u, double y) const {
  const double mu = config_.mu;
  n.power = kForget * n.power + (1.0 - kForget) * u * u;
  const double scale = n.power > 1e-12 ? 1.0 / n.power : 0.0;
  double low = 0.0, band = 0.0;
  switch (config_.law) {
    case ClassicalLaw::kComplexGradient: {
      // v = (e^(j nu_0) / z - r) / (1 - r e^(j nu_0) / z) u with the state w = v + r u of the last sample, turned.
      const double c = std::cos(n.nu_0), s = std::sin(n.nu_0), r = config_.radius;
      const double turned_re = c * n.z_re - s * n.z_im, turned_im = s * n.z_re + c * n.z_im;
      const double v_re = turned_re - r * u, v_im = turned_im;
      n.z_re = u + r * v_re;
      n.z_im = r * v_im;
      return -mu * 0.5 * v_im * u * scale;  // Im[y conj(u)], y = (u - v) / 2
    }
    case ClassicalLaw::kContinuousGradient:
      n.low.Step(u, std::tan(0.5 * n.nu_0), config_.damping, low, band);
      return -mu * n.nu_0 * low * (u - 2.0 * config_.damping * band) * scale;
    case ClassicalLaw::kBalance:
      n.low.Step(u, std::tan(0.5 * n.nu_0), config_.damping, low, band);
      n.low_level = kForget * n.low_level + (1.0 - kForget) * std::abs(low);
      n.band_level = kForget * n.band_level + (1.0 - kForget) * std::abs(band);
      if (!(n.low_level + n.band_level > 0.0)) return 0.0;
      return -mu * n.nu_0 * (n.low_level - n.band_level) / (n.low_level + n.band_level);
    case ClassicalLaw::kLms: {
      const double r = config_.radius, c = std::cos(n.nu_0), s = std::sin(n.nu_0);
      // Here u1, y1 are the samples before u and y: the caller shifts them afterwards.
      const double beta = 2.0 * s * n.u1 - 2.0 * r * s * n.y1 + 2.0 * r * c * n.beta1 - r * r * n.beta2;
      n.beta2 = n.beta1;
      n.beta1 = beta;
      return -2.0 * mu * y * beta;
    }
    case ClassicalLaw::kBandPassPair: {
      double low_band = 0.0, high_band = 0.0;
      n.low.Step(u, std::tan(0.5 * n.nu_0 / config_.spread), config_.damping, low, low_band);
      n.high.Step(u, std::tan(0.5 * n.nu_0 * config_.spread), config_.damping, low, high_band);
      const int place = static_cast<int>(n.place);
      const double square = high_band * high_band - low_band * low_band;
      n.squares[place] = square;
      n.place = place + 1 < config_.window ? place + 1.0 : 0.0;
      n.sum = 0.0;
      for (int i = 0; i < config_.window; ++i) n.sum += n.squares[i];  // summed anew: no drift
      return kTwoPi * config_.increment_Hz * config_.period_s * (n.sum > 0.0 ? 1.0 : n.sum < 0.0 ? -1.0 : 0.0);
    }
  }
  return 0.0;
}

double Classical::Step(ClassicalState& state, double T_shaft_Nm, bool adapt) const {
  const double r = config_.radius, to_nu = kTwoPi * config_.period_s;
  double signal = T_shaft_Nm;
  for (int i = 0; i < config_.notches; ++i) {
    ClassicalNotch& n = state.notch[i];
    // The filter of (5.8), scaled to gain 1 at zero frequency only where it leaves: adaptation sees (5.8) itself.
    const double c = std::cos(n.nu_0);
    const double y = signal - 2.0 * c * n.u1 + n.u2 + 2.0 * r * c * n.y1 - r * r * n.y2;
    const double change = adapt ? Change(n, signal, y) : 0.0;
    n.u2 = n.u1;
    n.u1 = signal;
    n.y2 = n.y1;
    n.y1 = y;
    const double K = (1.0 + r * r - 2.0 * r * c) / (2.0 - 2.0 * c);
    signal = K * y;
    const double next = n.nu_0 + change, lowest = to_nu * config_.lowest_Hz, highest = to_nu * config_.highest_Hz;
    n.nu_0 = next < lowest ? lowest : next > highest ? highest : next;
  }
  return signal;
}

}  // namespace control10k
