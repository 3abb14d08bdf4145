#include "plugins/physics/gas_flow.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace dynoproof::mechanics {
namespace {

double CriticalRatio(double kappa) { return std::pow(0.5 * (kappa + 1.0), kappa / (kappa - 1.0)); }

/// The piecewise straight line through (x, y) at `at`, held outside.
double Along(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (!(at > x.front())) return y.front();
  if (at >= x.back()) return y.back();
  const std::size_t i = std::upper_bound(x.begin(), x.end(), at) - x.begin();
  return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1]);
}

}  // namespace

double FlowFunction(double ratio) {
  return ratio >= 2.0 ? std::numbers::sqrt2 / 2.0 : std::sqrt(2.0 / ratio * (1.0 - 1.0 / ratio));
}

LaminarFlowFunction::LaminarFlowFunction(double delta) : delta_(delta) {
  assert(delta > 0.0 && delta < 1.0);
  const double ratio = 1.0 + delta, value = FlowFunction(ratio);
  const double slope = (2.0 - ratio) / (ratio * ratio * ratio * value);
  linear_ = (3.0 * value / delta - slope) / 2.0;
  cubic_ = (slope - value / delta) / (2.0 * delta * delta);
}

double IsentropicFlowFunction(double ratio, double kappa) {
  const double inverse = 1.0 / std::min(ratio, CriticalRatio(kappa));
  // x^(2/kappa) - x^((kappa+1)/kappa) = -x^(2/kappa) expm1((kappa-1)/kappa ln x): no digits lost near x = 1.
  const double part = -std::pow(inverse, 2.0 / kappa) * std::expm1((kappa - 1.0) / kappa * std::log(inverse));
  return std::sqrt(2.0 * kappa / (kappa - 1.0) * part);
}

double FlowFunctionDeviation(double kappa) {
  const double choked = FlowFunction(2.0) / IsentropicFlowFunction(CriticalRatio(kappa), kappa) - 1.0;
  double worst = std::abs(choked);
  for (double ratio = 1.0 + 1e-6; ratio < 3.0; ratio += 1e-3) {
    worst = std::max(worst, std::abs(FlowFunction(ratio) / IsentropicFlowFunction(ratio, kappa) - 1.0));
  }
  return worst;
}

double OrificeFlow(const Gas& gas, double area, double from, double to) {
  const double up = std::max(from, to), down = std::max(0.0, std::min(from, to));
  if (!(up > down)) return std::isnan(from) || std::isnan(to) ? std::nan("") : 0.0;
  if (area == 0.0) return 0.0;  // a leak that is none
  double flow;
  if (gas.isentropic) {
    flow =
        area * up / std::sqrt(gas.R * gas.theta) * IsentropicFlowFunction(down > 0.0 ? up / down : HUGE_VAL, gas.kappa);
  } else {
    // A p_up Psi(p_up/p_down) = A sqrt(2 p_down (p_up - p_down)): no digits lost near a ratio of 1.
    const double product = up >= 2.0 * down ? 0.5 * up * up : 2.0 * down * (up - down);
    flow = area * std::sqrt(product / (gas.R * gas.theta));
  }
  return from > to ? flow : -flow;
}

FlapArea FlapArea::Cosine(double offset, double span) {
  assert(offset >= 0.0 && span > 0.0);
  FlapArea area;
  area.offset_ = offset;
  area.span_ = span;
  return area;
}

FlapArea FlapArea::Table(std::vector<double> positions, std::vector<double> areas) {
  assert(positions.size() == areas.size() && positions.size() >= 2);
  FlapArea area;
  area.positions_ = std::move(positions);
  area.areas_ = std::move(areas);
  return area;
}

FlapArea FlapArea::Times(double factor) const {
  FlapArea scaled = *this;
  scaled.offset_ *= factor;
  scaled.span_ *= factor;
  for (double& area : scaled.areas_) area *= factor;
  return scaled;
}

double FlapArea::Area(double position) const {
  if (!positions_.empty()) return Along(positions_, areas_, position);
  const double half = std::sin(std::numbers::pi / 400.0 * std::clamp(position, 0.0, 100.0));
  return offset_ + 2.0 * span_ * half * half;  // 1 - cos x = 2 sin^2(x/2)
}

double FlapArea::Position(double area) const {
  if (!positions_.empty()) return Along(areas_, positions_, area);
  const double share = std::clamp((area - offset_) / (2.0 * span_), 0.0, 0.5);
  return 400.0 / std::numbers::pi * std::asin(std::sqrt(share));
}

}  // namespace dynoproof::mechanics
