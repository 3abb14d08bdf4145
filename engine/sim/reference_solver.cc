// Solver `reference`: all continuous blocks as one system of equations in an adaptive SUNDIALS integrator. Events are
// located; the integrator restarts after each, and wherever a held signal changes.
#include <fmt/format.h>

#include <cmath>

#include "sim/blocks.h"
#include "sim/integrators.h"
#include "sim/solver.h"

namespace dynoproof {
namespace {

/// More events than this in one period is chatter, not physics.
constexpr int kMostEvents = 10'000;
/// More events of one guard at one instant than this are no way to a mode that holds.
constexpr int kMostTurns = 8;
/// What a guard of exactly 0 counts as, on the side where it was last: far below anything that the arithmetic of a law
/// gives, and still a number whose products have a sign.
constexpr double kHair = 1e-100;

Failure Chatters(const Rig& rig, double time_s) { return {"events without end: the model chatters", rig.id, time_s}; }

class ReferenceSolver : public Solver {
 public:
  static Result<std::unique_ptr<Solver>> Make(const Rig& rig) {
    auto solver = std::unique_ptr<ReferenceSolver>(new ReferenceSolver(rig));
    if (rig.state_ports.empty()) return std::unique_ptr<Solver>(std::move(solver));
    ReferenceSolver& self = *solver;
    OdeProblem problem;
    problem.relative_tolerance = rig.run.reference.relative_tolerance;
    problem.max_step_s = rig.run.reference.max_step_s;
    problem.guard_count = rig.guards;
    for (const Port& state : rig.state_ports) {
      problem.absolute_tolerance.push_back(rig.run.reference.relative_tolerance * state.nominal);
    }
    problem.rates = [&self](double time_s, std::span<const double> states, std::span<double> rates) {
      self.Rates(time_s, states, rates);
    };
    problem.guards = [&self](double time_s, std::span<const double> states, std::span<double> values) {
      self.Guards(time_s, states, values);
    };
    auto integrator = rig.run.reference.method == "bdf" ? MakeBdfIntegrator(std::move(problem))
                                                        : MakeExplicitIntegrator(std::move(problem));
    if (!integrator.ok()) return integrator.failure();
    solver->integrator_ = std::move(*integrator);
    return std::unique_ptr<Solver>(std::move(solver));
  }

  Status Start(Frame& frame) override {
    StartBlocks(rig_, frame);
    Forget(frame.solver);  // a guard that is negative from the start is an event at t = 0
    return {};
  }

  Status Resume(Frame& frame) override {
    modes_ = frame.modes;
    signals_ = frame.signals;
    Forget(frame.solver);  // the other solver kept no sides: what is negative is an event now
    return {};
  }

  Status Advance(Frame& frame, int index) override {
    const Interval& interval = rig_.intervals[index];
    const double period_s = rig_.SecondsOf(rig_.period);
    double time_s = rig_.SecondsOf(frame.time) + interval.begin * period_s;
    // The next tick as the clock will say it, so that both solvers see the same times.
    const bool last = index + 1 == static_cast<int>(rig_.intervals.size());
    const double end_s = last ? rig_.SecondsOf(frame.time + rig_.period)
                              : rig_.SecondsOf(frame.time) + rig_.intervals[index + 1].begin * period_s;
    signals_ = frame.signals;
    modes_ = frame.modes;
    if (integrator_ == nullptr) return {};
    marks_ = frame.solver;
    // What a mode began below 0 was allowed for the last interval; held signals have changed since.
    for (int i = 0; i < rig_.guards; ++i) {
      if (of_a_mode_[i]) marks_[i] = 0.0;
    }
    if (Status failed = Settle(frame, time_s)) return failed;
    if (Status failed = integrator_->Restart(time_s, frame.states)) return failed;
    for (int events = 0; time_s < end_s; ++events) {
      if (Status failed = integrator_->Evolve(end_s, time_s, frame.states, roots_)) return failed;
      if (roots_.empty()) break;
      if (events > kMostEvents) return Chatters(rig_, time_s);
      if (Status failed = Settle(frame, time_s)) return failed;
      if (time_s >= end_s) break;
      if (Status failed = integrator_->Restart(time_s, frame.states)) return failed;
    }
    if (!with_memory_.empty()) EvaluateFeeding(end_s, frame.states);
    for (const int block : with_memory_) {
      ApplyEvent(rig_.blocks[block], kEndOfInterval, end_s, frame.states, modes_, signals_);
    }
    if (Status failed = Settle(frame, end_s)) return failed;
    frame.modes = modes_;
    frame.solver = marks_;
    return {};
  }

  std::vector<double> States(const Frame& frame) const override { return frame.states; }

  void Shift(Frame& frame, const std::vector<double>& change) override {
    // The sides stay: a guard that the change carries over to the other one is an event as the next interval begins.
    for (std::size_t i = 0; i < change.size(); ++i) frame.states[i] += change[i];
  }

  class StateCorrection : public Correction {
   public:
    explicit StateCorrection(std::vector<std::vector<double>> gains) : gains_(std::move(gains)) {}
    void Apply(Frame& frame, std::span<const double> errors) override {
      for (std::size_t j = 0; j < gains_.size(); ++j) {
        for (std::size_t i = 0; i < gains_[j].size(); ++i) frame.states[i] += gains_[j][i] * errors[j];
      }
    }

   private:
    std::vector<std::vector<double>> gains_;
  };

  std::unique_ptr<Correction> MakeCorrection(const std::vector<std::vector<double>>& gains,
                                             const std::vector<int>&) override {
    return std::make_unique<StateCorrection>(gains);
  }

  bool linear() const override { return false; }

  void Evaluate(Frame& frame, double time_s) override {
    EvaluateBlocks(rig_, time_s, frame.states, frame.modes, frame.signals);
  }

  std::map<std::string, std::int64_t> counters() const override {
    std::map<std::string, std::int64_t> all;
    if (integrator_ != nullptr) all = integrator_->counters();
    all["events"] = events_;
    return all;
  }
  std::string Summary() const override {
    return integrator_ == nullptr ? "no states"
                                  : fmt::format("{}, {} states, relative tolerance {:g}", integrator_->name(),
                                                rig_.state_ports.size(), rig_.run.reference.relative_tolerance);
  }

 private:
  explicit ReferenceSolver(const Rig& rig) : rig_(rig), with_memory_(BlocksWithMemory(rig)) {
    const std::vector<bool> feeds = FeedsDynamics(rig);
    for (std::size_t i = 0; i < feeds.size(); ++i) {
      if (feeds[i]) feeding_.push_back(&rig.blocks[i]);
    }
    of_a_mode_.assign(rig.guards, false);
    for (const Block& block : rig.blocks) {
      for (int i = 0; i < block.component->layout().guards; ++i)
        of_a_mode_[block.first_guard + i] = block.component->IsOfAMode(i);
    }
    turns_.assign(rig.guards, 0);
  }

  void Forget(mechanics::AlignedVector& marks) const {
    marks.assign(rig_.guards, 1.0);
    for (int i = 0; i < rig_.guards; ++i) {
      if (of_a_mode_[i]) marks[i] = 0.0;
    }
  }

  /// The outputs that some state depends on; all others wait until somebody looks.
  void EvaluateFeeding(double time_s, std::span<const double> states) {
    for (const Block* block : feeding_) EvaluateBlock(*block, time_s, states, modes_, signals_);
  }

  void Rates(double time_s, std::span<const double> states, std::span<double> rates) {
    EvaluateFeeding(time_s, states);
    for (const Block& block : rig_.blocks) {
      if (block.states() > 0) EvaluateRates(block, time_s, states, modes_, signals_, rates);
    }
  }

  /// As the integrator sees them: a mode's guard above 0 as long as the mode holds, from where it began. Never 0: a
  /// guard that just touches 0 is still on the side where it was last. Round numbers make that common (a torque that
  /// meets the friction's limit), and the integrator watches no guard that is 0 as it restarts.
  void Guards(double time_s, std::span<const double> states, std::span<double> values) {
    EvaluateFeeding(time_s, states);
    for (const Block& block : rig_.blocks) {
      if (block.component->layout().guards > 0) EvaluateGuards(block, time_s, states, modes_, signals_, values);
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (of_a_mode_[i]) values[i] += marks_[i];
      if (values[i] == 0.0) values[i] = of_a_mode_[i] ? kHair : marks_[i] * kHair;
    }
  }

  bool Crossed(int guard) const {
    return of_a_mode_[guard] ? guards_[guard] < 0.0 : marks_[guard] * guards_[guard] < 0.0;
  }

  /// One event: the block that owns the guard changes its modes and states.
  void Happen(int guard, double time_s, Frame& frame) {
    ++events_;
    for (const Block& block : rig_.blocks) {
      const int local = guard - block.first_guard;
      if (local < 0 || local >= block.component->layout().guards) continue;
      EvaluateFeeding(time_s, frame.states);
      ApplyEvent(block, local, time_s, frame.states, modes_, signals_);
    }
  }

  /// Every kink that is not on its last side and every mode that holds no more is an event: the integrator found it, a
  /// held signal jumped, or another event changed what it sees. One after the other, since each may call off the next
  /// or bring it about. A mode may begin below 0 by round-off, with nothing else to be found: it is asked again where it
  /// has fallen twice as far, so that it never creeps away and few questions are enough.
  Status Settle(Frame& frame, double time_s) {
    if (rig_.guards == 0) return {};
    guards_.resize(rig_.guards);
    std::fill(turns_.begin(), turns_.end(), 0);
    for (int events = 0; events <= kMostEvents; ++events) {
      Guards(time_s, frame.states, guards_);
      int crossed = 0;
      while (crossed < rig_.guards && !Crossed(crossed)) ++crossed;
      if (crossed == rig_.guards) return {};
      before_ = modes_;
      Happen(crossed, time_s, frame);
      marks_[crossed] = of_a_mode_[crossed] ? 0.0 : 1.0;
      Guards(time_s, frame.states, guards_);
      if (!of_a_mode_[crossed]) {
        marks_[crossed] = std::copysign(1.0, guards_[crossed]);
      } else if (guards_[crossed] < 0.0 && (modes_ == before_ || ++turns_[crossed] > kMostTurns)) {
        marks_[crossed] = -2.0 * guards_[crossed];
      }
    }
    return Chatters(rig_, time_s);
  }

  const Rig& rig_;
  std::vector<const Block*> feeding_;
  std::vector<int> with_memory_;
  std::unique_ptr<Integrator> integrator_;
  std::vector<double> signals_, guards_;
  std::vector<bool> of_a_mode_;
  /// Of each guard after its last event. Kinks: the side, +1 or -1. Of a mode: how far below 0 the mode began.
  mechanics::AlignedVector marks_;
  std::vector<int> modes_, before_, roots_, turns_;
  std::int64_t events_ = 0;
};

}  // namespace

Result<std::unique_ptr<Solver>> MakeReferenceSolver(const Rig& rig) { return ReferenceSolver::Make(rig); }

}  // namespace dynoproof
