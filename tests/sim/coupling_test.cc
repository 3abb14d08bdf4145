// Couplings in a line: the oil's state carried exactly, against closed solutions; drift against an integration by hand.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "linear/dense.h"
#include "sim/solver.h"
#include "tests/support/plan_builder.h"
#include "tests/support/run_plan.h"

namespace dynoproof {
namespace {

using testing::CouplingPlan;
using testing::Nrmse;
using testing::RunPlan;

constexpr double kA = 17.68, kB = 597.7, kTorque = 1000.0;  // CouplingPlan and its input

Plan WithEffect(const char* name, Value parameters) {
  Plan plan = CouplingPlan();
  plan.root["effect"] =
      Value(Value::Array{Value{{"name", name}, {"at", "shaft:coupling"}, {"parameters", std::move(parameters)}}});
  return plan;
}
Plan Oil(double k_s, double kappa, double K) {
  return WithEffect("oil_dynamics", Value{{"k_s", k_s}, {"kappa_p", kappa}, {"k_p_kappa_w", K}});
}

using Complex = std::complex<long double>;

/// Torque of the coupling after a constant torque on A from rest, in closed form. With m = 1/A + 1/B the twist obeys
/// d'' = T0/A - m T, T = k_s d + q, q' = -kappa q + K d'; so T(s) = T0/A [k_s (s + kappa) + K s] / (s N(s)) with
/// N = (s^2 + m k_s)(s + kappa) + m K s: a constant and three exponentials from the roots of N.
class ClosedSolution {
 public:
  ClosedSolution(long double k_s, long double kappa, long double K) {
    const long double m = 1.0L / kA + 1.0L / kB;
    const long double c2 = kappa, c1 = m * (k_s + K), c0 = m * k_s * kappa;
    Eigen::MatrixXd companion(3, 3);
    companion << 0, 0, -static_cast<double>(c0), 1, 0, -static_cast<double>(c1), 0, 1, -static_cast<double>(c2);
    const Eigen::VectorXcd start = dense::Eigenvalues(companion);
    for (int i = 0; i < 3; ++i) {
      Complex s(start[i].real(), start[i].imag());
      for (int step = 0; step < 20; ++step) {  // Newton's method in extended precision
        s -= (((s + c2) * s + c1) * s + c0) / ((3.0L * s + 2.0L * c2) * s + c1);
      }
      roots_[i] = s;
      residues_[i] = kTorque / static_cast<long double>(kA) * (k_s * (s + kappa) + K * s) /
                     (s * ((3.0L * s + 2.0L * c2) * s + c1));
    }
    constant_ = kTorque / static_cast<long double>(kA) * k_s * kappa / c0;
  }
  double At(double t) const {
    Complex sum = constant_;
    for (int i = 0; i < 3; ++i) sum += residues_[i] * std::exp(roots_[i] * static_cast<long double>(t));
    return static_cast<double>(sum.real());
  }

 private:
  long double constant_;
  Complex roots_[3], residues_[3];
};

double DistanceFromClosed(double k_s, double kappa, double K, const std::string& solver) {
  const Samples samples = RunPlan(Oil(k_s, kappa, K), solver);
  const ClosedSolution closed(k_s, kappa, K);
  std::vector<double> expected;
  for (const double t : samples.time) expected.push_back(closed.At(t));
  return Nrmse(expected, samples.outputs.at(0));
}

TEST(OilCouplingLine, StepResponseIsTheClosedSolution) {
  // realtime carries the oil exactly: round-off of 1e4 steps. Table 4.2; hardly any flow; flow at once.
  EXPECT_LT(DistanceFromClosed(78e3, 190.0, 154e3, "realtime"), 1e-12);
  EXPECT_LT(DistanceFromClosed(78e3, 0.5, 154e3, "realtime"), 1e-12);
  EXPECT_LT(DistanceFromClosed(78e3, 5e3, 4e6, "realtime"), 1e-11);
  EXPECT_LT(DistanceFromClosed(78e3, 190.0, 154e3, "reference"), 1e-7);  // its tolerance, 1e-9 a step, over 1e4 steps
}

TEST(OilCouplingLine, IsCarriedWithoutSubsteps) {
  const auto rig = testing::RigOf(Oil(78e3, 190.0, 154e3));
  auto solver = MakeRealtimeSolver(*rig);
  ASSERT_TRUE(solver.ok());
  EXPECT_NE((*solver)->Summary().find("0 nonlinear laws"), std::string::npos) << (*solver)->Summary();
}

TEST(OilCouplingLine, TendsToKelvinVoigtWhenTheOilFlowsAtOnce) {
  // K = c kappa_p with kappa_p beyond all motion; what is left is of the order of nu / kappa_p = 75 / 1e4.
  Plan kelvin_voigt = CouplingPlan();
  const Samples limit = RunPlan(kelvin_voigt, "realtime"), oil = RunPlan(Oil(94e3, 1e4, 618e4), "realtime");
  const double far = Nrmse(limit.outputs[0], RunPlan(Oil(94e3, 1e3, 618e3), "realtime").outputs[0]);
  const double near = Nrmse(limit.outputs[0], oil.outputs[0]);
  EXPECT_LT(near, 0.02);
  EXPECT_NEAR(far / near, 10.0, 2.0);  // first order in 1 / kappa_p
}

TEST(OilCouplingLine, TendsToASpringWhenTheGapsClose) {
  Plan spring = CouplingPlan();
  spring.root["plant"]["shaft"]["coupling"] = testing::Shaft("A", "B", 78e3 + 154e3, 0.0);
  const Samples limit = RunPlan(spring, "realtime"), oil = RunPlan(Oil(78e3, 0.1, 154e3), "realtime");
  // kappa_p t = 0.1 at the end of the run, of which K / (k_s + K) turns to a fall of the torque.
  EXPECT_LT(Nrmse(limit.outputs[0], oil.outputs[0]), 0.1);
}

TEST(OilCouplingLine, TakesNoEnergyFromNowhere) {
  // Energy of the free line after its torque ended never rises: A and B, spring and oil, from the recorded signals.
  Plan plan = Oil(78e3, 190.0, 154e3);
  plan.root["input"]["T_c"]["source"] = Value{{"type", "step"}, {"initial", 1000.0}, {"value", 0.0}, {"time_s", 0.1}};
  plan.root["output"]["w_B"] = Value{{"of", "plant.B.speed"}};
  plan.root["output"]["d"] = Value{{"of", "plant.coupling.twist"}};
  const Samples samples = RunPlan(plan, "realtime");
  double before = INFINITY;
  for (std::size_t k = 1001; k < samples.time.size(); ++k) {
    const double T = samples.outputs[0][k], w_A = samples.outputs[1][k], w_B = samples.outputs[2][k],
                 d = samples.outputs[3][k], q = T - 78e3 * d;
    const double w = w_A - w_B, mean = (kA * w_A + kB * w_B) / (kA + kB);
    const double energy = 0.5 * kA * kB / (kA + kB) * w * w + 0.5 * 78e3 * d * d + 0.5 * q * q / 154e3;
    ASSERT_LE(energy, before * (1.0 + 1e-12) + 1e-12) << samples.time[k];
    before = energy;
    ASSERT_NEAR(mean, 1000.0 * 0.1 / (kA + kB), 1e-12);  // momentum stays
  }
  EXPECT_LT(before, 1e-6);
}

TEST(ViscosityDriftLine, AgreesWithAnIntegrationByHand) {
  const double delta = 0.5, tau = 0.3;
  const Plan plan = WithEffect("viscosity_drift", Value{{"delta", delta}, {"tau", tau}});
  const Samples realtime = RunPlan(plan, "realtime"), reference = RunPlan(plan, "reference");
  // d'' = T0/A - m (k d + c(t) d'), Runge-Kutta 4 with steps of 5 us: error 1e-12.
  const double m = 1.0 / kA + 1.0 / kB, h = 5e-6;
  const auto c = [&](double t) { return 618.0 * (1.0 - delta * (1.0 - std::exp(-t / tau))); };
  double d = 0.0, w = 0.0;
  std::vector<double> torque;
  const auto acceleration = [&](double t, double x, double v) { return kTorque / kA - m * (94e3 * x + c(t) * v); };
  for (std::size_t k = 0; k < realtime.time.size(); ++k) {
    torque.push_back(94e3 * d + c(realtime.time[k]) * w);
    for (int i = 0; i < 20; ++i) {
      const double t = realtime.time[k] + i * h;
      const double a1 = acceleration(t, d, w), v2 = w + 0.5 * h * a1;
      const double a2 = acceleration(t + 0.5 * h, d + 0.5 * h * w, v2), v3 = w + 0.5 * h * a2;
      const double a3 = acceleration(t + 0.5 * h, d + 0.5 * h * v2, v3), v4 = w + h * a3;
      const double a4 = acceleration(t + h, d + h * v3, v4);
      d += h / 6.0 * (w + 2.0 * v2 + 2.0 * v3 + v4);
      w += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
  }
  EXPECT_LT(Nrmse(torque, reference.outputs[0]), 1e-7);
  EXPECT_LT(Nrmse(torque, realtime.outputs[0]), 1e-6);  // straight courses over substeps of 25 us, second order
  // and it is a drift: the constant damping is far off
  EXPECT_GT(Nrmse(torque, RunPlan(CouplingPlan(), "realtime").outputs[0]), 1e-2);
}

}  // namespace
}  // namespace dynoproof
