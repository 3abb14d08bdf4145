#include "score/fft.h"

#include <bit>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace dynoproof::score {
namespace {

using Complex = std::complex<double>;

bool IsSmooth(std::size_t n) {
  for (std::size_t p : {2, 3, 5, 7})
    while (n % p == 0 && n > 1) n /= p;
  return n == 1;
}

std::vector<Complex> Smooth(std::vector<Complex> x) {
  if (x.size() < 2) return x;
  Eigen::FFT<double> fft;
  std::vector<Complex> out;
  fft.fwd(out, x);
  return out;
}

// kn = (k^2 + n^2 - (k - n)^2) / 2 turns the transform into a convolution, whose length is free.
std::vector<Complex> Bluestein(std::span<const Complex> x) {
  const std::size_t n = x.size();
  const std::size_t padded = std::bit_ceil(2 * n - 1);
  std::vector<Complex> chirp(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t square = i * i % (2 * n);  // exact: a large angle would lose its digits
    chirp[i] = std::polar(1.0, -std::numbers::pi * static_cast<double>(square) / static_cast<double>(n));
  }
  std::vector<Complex> a(padded), b(padded);
  for (std::size_t i = 0; i < n; ++i) a[i] = x[i] * chirp[i];
  b[0] = std::conj(chirp[0]);
  for (std::size_t i = 1; i < n; ++i) b[i] = b[padded - i] = std::conj(chirp[i]);
  a = Smooth(std::move(a));
  b = Smooth(std::move(b));
  for (std::size_t i = 0; i < padded; ++i) a[i] *= b[i];
  a = InverseFft(a);
  std::vector<Complex> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = a[i] * chirp[i];
  return out;
}

}  // namespace

std::vector<Complex> Fft(std::span<const Complex> x) {
  if (x.empty()) return {};
  return IsSmooth(x.size()) ? Smooth({x.begin(), x.end()}) : Bluestein(x);
}

std::vector<Complex> Fft(std::span<const double> x) {
  const std::vector<Complex> as_complex(x.begin(), x.end());
  return Fft(as_complex);
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
