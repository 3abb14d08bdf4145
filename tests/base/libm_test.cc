// The functions of libm give the same bits on every machine: engine/libm.cmake.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>

// A build for one kind of processor contracts the arithmetic of the test itself, and another architecture that of musl.
#if defined(__x86_64__) && defined(DYNOPROOF_LIBM_MUSL) && !defined(__FMA__)

namespace dynoproof {
namespace {

/// FNV-1a over the bits of what libm makes of arguments that the compiler does not know.
std::uint64_t HashOfLibm() {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto take = [&hash](double value) { hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3u; };
  std::uint64_t state = 1;
  for (int i = 0; i < 20000; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const double x = static_cast<double>(state >> 11) * 0x1p-53;  // in [0, 1)
    const double angle = 200.0 * (x - 0.5);
    take(std::sin(angle)), take(std::cos(angle)), take(std::tan(angle));
    take(std::asin(x)), take(std::acos(x)), take(std::atan(angle)), take(std::atan2(x, angle));
    take(std::sinh(x)), take(std::cosh(x)), take(std::tanh(x));
    take(std::exp(angle)), take(std::exp2(angle)), take(std::expm1(x)), take(std::pow(x + 0.01, angle));
    take(std::log(x + 0.01)), take(std::log2(x + 0.01)), take(std::log10(x + 0.01)), take(std::log1p(x));
    take(std::cbrt(angle)), take(std::hypot(x, angle)), take(std::erf(x)), take(std::tgamma(x + 0.5));
    const std::complex<double> z(x, angle);
    take(std::abs(z)), take(std::arg(z)), take(std::sqrt(z).real()), take(std::exp(z).imag()), take(std::log(z).real());
  }
  return hash;
}

/// glibc's own differ between processors with and without FMA. The number was computed once, on one with.
TEST(Libm, GivesTheSameBitsOnEveryMachine) { EXPECT_EQ(HashOfLibm(), 1622443054524400047u); }

}  // namespace
}  // namespace dynoproof

#endif
