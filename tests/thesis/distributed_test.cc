// Distributed rotors: published and exact frequencies, completeness of the roots, convergence of the sliced rotor.
#include "thesis/distributed.h"

#include <gtest/gtest.h>

#include <numbers>

#include "linear/modes.h"
#include "tests/linear/plants.h"

namespace dynoproof::mechanics {
namespace {

using std::numbers::pi;

constexpr double kTwoPi = 2.0 * pi;
const HybridRotor kTableB1{20.0, 30e6, 0.0, 0.0, {{1e6, 0.35}}};
const HybridRotor kTableA5{25.308, 16.5e6, 0.0, 0.0, {{5.1e6, 0.235}, {7.99e6, 0.159}}};
const HybridRotor kTableA7{4.813, 8.90e6, 0.0, 0.0, {{5.76e6, 0.137}, {6.37e6, 0.081}}};

std::vector<double> Exact(const HybridRotor& rotor, double f_max) {
  Result<std::vector<double>> found = ExactEigenfrequencies(rotor, f_max);
  EXPECT_TRUE(found.ok());
  return *found;
}

TEST(Distributed, TableB1) {
  EXPECT_NEAR(Exact(kTableB1, 5000.0)[0], 269.638, 0.00051);  // given to 1e-3 Hz
  const auto heuristic = HeuristicEigenfrequencies(20.0, 30e6, {1e6, 0.35}, 5000.0);
  ASSERT_TRUE(heuristic.ok());
  EXPECT_NEAR((*heuristic)[0], 269.03, 0.0051);  // given to 0.01 Hz; printed 269.1
  const auto sliced = UndampedFrequencies(Sliced(kTableB1, 1000));
  ASSERT_TRUE(sliced.ok());
  EXPECT_NEAR((*sliced)[1], 269.64, 0.0051);  // printed 269.7
}

TEST(Distributed, FreeRotorAndPinnedRotorAreClosedForms) {
  const HybridRotor free{25.0, 16e6, 0.0, 0.0, {}};
  const double wave = std::sqrt(16e6 / 25.0) / kTwoPi;
  const std::vector<double> found = Exact(free, 20.5 * pi * wave);
  ASSERT_EQ(found.size(), 20u);  // x = m pi
  for (std::size_t m = 0; m < 20; ++m) {
    EXPECT_NEAR(found[m] / (static_cast<double>(m + 1) * pi * wave), 1.0, 1e-14);
  }
  // (2.111) against the count for the same rotor with a pinned inertia.
  for (const double end : {0.01, 0.35, 20.0, 3000.0}) {
    const auto spatial = SpatialEigenfrequencies(25.0, 16e6, end, 5000.0);
    ASSERT_TRUE(spatial.ok());
    const std::vector<double> exact = Exact({25.0, 16e6, 0.0, end, {}}, 5000.0);
    const std::vector<double> mirrored = Exact({25.0, 16e6, end, 0.0, {}}, 5000.0);
    ASSERT_EQ(spatial->size(), exact.size());
    ASSERT_EQ(mirrored.size(), exact.size());
    for (std::size_t m = 0; m < exact.size(); ++m) {
      EXPECT_NEAR((*spatial)[m] / exact[m], 1.0, 1e-13);  // two ways to the last digits
      EXPECT_NEAR(mirrored[m] / exact[m], 1.0, 1e-12);
      const double x = exact[m] / wave;
      EXPECT_NEAR((-x * std::cos(x) - 25.0 / end * std::sin(x)) / (x + 25.0 / end), 0.0, 1e-12);
    }
  }
}

TEST(Distributed, HeuristicRootsSolveTheirEquationOneBetweenPoles) {
  const double I = 20.0, k = 30e6, k4 = 1e6, I5 = 0.35;
  const double nu_0 = std::sqrt(k4 / I5), nu_r = std::sqrt(k4 * (1.0 / I + 1.0 / I5));
  const auto found = HeuristicEigenfrequencies(I, k, {k4, I5}, 6000.0);
  ASSERT_TRUE(found.ok());
  for (const double f : *found) {
    const double nu = kTwoPi * f, x = nu * std::sqrt(I / k);
    const double left = -x / std::tan(x), right = I / I5 * (nu - nu_0) / (nu - nu_r);
    EXPECT_NEAR(left / right, 1.0, 1e-9);  // slopes up to 1e4 near the poles times round-off
  }
  // f_max = 6000 Hz is x = 30.8, 9.8 pi: ten intervals of the cotangent, one split by nu_r, the last root inside.
  EXPECT_EQ(found->size(), 10u);
}

class RandomRotors : public testing::TestWithParam<unsigned> {};

TEST_P(RandomRotors, NoRootIsMissedOrInvented) {
  const unsigned seed = GetParam();
  std::mt19937 random(seed);
  HybridRotor rotor{LogUniform(random, 1.0, 30.0), LogUniform(random, 1e6, 1e8), 0.0, 0.0, {}};
  if (seed % 3 == 0) rotor.left_inertia = LogUniform(random, 0.01, 5.0);
  if (seed % 4 == 0) rotor.right_inertia = LogUniform(random, 0.01, 5.0);
  for (unsigned i = 0; i < seed % 4; ++i) {
    rotor.chain.push_back({LogUniform(random, 1e5, 5e7), LogUniform(random, 0.05, 5.0)});
  }
  // The finely sliced rotor has the same modes within its first-order error.
  const int slices = 1500;
  const auto sliced = UndampedFrequencies(Sliced(rotor, slices));
  ASSERT_TRUE(sliced.ok());
  const double f_max = 0.5 * ((*sliced)[12] + (*sliced)[13]);
  const std::vector<double> exact = Exact(rotor, f_max);
  ASSERT_EQ(exact.size(), 12u);
  for (int m = 1; m <= 12; ++m) {
    // Slicing: first order, measured constants near 1/2 to 1, plus (pi m / N)^2 / 24.
    EXPECT_NEAR((*sliced)[m] / exact[static_cast<std::size_t>(m - 1)], 1.0, 2.0 / slices) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomRotors, testing::Range(1u, 25u));

TEST(Distributed, CountNearClampedFrequenciesIsMonotonic) {
  const double wave = std::sqrt(kTableA5.stiffness / kTableA5.inertia) / kTwoPi;
  int last = 0;
  for (int m = 1; m <= 30; ++m) {
    for (const double aside : {-1e-3, -1e-9, -1e-15, 0.0, 1e-15, 1e-9, 1e-3}) {
      const int count = CountEigenfrequencies(kTableA5, m * pi * wave * (1.0 + aside));
      EXPECT_GE(count, last) << m << " " << aside;
      last = count;
    }
  }
  EXPECT_EQ(last, 32);  // 30 of the rotor and two of the chain
}

struct Case {
  const char* name;
  HybridRotor rotor;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

class Convergence : public testing::TestWithParam<Case> {};

// Slicing as the thesis does, I/N and k (N - 1), is of first order: (N - 1)/N alone errs by 1/(2 N) in frequency, as
// the outer slices carry a whole slice of inertia at the end of half a slice of spring too little.
TEST_P(Convergence, SlicingIsOfFirstOrder) {
  for (int mode = 1; mode <= 5; ++mode) {
    const auto found = MeasureSliceConvergence(GetParam().rotor, mode, {100, 200, 400, 800, 1600});
    ASSERT_TRUE(found.ok());
    // Measured from 400 to 800 to 1600: 1.002 to 1.05; the distance from 1 halves with each doubling.
    EXPECT_NEAR(found->order[3], 1.0, 0.03) << mode;
    EXPECT_LT(std::abs(found->order[3] - 1.0), std::abs(found->order[1] - 1.0)) << mode;
    for (const double f : found->frequency_hz) EXPECT_LT(f, found->exact_hz);  // always from below
    // First order lets Richardson's extrapolation work: two more digits.
    const double extrapolated = 2.0 * found->frequency_hz[4] - found->frequency_hz[3];
    EXPECT_LT(std::abs(extrapolated - found->exact_hz), 0.05 * (found->exact_hz - found->frequency_hz[4])) << mode;
  }
}

INSTANTIATE_TEST_SUITE_P(Tables, Convergence, testing::Values(Case{"A5", kTableA5}, Case{"A7", kTableA7}),
                         [](const auto& param) { return std::string(param.param.name); });

TEST(Distributed, ThesisSlicesErrByThis) {
  // 100 slices of Table A.5 put the first mode 1.83 Hz below the distributed rotor, 70 of Table A.7 3.0 Hz.
  const auto heavy = MeasureSliceConvergence(kTableA5, 1, {50, 100});
  const auto road = MeasureSliceConvergence(kTableA7, 1, {35, 70});
  ASSERT_TRUE(heavy.ok() && road.ok());
  EXPECT_NEAR(heavy->frequency_hz[1], 389.3, 0.051);
  EXPECT_NEAR(road->frequency_hz[1], 605.1, 0.051);
  EXPECT_NEAR(heavy->exact_hz - heavy->frequency_hz[1], 1.83, 0.01);
  EXPECT_NEAR(road->exact_hz - road->frequency_hz[1], 3.0, 0.05);
}

TEST(Distributed, RefusesWhatHasNoMeaning) {
  EXPECT_FALSE(SpatialEigenfrequencies(20.0, 30e6, 0.0, 100.0).ok());
  EXPECT_FALSE(HeuristicEigenfrequencies(20.0, NAN, {1e6, 0.35}, 100.0).ok());
  EXPECT_FALSE(ExactEigenfrequencies({-1.0, 1.0, 0.0, 0.0, {}}, 100.0).ok());
  EXPECT_FALSE(ExactEigenfrequencies(kTableB1, INFINITY).ok());
  EXPECT_FALSE(MeasureSliceConvergence(kTableB1, 1, {100}).ok());
  EXPECT_FALSE(MeasureSliceConvergence(kTableB1, 1, {100, 50}).ok());
  EXPECT_FALSE(MeasureSliceConvergence(kTableB1, 200, {100, 200}).ok());
}

}  // namespace
}  // namespace dynoproof::mechanics
