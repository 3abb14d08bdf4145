// Part `firing_order`: its work, its orders against Fourier sums and the closed form of banks that are apart, by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "plugins/physics/cylinder_geometry.h"
#include "tests/support/build.h"

namespace dynoproof {
namespace {

using std::numbers::pi;

constexpr CylinderGeometry kGeometry{0.31, 0.35, 0.75, 12.0};
constexpr double kWork = 3e4, kPressure = 1.8e5, kCrankcase = 101300.0;

Value Engine(int cylinders, int banks, double offset_deg) {
  return {{"type", "firing_order"},
          {"bore_m", 0.31},
          {"stroke_m", 0.35},
          {"rod_m", 0.75},
          {"compression_ratio", 12.0},
          {"cylinders", cylinders},
          {"banks", banks},
          {"bank_offset_deg", offset_deg},
          {"intake_closes_deg", 165.0},
          {"exhaust_opens_deg", 490.0}};
}

/// Torque over a cycle, in the middles of `n` equal parts; valves open and close at their ends.
std::vector<double> Turned(const Value& table, int n = 7200) {
  const auto part = testing::Build("plant", table);
  std::vector<int> modes(static_cast<std::size_t>(part->layout().modes));
  std::vector<double> torques;
  for (int k = 0; k < n; ++k) {
    const std::vector<double> inputs{4.0 * pi * (k + 0.5) / n, kWork, kPressure, 0.0};
    part->OnEvent({0.0, inputs, {}, modes}, -1, {}, modes);
    double outputs[2];
    part->Output({0.0, inputs, {}, modes}, outputs);
    torques.push_back(outputs[1]);
  }
  return torques;
}

/// Coefficient of order `q` of a turn; order 0 is the mean.
std::complex<double> Order(const std::vector<double>& torque, double q) {
  std::complex<double> sum;
  const double n = static_cast<double>(torque.size());
  for (std::size_t k = 0; k < torque.size(); ++k) {
    sum += torque[k] * std::polar(1.0, -q * 4.0 * pi * (static_cast<double>(k) + 0.5) / n);
  }
  return (q == 0.0 ? 1.0 : 2.0) * sum / n;
}

TEST(FiringOrder, DoesTheWorkThatWasMeasured) {
  for (const auto& [cylinders, banks, offset] :
       {std::tuple(1, 1, 0.0), std::tuple(10, 2, 36.0), std::tuple(6, 2, 45.0)}) {
    // The middle rule of 0.1 degree: 1e-6 of the torque.
    const double mean = Order(Turned(Engine(cylinders, banks, offset)), 0.0).real();
    EXPECT_NEAR(mean / (cylinders * banks * kWork / (4.0 * pi)), 1.0, 1e-5) << cylinders;
  }
}

TEST(FiringOrder, HasTheOrdersOfItsPressureByAnotherQuadrature) {
  // p dV with the volume alone: no lever, no closed form of the work. What the expansion begins with comes from a search.
  const int n = 32500;  // parts of 0.01 degree between the valves
  const auto angle = [&](double k) { return (165.0 + 325.0 * k / n) * kPerDegree; };
  const double v_1 = kGeometry.Volume(angle(0)), v_c = kGeometry.clearance();
  const auto sum = [&](double p_3, double q) {
    std::complex<double> all;
    for (int k = 0; k < n; ++k) {
      const double middle = angle(k + 0.5), v = kGeometry.Volume(middle);
      const double p = middle < 2.0 * pi ? kPressure * std::pow(v_1 / v, 1.37) : p_3 * std::pow(v_c / v, 1.33);
      all += (p - kCrankcase) * (kGeometry.Volume(angle(k + 1)) - kGeometry.Volume(angle(k))) *
             std::polar(1.0, -q * middle);
    }
    return all;
  };
  double low = 1e5, high = 1e8;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (sum(middle, 0.0).real() < kWork ? low : high) = middle;
  }
  const std::vector<double> one = Turned(Engine(1, 1, 0.0));
  for (const double q : {0.5, 1.0, 2.5, 5.0, 10.0}) {
    const std::complex<double> expected = sum(low, q) / (2.0 * pi);
    // Both by middles: 0.1 degree is 1/36 of a turn of order 10 to the square over 24.
    EXPECT_LT(std::abs(Order(one, q) - expected), 1e-4 * std::abs(expected)) << q;
  }
}

TEST(FiringOrder, KeepsTheOrdersThatCylindersAndBanksHaveInCommon) {
  const std::vector<double> one = Turned(Engine(1, 1, 0.0));
  for (const double offset : {0.0, 36.0, 45.0}) {
    const std::vector<double> all = Turned(Engine(10, 2, offset));
    for (const double q : {0.5, 1.0, 2.5, 5.0, 7.5, 10.0, 15.0}) {
      // Evenly spaced cylinders: N where q is a multiple of N/2, else 0. Two banks: |1 + exp(-i q offset)| = 2 |cos(q offset/2)|.
      const bool stays = std::fmod(q, 5.0) == 0.0;
      const double expected = stays ? 20.0 * std::abs(Order(one, q) * std::cos(0.5 * q * offset * kPerDegree)) : 0.0;
      EXPECT_NEAR(std::abs(Order(all, q)), expected, 1e-9 * std::abs(Order(all, 0.0))) << offset << " " << q;
    }
  }
}

TEST(FiringOrder, AddsTheTorqueOfOpenValvesAndRefusesARodThatIsTooShort) {
  const auto part = testing::Build("plant", Engine(1, 1, 0.0));
  const std::vector<double> inputs{600.0 * kPerDegree, kWork, kPressure, 123.0};
  std::vector<int> modes(2);
  part->Start(inputs, {}, modes);
  double outputs[2];
  part->Output({0.0, inputs, {}, modes}, outputs);
  EXPECT_EQ(outputs[0], 123.0) << "its valves are open";
  EXPECT_EQ(outputs[1], 0.0);
  Value table = Engine(1, 1, 0.0);
  table["rod_m"] = Value(0.1);
  std::string faults;
  EXPECT_EQ(testing::Build("plant", table, {}, &faults), nullptr);
  EXPECT_NE(faults.find("cannot turn a crank"), std::string::npos) << faults;
}

}  // namespace
}  // namespace dynoproof
