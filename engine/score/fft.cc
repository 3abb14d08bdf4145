#include "score/fft.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <unsupported/Eigen/FFT>

namespace dynoproof::score {
namespace {

using Complex = std::complex<double>;

bool IsSmooth(std::size_t n) {
  if (n < 2) return true;
  for (std::size_t p : {2, 3, 5, 7})
    while (n % p == 0 && n > 1) n /= p;
  return n == 1;
}

/// Of real or complex samples, where their number has small factors alone. A fit transforms thousands of series of one length: the
/// factors of the last one are kept.
template <typename Scalar>
std::vector<Complex> Smooth(std::span<const Scalar> x) {
  struct Plan {
    std::size_t length = 0;
    Eigen::FFT<double> fft;
  };
  thread_local Plan plan;
  if (plan.length != x.size()) plan = {x.size(), {}};
  if (x.size() < 2) return {x.begin(), x.end()};
  std::vector<Complex> out(x.size());
  plan.fft.fwd(out.data(), x.data(), static_cast<Eigen::Index>(x.size()));
  return out;
}

/// The least power of two, or three or five times one, that is not below n: a transform takes more odd factors ill.
std::size_t LengthAbove(std::size_t n) {
  return std::min({std::bit_ceil(n), 3 * std::bit_ceil((n + 2) / 3), 5 * std::bit_ceil((n + 4) / 5)});
}

/// What Bluestein's transform needs of a length alone.
struct Chirp {
  explicit Chirp(std::size_t n) : of_sample(n), spectrum(LengthAbove(2 * n - 1)) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t square = i * i % (2 * n);  // exact: a large angle would lose its digits
      of_sample[i] = std::polar(1.0, -std::numbers::pi * static_cast<double>(square) / static_cast<double>(n));
    }
    spectrum[0] = std::conj(of_sample[0]);
    for (std::size_t i = 1; i < n; ++i) spectrum[i] = spectrum[spectrum.size() - i] = std::conj(of_sample[i]);
    spectrum = Smooth<Complex>(spectrum);
  }
  std::vector<Complex> of_sample, spectrum;
};

// kn = (k^2 + n^2 - (k - n)^2) / 2 turns the transform into a convolution, whose length is free.
std::vector<Complex> Bluestein(std::span<const Complex> x) {
  const std::size_t n = x.size();
  thread_local std::optional<Chirp> kept;
  if (!kept || kept->of_sample.size() != n) kept.emplace(n);
  const Chirp& chirp = *kept;
  const std::size_t padded = chirp.spectrum.size();
  std::vector<Complex> a(padded);
  for (std::size_t i = 0; i < n; ++i) a[i] = x[i] * chirp.of_sample[i];
  a = Smooth<Complex>(a);
  // The inverse is the conjugate of the transform of the conjugate.
  for (std::size_t i = 0; i < padded; ++i) a[i] = std::conj(a[i] * chirp.spectrum[i]);
  a = Smooth<Complex>(a);
  std::vector<Complex> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = std::conj(a[i]) * chirp.of_sample[i] / static_cast<double>(padded);
  return out;
}

}  // namespace

std::vector<Complex> Fft(std::span<const Complex> x) { return IsSmooth(x.size()) ? Smooth(x) : Bluestein(x); }

std::vector<Complex> Fft(std::span<const double> x) {
  if (IsSmooth(x.size())) return Smooth(x);
  return Bluestein(std::vector<Complex>(x.begin(), x.end()));
}

std::vector<Complex> InverseFft(std::span<const Complex> spectrum) {
  std::vector<Complex> x(spectrum.begin(), spectrum.end());
  for (Complex& value : x) value = std::conj(value);
  x = Fft(x);
  for (Complex& value : x) value = std::conj(value) / static_cast<double>(spectrum.size());
  return x;
}

std::vector<double> CrossCorrelation(std::span<const double> a, std::span<const double> b, std::size_t max_lag) {
  const std::size_t padded = std::bit_ceil(std::max(a.size(), b.size()) + max_lag + 1);
  std::vector<Complex> fa(padded), fb(padded);
  for (std::size_t i = 0; i < a.size(); ++i) fa[i] = a[i];
  for (std::size_t i = 0; i < b.size(); ++i) fb[i] = b[i];
  fa = Fft(fa);
  fb = Fft(fb);
  for (std::size_t i = 0; i < padded; ++i) fa[i] = std::conj(fa[i]) * fb[i];
  fa = InverseFft(fa);
  std::vector<double> out(2 * max_lag + 1);
  for (std::size_t l = 0; l <= max_lag; ++l) {
    out[max_lag + l] = fa[l].real();
    if (l > 0) out[max_lag - l] = fa[padded - l].real();
  }
  return out;
}

}  // namespace dynoproof::score
