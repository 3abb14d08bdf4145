// Signals with known properties for the tests of the scores.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "score/series.h"

namespace dynoproof::score {

inline constexpr double kPi = std::numbers::pi;

/// A signal that owns its arrays.
struct Signal {
  std::vector<double> t, v;
  Series View(Interpolation interpolation = Interpolation::kLinear) const { return {t, v, interpolation}; }
};

inline Signal Sampled(std::size_t n, double step_s, const std::function<double(double)>& law) {
  Signal s;
  for (std::size_t i = 0; i < n; ++i) {
    s.t.push_back(step_s * static_cast<double>(i));
    s.v.push_back(law(s.t.back()));
  }
  return s;
}

/// Everything that must never be judged, each made from a good signal.
struct Bad {
  std::string what;
  Signal signal;
};
inline std::vector<Bad> Gallery(const Signal& good) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::size_t middle = good.v.size() / 2;
  std::vector<Bad> out;
  const auto add = [&](const char* what, const std::function<void(Signal&)>& spoil) {
    Signal s = good;
    spoil(s);
    out.push_back({what, s});
  };
  add("NaN value", [&](Signal& s) { s.v[middle] = nan; });
  add("NaN first value", [&](Signal& s) { s.v.front() = nan; });
  add("NaN last value", [&](Signal& s) { s.v.back() = nan; });
  add("infinite value", [&](Signal& s) { s.v[middle] = inf; });
  add("minus infinite value", [&](Signal& s) { s.v[middle] = -inf; });
  add("overflowing value", [&](Signal& s) { s.v[middle] = 1e200; });
  add("NaN time", [&](Signal& s) { s.t[middle] = nan; });
  add("infinite time", [&](Signal& s) { s.t.back() = inf; });
  add("repeated time", [&](Signal& s) { s.t[middle] = s.t[middle - 1]; });
  add("falling time", [&](Signal& s) { std::swap(s.t[middle], s.t[middle - 1]); });
  add("empty", [&](Signal& s) { s = {}; });
  add("one sample", [&](Signal& s) {
    s.t.resize(1);
    s.v.resize(1);
  });
  add("more times than values", [&](Signal& s) { s.v.pop_back(); });
  add("more values than times", [&](Signal& s) { s.t.pop_back(); });
  return out;
}

/// A test that is sound but does not cover its reference.
inline std::vector<Bad> Uncovering(const Signal& good) {
  const auto n = static_cast<std::ptrdiff_t>(good.v.size());
  const auto cut = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
    Signal s = good;
    s.t.erase(s.t.begin() + from, s.t.begin() + to);
    s.v.erase(s.v.begin() + from, s.v.begin() + to);
    return s;
  };
  return {{"starts late", cut(0, 1)}, {"ends early", cut(n - 1, n)}, {"has a gap", cut(n / 2, n / 2 + 6)}};
}

/// One line, and not empty.
inline bool IsOneLine(const std::string& text) { return !text.empty() && text.find('\n') == std::string::npos; }

}  // namespace dynoproof::score
