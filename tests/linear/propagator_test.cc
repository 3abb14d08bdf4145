#include "linear/propagator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <random>

#include "base/subnormals.h"
#include "linear/aligned_vector.h"
#include "linear/dense.h"
#include "linear/energy_coordinates.h"
#include "tests/support/held_reference.h"
#include "tests/support/plants.h"

namespace dynoproof::mechanics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using support::HeldReference;
using support::ReferenceSystem;
using support::VectorXld;
using ::testing::HasSubstr;

constexpr double kStep = 1e-4;

std::vector<CpuClass> AvailableClasses() {
  std::vector<CpuClass> classes{CpuClass::kBaseline};
  for (const CpuClass c : {CpuClass::kAvx2Fma, CpuClass::kAvx512}) {
    if (c <= DetectCpuClass()) classes.push_back(c);
  }
  return classes;
}

Propagator Make(const ModalForm& form, double interval = kStep, CpuClass cpu_class = DetectCpuClass()) {
  auto propagator = Propagator::Create(form, interval, cpu_class);
  EXPECT_TRUE(propagator.ok());
  return *std::move(propagator);
}

LinearSystem NetworkSystem(const Network& network, const MatrixXd& weights) {
  const auto coordinates = EnergyCoordinates::Build(network, weights);
  EXPECT_TRUE(coordinates.ok());
  std::vector<OutputRow> rows;
  for (std::size_t e = 0; e < network.edges.size(); ++e) rows.push_back(coordinates->EdgeTorque(static_cast<int>(e)));
  rows.push_back(coordinates->Angle(0));
  rows.push_back(coordinates->Speed(network.size() - 1));
  return coordinates->System(rows);
}

LinearSystem Oscillator(double w, double damping_ratio) {
  LinearSystem system;
  system.A.resize(2, 2);
  system.A << 0.0, w, -w, -2.0 * damping_ratio * w;
  system.B = Eigen::Vector2d(0.0, w);
  system.C = MatrixXd::Identity(2, 2);
  system.D = MatrixXd::Constant(2, 1, 0.25);
  system.P.resize(1, 2);
  system.P << 1.0, 2.0;  // an integrator that sees both states
  system.E = Eigen::Vector2d(3.0, -1.0);
  return system;
}

Network Branches() {
  Network network;
  network.nodes = {{"hub", 1.0}};
  for (int i = 1; i <= 5; ++i) {
    network.nodes.push_back({"branch", 0.2});
    network.edges.push_back({"k", 0, i, 1e5, 0.7});
  }
  return network;
}

Network TwoMasses(double damping) {
  Network network;
  network.nodes = {{"a", 1.0}, {"b", 2.0}};
  network.edges = {{"k", 0, 1, 1e5, damping}};
  return network;
}

/// Two free parts; the gap between them is the last edge, without law.
Network OpenGap() {
  Network network;
  network.nodes = {{"a", 2.0}, {"b", 0.5}, {"c", 0.3}, {"d", 1.0}};
  network.edges = {{"ab", 0, 1, 1e6, 2.0}, {"cd", 2, 3, 5e6, 0.0}, {"gap", 1, 2, 0.0, 0.0}};
  return network;
}

/// An actuator's lag, then the overdamped two-mass plant; its pole at `factor` times the plant's faster one.
LinearSystem LagBeforePlant(double factor) {
  const LinearSystem plant = NetworkSystem(TwoMasses(1000.0), Eigen::Vector2d(1.0, 0.0));
  const double pole = dense::Eigenvalues(plant.A).real().minCoeff() * factor;
  const int n = plant.states();
  LinearSystem system = plant;
  system.A = MatrixXd::Zero(n + 1, n + 1);
  system.A.topLeftCorner(n, n) = plant.A;
  system.A.topRightCorner(n, 1) = plant.B;
  system.A(n, n) = pole;
  system.B = MatrixXd::Zero(n + 1, 1);
  system.B(n, 0) = -pole;
  system.C.conservativeResize(Eigen::NoChange, n + 1);
  system.C.col(n).setZero();
  system.P.conservativeResize(Eigen::NoChange, n + 1);
  system.P.col(n).setZero();
  return system;
}

LinearSystem PureIntegrators() {
  LinearSystem system;
  system.A = MatrixXd::Zero(2, 2);
  system.A(0, 1) = 1.0;
  system.B = Eigen::Vector2d(0.0, 1.0);
  system.C = MatrixXd::Identity(2, 2);
  system.D = MatrixXd::Zero(2, 1);
  system.P = MatrixXd::Zero(1, 2);
  system.P(0, 0) = 1.0;
  system.E = Eigen::Vector2d(1.0, 0.0);
  return system;
}

struct Case {
  std::string name;
  std::function<LinearSystem()> system;
  bool larger_block = false;
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

std::vector<Case> Cases() {
  return {{"SoftRotor20", [] { return NetworkSystem(support::SoftRotorR2R(20), VectorXd::Ones(22) / 22.0); }},
          {"StraightChain", [] { return NetworkSystem(support::StraightChain(), MatrixXd::Identity(5, 3)); }},
          {"Undamped", [] { return NetworkSystem(TwoMasses(0.0), MatrixXd::Identity(2, 2)); }},
          {"Overdamped", [] { return NetworkSystem(TwoMasses(4e4), MatrixXd::Identity(2, 2)); }},
          {"Branches", [] { return NetworkSystem(Branches(), MatrixXd::Identity(6, 4)); }},
          {"CriticallyDamped", [] { return Oscillator(700.0, 1.0); }, true},
          {"NearlyCriticallyDamped", [] { return Oscillator(700.0, 1.0 + 1e-9); }, true},
          {"OpenGap", [] { return NetworkSystem(OpenGap(), MatrixXd::Identity(4, 4)); }},
          {"LagOnModalPole", [] { return LagBeforePlant(1.0); }, true},
          {"LagNearModalPole", [] { return LagBeforePlant(1.0 + 1e-7); }, true},
          {"LagApart", [] { return LagBeforePlant(0.3); }},
          {"PureIntegrators", PureIntegrators, true}};
}

class Exactness : public ::testing::TestWithParam<Case> {};

/// 400 steps of random inputs, held and straight in turn, on every class: the outputs against the dense exponential in
/// extended precision, the largest output of each row as measure.
TEST_P(Exactness, HeldAndRampInputsAgreeWithTheExponential) {
  const LinearSystem system = GetParam().system();
  const ModalForm form = ModalForm::Build(system);
  EXPECT_FALSE(form.dense_fallback && form.L.rows() > 2);
  EXPECT_EQ(form.layout.real_begin > form.layout.larger_begin, GetParam().larger_block);
  const ReferenceSystem reference(system);
  const HeldReference exact(reference.A, reference.B, kStep);
  const int m = system.inputs(), r = system.outputs();
  for (const CpuClass cpu_class : AvailableClasses()) {
    const Propagator propagator = Make(form, kStep, cpu_class);
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    VectorXd x = VectorXd::NullaryExpr(system.states(), [&] { return normal(random); });
    VectorXd p = VectorXd::NullaryExpr(system.integrators(), [&] { return normal(random); });
    AlignedVector state(propagator.state_size());
    form.SetState(x, p, state);
    VectorXld s(system.states() + system.integrators());
    s << x.cast<long double>(), p.cast<long double>();
    VectorXd error = VectorXd::Zero(r), peak = VectorXd::Zero(r), y(r);
    for (int k = 0; k < 400; ++k) {
      const VectorXd u0 = VectorXd::NullaryExpr(m, [&] { return 10.0 * normal(random); });
      VectorXd du = VectorXd::NullaryExpr(m, [&] { return 10.0 * normal(random); });
      if (k % 2 == 0) {
        du.setZero();
        propagator.AdvanceAndOutput(state, {u0.data(), u0.data() + m}, {y.data(), y.data() + r});
      } else {
        const VectorXd u1 = u0 + du;
        propagator.AdvanceRamp(state, {u0.data(), u0.data() + m}, {du.data(), du.data() + m});
        propagator.Output(state, {u1.data(), u1.data() + m}, {y.data(), y.data() + r});
      }
      s = exact.phi * s + exact.held * u0.cast<long double>() + exact.ramp * du.cast<long double>();
      const VectorXd expected = (reference.C * s + reference.D * (u0 + du).cast<long double>()).cast<double>();
      error = error.cwiseMax((y - expected).cwiseAbs());
      peak = peak.cwiseMax(expected.cwiseAbs());
    }
    // Round-off (1e-16) of 400 steps times the condition of T, at most some 100 here: measured worst 2e-14.
    for (int i = 0; i < r; ++i) EXPECT_LE(error[i], 1e-12 * peak[i]) << ToString(cpu_class) << ", output " << i;
    // And the state comes back out.
    form.GetState(state, x, p);
    VectorXd back(s.size());
    back << x, p;
    EXPECT_LE((back - s.cast<double>()).norm(), 1e-12 * static_cast<double>(s.norm()));
  }
}

/// h = h1 + h2: two propagators of one form on one state equal the whole step, held and straight.
TEST_P(Exactness, StepsCompose) {
  const LinearSystem system = GetParam().system();
  const ModalForm form = ModalForm::Build(system);
  const Propagator whole = Make(form), first = Make(form, 0.3 * kStep), second = Make(form, 0.7 * kStep);
  const VectorXd u0 = VectorXd::LinSpaced(system.inputs(), 1.0, 2.0), du = -0.5 * u0, u1 = u0 + 0.3 * du;
  const VectorXd du1 = 0.3 * du, du2 = 0.7 * du;
  AlignedVector once(whole.state_size()), twice(once.size());
  form.SetState(VectorXd::Ones(system.states()), VectorXd::Ones(system.integrators()), once);
  twice = once;
  const auto span = [](const VectorXd& v) { return std::span<const double>(v.data(), v.size()); };
  whole.AdvanceRamp(once, span(u0), span(du));
  first.AdvanceRamp(twice, span(u0), span(du1));
  second.AdvanceRamp(twice, span(u1), span(du2));
  double size = 0.0, difference = 0.0;
  for (std::size_t i = 0; i < once.size(); ++i) {
    size = std::max(size, std::abs(once[i]));
    difference = std::max(difference, std::abs(once[i] - twice[i]));
  }
  EXPECT_LE(difference, 1e-14 * size);  // round-off of two steps
}

TEST_P(Exactness, GainsAreTheDerivativesOfTheEnd) {
  const LinearSystem system = GetParam().system();
  const ModalForm form = ModalForm::Build(system);
  const Propagator propagator = Make(form);
  const int m = system.inputs(), r = system.outputs();
  for (int j = 0; j < m; ++j) {
    const VectorXd unit = VectorXd::Unit(m, j), zero = VectorXd::Zero(m);
    VectorXd y(r);
    AlignedVector state(propagator.state_size(), 0.0);
    propagator.AdvanceAndOutput(state, {unit.data(), unit.data() + m}, {y.data(), y.data() + r});
    EXPECT_LE((y - propagator.held_gain().col(j)).norm(), 1e-13 * propagator.held_gain().norm());
    std::fill(state.begin(), state.end(), 0.0);
    propagator.AdvanceRamp(state, {zero.data(), zero.data() + m}, {unit.data(), unit.data() + m});
    propagator.Output(state, {unit.data(), unit.data() + m}, {y.data(), y.data() + r});
    EXPECT_LE((y - propagator.ramp_gain().col(j)).norm(), 1e-13 * propagator.ramp_gain().norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Plants, Exactness, ::testing::ValuesIn(Cases()),
                         [](const auto& test) { return test.param.name; });

/// Largest relative error of the k4 torque over a chirp 0 - 2000 Hz in 0.5 s from the equations of motion; what 10 s
/// reach is in bench/.
TEST(Propagator, SoftRotorChirp) {
  const FlushSubnormals flush;
  const Network network = support::SoftRotorR2R();
  const auto coordinates = EnergyCoordinates::Build(network, support::AirgapR2R());
  ASSERT_TRUE(coordinates.ok());
  const ModalForm form = ModalForm::Build(coordinates->System({coordinates->EdgeTorque(network.FindEdge("k4"))}));
  const Propagator all = Make(form), nine = Make(form.KeepPairs(9)), ten_kilohertz = Make(form.KeepBelow(6.3e4));
  const ReferenceSystem reference(network, support::AirgapR2R());
  const HeldReference exact(reference.A, reference.B, kStep);
  const VectorXld row = reference.C.row(network.FindEdge("k4"));
  VectorXld s = VectorXld::Zero(reference.A.rows());
  AlignedVector state(all.state_size()), nine_state(nine.state_size()), kept_state(ten_kilohertz.state_size());
  double error = 0.0, nine_error = 0.0, kept_error = 0.0, peak = 0.0;
  for (int k = 0; k < 5000; ++k) {
    const double t = k * kStep, u = std::sin(2.0 * std::numbers::pi * 2000.0 * t * t);
    double y = 0.0, nine_y = 0.0, kept_y = 0.0;
    all.AdvanceAndOutput(state, {&u, 1}, {&y, 1});
    nine.AdvanceAndOutput(nine_state, {&u, 1}, {&nine_y, 1});
    ten_kilohertz.AdvanceAndOutput(kept_state, {&u, 1}, {&kept_y, 1});
    s = exact.phi * s + exact.held.col(0) * static_cast<long double>(u);
    const auto expected = static_cast<double>(row.dot(s));
    peak = std::max(peak, std::abs(expected));
    error = std::max(error, std::abs(y - expected));
    nine_error = std::max(nine_error, std::abs(nine_y - expected));
    kept_error = std::max(kept_error, std::abs(kept_y - expected));
  }
  EXPECT_LE(error, 1e-11 * peak);      // round-off of the modes; measured 1.2e-12 over 20 000 steps
  EXPECT_LE(nine_error, 2e-5 * peak);  // 62 modes above 5.3 kHz, static: measured 6.6e-6
  EXPECT_LE(kept_error, 2e-5 * peak);
  EXPECT_GT(nine_error, 1e-9 * peak);  // they are really gone
}

TEST(Propagator, TruncationKeepsTheStaticGainAndTheRigidBody) {
  const LinearSystem system = NetworkSystem(support::StraightChain(), MatrixXd::Identity(5, 5));
  const ModalForm full = ModalForm::Build(system), kept = full.KeepPairs(2);
  EXPECT_EQ(kept.dropped_states, 4);
  EXPECT_EQ(kept.layout.pairs, 2);
  // Equal and opposite torques leave no rigid motion: the constant twist is the static one.
  const std::vector<double> u{5.0, 0.0, -2.0, 0.0, -3.0};
  const Propagator all = Make(full, 0.01), some = Make(kept, 0.01);
  AlignedVector all_state(all.state_size()), some_state(some.state_size());
  std::vector<double> all_y(system.outputs()), some_y(system.outputs());
  for (int k = 0; k < 20000; ++k) {  // 200 s: the slowest mode has died out
    all.AdvanceAndOutput(all_state, u, all_y);
    some.AdvanceAndOutput(some_state, u, some_y);
  }
  const double torques[] = {5.0, 5.0, 3.0, 3.0};
  for (int e = 0; e < 4; ++e) {
    EXPECT_NEAR(all_y[e], torques[e], 1e-9);
    EXPECT_NEAR(some_y[e], torques[e], 1e-9);
  }
}

TEST(Propagator, FastTurningDoesNotSpoilTheTwists) {
  // Both parts turn at 1000 rad/s for 100 s, a gap of 4 mrad between them, the shafts wound by nothing.
  const Network network = OpenGap();
  const auto coordinates = EnergyCoordinates::Build(network, MatrixXd::Identity(4, 1));
  ASSERT_TRUE(coordinates.ok());
  const ModalForm form = ModalForm::Build(coordinates->System({coordinates->EdgeTwist(2), coordinates->Angle(0)}));
  const Propagator propagator = Make(form);
  VectorXd angles(4);
  MatrixXd x, p;
  angles << 0.0, 0.0, -0.004, -0.004;
  coordinates->FromPhysical(angles, VectorXd::Constant(4, 1000.0), x, p);
  AlignedVector state(propagator.state_size());
  form.SetState(x, p, state);
  const double u = 0.0;
  double y[2] = {};
  for (int k = 0; k < 1'000'000; ++k) propagator.Advance(state, {&u, 1});
  propagator.Output(state, {&u, 1}, y);
  EXPECT_NEAR(y[1], 1e5, 1e-4);  // 1e6 additions of 0.1 at 1e5: round-off 1.5e-11 each, biased at worst
  // The relative angle adds, each step, 0.1 rad minus 0.1 rad, rounded to some 1e-17, and always alike: measured 4e-11
  // after 1e6 steps (factor 5). As the difference of the two angles it would be off like the angle above.
  EXPECT_NEAR(y[0], 0.004, 2e-10);
}

TEST(Propagator, SameBitsAgainAndFromASavedState) {
  const ModalForm form = ModalForm::Build(NetworkSystem(support::StraightChain(), MatrixXd::Identity(5, 2)));
  for (const CpuClass cpu_class : AvailableClasses()) {
    const Propagator propagator = Make(form, kStep, cpu_class), copy = propagator;
    std::vector<double> state(propagator.state_size()), u{3.0, -1.0}, du{0.5, 0.25}, y(form.outputs());
    for (int k = 0; k < 100; ++k) propagator.Advance(state, u);
    const std::vector<double> saved = state;
    propagator.AdvanceRamp(state, u, du);
    propagator.AdvanceAndOutput(state, u, y);
    // Elsewhere in memory, by a copy: misaligned by one double.
    std::vector<double> shifted(state.size() + 1);
    std::copy(saved.begin(), saved.end(), shifted.begin() + 1);
    const std::span<double> other = std::span(shifted).subspan(1);
    copy.AdvanceRamp(other, u, du);
    copy.Advance(other, u);
    EXPECT_THAT(other, ::testing::ElementsAreArray(state));  // exact equality of every double
  }
}

TEST(Propagator, SingleOutputPathLeavesTheSameState) {
  const auto coordinates = EnergyCoordinates::Build(support::StraightChain(), VectorXd::Unit(5, 0));
  ASSERT_TRUE(coordinates.ok());
  for (const OutputRow& row : {coordinates->EdgeTorque(3), coordinates->Speed(2), coordinates->Angle(4)}) {
    const ModalForm form = ModalForm::Build(coordinates->System({row}));
    for (const CpuClass cpu_class : AvailableClasses()) {
      const Propagator propagator = Make(form, kStep, cpu_class);
      AlignedVector one(propagator.state_size()), two(one.size());
      for (int k = 0; k < 300; ++k) {
        const double u = k % 7 - 2.5;
        double fast = 0.0, plain = 0.0;
        propagator.AdvanceAndOutput(one, {&u, 1}, {&fast, 1});
        propagator.Advance(two, {&u, 1});
        propagator.Output(two, {&u, 1}, {&plain, 1});
        ASSERT_EQ(one, two);
        ASSERT_NEAR(fast, plain, 1e-13 * (1.0 + std::abs(plain)));  // another order of the sum
      }
    }
  }
}

TEST(Propagator, AddsColumnsToTheState) {
  const ModalForm form = ModalForm::Build(NetworkSystem(support::StraightChain(), MatrixXd::Identity(5, 2)));
  for (const CpuClass cpu_class : AvailableClasses()) {
    const Propagator propagator = Make(form, kStep, cpu_class);
    const Eigen::Index size = propagator.state_size();
    for (const Eigen::Index count : {0, 1, 2, 3, 5}) {
      const MatrixXd columns = MatrixXd::Random(size, count);
      const VectorXd factors = VectorXd::Random(count), before = VectorXd::Random(size);
      VectorXd state = before;
      propagator.Add({columns.data(), static_cast<std::size_t>(columns.size())},
                     {factors.data(), static_cast<std::size_t>(count)}, {state.data(), static_cast<std::size_t>(size)});
      const VectorXd expected = before + columns * factors;
      EXPECT_LT((state - expected).cwiseAbs().maxCoeff(), 1e-15 * static_cast<double>(count + 1))
          << ToString(cpu_class);
    }
  }
}

TEST(Propagator, DenseFallbackIsStillExact) {
  const int n = 20;  // above the size of one group, two vectors and a rest
  LinearSystem system;
  system.A = -100.0 * MatrixXd::Identity(n, n);
  for (int i = 0; i + 1 < n; ++i) system.A(i, i + 1) = 50.0;
  system.B = VectorXd::Unit(n, n - 1);
  system.C = VectorXd::Unit(n, 0).transpose();
  system.P = MatrixXd::Zero(0, n);
  system.E = MatrixXd::Zero(1, 0);
  system.D = MatrixXd::Zero(1, 1);
  const ModalForm form = ModalForm::Build(system);
  EXPECT_TRUE(form.dense_fallback);
  const HeldReference exact(ReferenceSystem(system).A, ReferenceSystem(system).B, 0.05L);
  for (const CpuClass cpu_class : AvailableClasses()) {
    const Propagator propagator = Make(form, 0.05, cpu_class);
    std::vector<double> state(propagator.state_size());
    VectorXld s = VectorXld::Zero(n);
    for (int k = 0; k < 50; ++k) {
      const double u = 1.0 + k % 3;
      double y = 0.0;
      propagator.AdvanceAndOutput(state, {&u, 1}, {&y, 1});
      s = exact.phi * s + exact.held.col(0) * static_cast<long double>(u);
      ASSERT_NEAR(y, static_cast<double>(s[0]), 1e-12 * std::abs(static_cast<double>(s[0])) + 1e-25);
    }
  }
}

TEST(Propagator, RefusesWhatItCannotDo) {
  const ModalForm form = ModalForm::Build(Oscillator(700.0, 0.1));
  const auto zero = Propagator::Create(form, 0.0);
  ASSERT_FALSE(zero.ok());
  EXPECT_THAT(zero.failure().message, HasSubstr("interval"));
  EXPECT_FALSE(Propagator::Create(form, std::nan("")).ok());
  EXPECT_EQ(zero.failure().exit_code, 2);
}

}  // namespace
}  // namespace dynoproof::mechanics
