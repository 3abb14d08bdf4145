// The exact propagation of a linear system over one interval: real block-diagonal coordinates, O(n) a step, fixed work.
#pragma once

#include <Eigen/Dense>
#include <cassert>
#include <memory>
#include <span>

#include "base/cpu.h"
#include "base/status.h"
#include "linear/modal_form.h"
#include "linear/propagator_kernels.h"

namespace dynoproof::mechanics {

/// Advances the state of a ModalForm (StateLayout) by one interval, exactly for inputs that are held or run straight.
/// Several Propagators of one form, each with its own interval, act on the same state. Const and free of own memory: it
/// never allocates in a step, needs no mathematical library, and any number of threads may share it. The same inputs
/// give the same bits on the same class of vector instructions. Run it under FlushSubnormals.
class Propagator {
 public:
  /// `interval_s` > 0 [s]. `cpu_class` must be at most DetectCpuClass(). Fails (exit code 2) on another interval or
  /// class, or a block above kMaxBlock states.
  static Result<Propagator> Create(const ModalForm& form, double interval_s, CpuClass cpu_class = DetectCpuClass());

  int state_size() const { return state_size_; }
  int inputs() const { return inputs_; }
  int outputs() const { return plan_.outputs.count; }
  double interval_s() const { return interval_s_; }
  CpuClass cpu_class() const { return cpu_class_; }

  /// One interval with u [m] held.
  void Advance(std::span<double> state, std::span<const double> u) const {
    assert(std::ssize(state) == state_size_ && std::ssize(u) == inputs_);
    advance_(plan_, state.data(), u.data(), inputs_);
  }

  /// One interval in which the input goes straight from u0 to u0 + du.
  void AdvanceRamp(std::span<double> state, std::span<const double> u0, std::span<const double> du) const {
    Advance(state, u0);
    for (int j = 0; j < inputs_; ++j) Respond(state, j, 0.0, du[j]);
  }

  /// Adds to the state at the end of an interval what `input` would have added, had it been higher by `held` throughout
  /// and by a straight line from 0 to `ramp`.
  void Respond(std::span<double> state, int input, double held, double ramp) const {
    assert(std::ssize(state) == state_size_ && 0 <= input && input < inputs_);
    respond_(plan_, state.data(), input, held, ramp);
  }

  /// Adds `columns` [state_size x count, one after the other] times their `factors` [count] to the state.
  void Add(std::span<const double> columns, std::span<const double> factors, std::span<double> state) const {
    assert(std::ssize(state) == state_size_ && columns.size() == factors.size() * state.size());
    add_(plan_, columns.data(), factors.data(), static_cast<int>(factors.size()), state.data());
  }

  /// y [r] = C x + E p + D u.
  void Output(std::span<const double> state, std::span<const double> u, std::span<double> y) const {
    assert(std::ssize(state) == state_size_ && std::ssize(u) == inputs_ && std::ssize(y) == outputs());
    output_(plan_, state.data(), u.data(), y.data());
  }

  /// Advance, then the outputs at the end of the interval (u still held). Fast for a single output.
  void AdvanceAndOutput(std::span<double> state, std::span<const double> u, std::span<double> y) const {
    assert(std::ssize(state) == state_size_ && std::ssize(u) == inputs_ && std::ssize(y) == outputs());
    if (outputs() == 1) {
      y[0] = advance_and_output_(plan_, state.data(), u.data(), inputs_);
      return;
    }
    advance_(plan_, state.data(), u.data(), inputs_);
    output_(plan_, state.data(), u.data(), y.data());
  }

  /// dy/du at the end of the interval [r x m]: of the held input, and of du of a ramp.
  const Eigen::MatrixXd& held_gain() const { return held_gain_; }
  const Eigen::MatrixXd& ramp_gain() const { return ramp_gain_; }

 private:
  struct Coefficients;
  Propagator() = default;

  AdvanceKernel advance_ = nullptr;
  RespondKernel respond_ = nullptr;
  AdvanceAndOutputKernel advance_and_output_ = nullptr;
  OutputKernel output_ = nullptr;
  AddKernel add_ = nullptr;
  StepPlan plan_;  // points into coefficients_, which copies share
  std::shared_ptr<const Coefficients> coefficients_;
  CpuClass cpu_class_ = CpuClass::kBaseline;
  double interval_s_ = 0.0;
  int state_size_ = 0;
  int inputs_ = 0;
  Eigen::MatrixXd held_gain_, ramp_gain_;
};

}  // namespace dynoproof::mechanics
