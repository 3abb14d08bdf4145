// The discrete Fourier transform of any length in O(n log n), on top of Eigen's.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace dynoproof::score {

/// X[k] = sum_n x[n] exp(-2 pi j k n / N), k = 0 .. N-1. Lengths with a prime factor above 7 go through Bluestein's
/// chirp transform, because the underlying library needs O(n p) for a prime p.
std::vector<std::complex<double>> Fft(std::span<const std::complex<double>> x);
std::vector<std::complex<double>> Fft(std::span<const double> x);

/// x[n] = 1/N sum_k X[k] exp(+2 pi j k n / N).
std::vector<std::complex<double>> InverseFft(std::span<const std::complex<double>> spectrum);

/// c[l] = sum_n a[n] b[n + l] for l = -max_lag .. max_lag, stored at l + max_lag; zero outside the arrays.
std::vector<double> CrossCorrelation(std::span<const double> a, std::span<const double> b, std::size_t max_lag);

}  // namespace dynoproof::score
