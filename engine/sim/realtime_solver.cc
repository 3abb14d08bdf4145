// Solver `realtime`: fixed work per period. The linear part of the rig is carried exactly in modal coordinates. Where
// something is nonlinear, an interval is cut into equal substeps; in each, the nonlinear laws and parts are taken to
// change straight from their value at its beginning to that at its end, which a fixed number of correction sweeps finds
// (second order). Friction that slips on does so too; where the motion stops its torque jumps there, to the value that
// keeps it at rest until the end or, beyond its limit, slips the other way (time stepping with the set-valued law: no
// chatter). A law with modes that do not stick (contact) may change its mode once in a substep, at the zero of its
// guard: along the cubic of the twist its torque enters with its right mean and first moment, before and behind the
// jump (fourth order). Nothing is allocated in a step.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "linear/condensation.h"
#include "linear/decompositions.h"
#include "linear/modal_form.h"
#include "linear/propagator.h"
#include "model/law.h"
#include "sim/blocks.h"
#include "sim/linear_group.h"
#include "sim/solver.h"
#include "sim/substep.h"

namespace dynoproof {
namespace {

using mechanics::ModalForm;
using mechanics::Propagator;
using substep::Course;
using substep::kMostOfAPart;
using substep::Line;
using substep::LineOf;
using substep::Reach;
using substep::RungeKutta4;
using substep::SameSign;
using substep::StopOf;

/// Rounds in which the sticks of a substep settle. Few are needed: each solves for all that hold.
constexpr int kMostRounds = 8;
/// Of the largest torque: what less than that changes has settled.
constexpr double kSettled = 1e-12;

class RealtimeSolver : public Solver {
 public:
  static Result<std::unique_ptr<Solver>> Make(const Rig& rig, mechanics::Decompositions* known) {
    auto solver = std::unique_ptr<RealtimeSolver>(new RealtimeSolver(rig, known));
    for (const Interval& interval : rig.intervals) {
      const double share = rig.run.realtime.substeps * interval.length;
      const int substeps = solver->exact_ ? 1 : std::max(1, static_cast<int>(std::ceil(share - 1e-9)));
      const double length_s = interval.length * rig.SecondsOf(rig.period) / substeps;
      Result<Propagator> propagator = Propagator::Create(solver->form_, length_s);
      if (!propagator.ok()) return propagator.failure();
      solver->steps_.push_back({std::move(*propagator), substeps, length_s});
    }
    return std::unique_ptr<Solver>(std::move(solver));
  }

  Status Start(Frame& frame) override {
    StartBlocks(rig_, frame);
    return Resume(frame);
  }

  Status Resume(Frame& frame) override {
    Eigen::VectorXd x, p;
    group_.FromStates(frame.states, x, p);
    frame.solver.assign(form_.state_size() + group_.channels.size() + y0_.size(), 0.0);
    form_.SetState(x, p, State(frame));
    shift_.assign(form_.state_size(), 0.0);
    Renew(frame);
    return {};
  }

  std::vector<double> States(const Frame& frame) const override {
    std::vector<double> states = frame.states;
    Eigen::VectorXd x, p;
    form_.GetState({frame.solver.data(), static_cast<std::size_t>(form_.state_size())}, x, p);
    group_.ToStates(x, p, states);
    return states;
  }

  void Shift(Frame& frame, const std::vector<double>& change) override {
    Eigen::VectorXd x, p;
    group_.FromStates(change, x, p);
    form_.SetState(x, p, shift_);
    for (std::size_t i = 0; i < shift_.size(); ++i) frame.solver[i] += shift_[i];
    for (std::size_t i = 0; i < change.size(); ++i) frame.states[i] += change[i];
    Renew(frame);
  }

  /// In the solver's own coordinates, so that a correction costs two additions a state and error.
  class ModalCorrection : public Correction {
   public:
    ModalCorrection(RealtimeSolver& solver, const std::vector<std::vector<double>>& gains,
                    const std::vector<int>& taken)
        : solver_(solver) {
      const std::vector<double> none(static_cast<std::size_t>(solver.form_.inputs()), 0.0);
      const auto size = static_cast<std::size_t>(solver.form_.state_size());
      for (std::size_t j = 0; j < gains.size(); ++j) {
        const std::vector<double>& change = gains[j];
        Eigen::VectorXd x, p;
        solver.group_.FromStates(change, x, p);
        mechanics::AlignedVector modal(size, 0.0);
        solver.form_.SetState(x, p, modal);
        const std::size_t passed =
            taken.empty() || taken[j] < 0 ? solver.steps_.size() : static_cast<std::size_t>(taken[j]);
        for (std::size_t i = passed; i < solver.steps_.size(); ++i) {
          for (int k = 0; k < solver.steps_[i].substeps; ++k) solver.steps_[i].propagator.Advance(modal, none);
        }
        modal_.insert(modal_.end(), modal.begin(), modal.end());
        std::vector<Own>& own = own_.emplace_back();
        for (const int index : solver.roles_.nonlinear)
          AddOwn(solver.rig_.blocks[index].first_state, solver.rig_.blocks[index].states(), change, own);
        for (const auto& channel : solver.group_.channels) AddOwn(channel.state, channel.states, change, own);
      }
    }

    void Apply(Frame& frame, std::span<const double> errors) override {
      solver_.steps_.front().propagator.Add(modal_, errors, solver_.State(frame));
      for (std::size_t j = 0; j < own_.size(); ++j) {
        for (const Own& own : own_[j]) frame.states[own.state] += own.gain * errors[j];
      }
      if (!solver_.exact_) solver_.Renew(frame);
    }

   private:
    struct Own {  // a state that is not carried in modal coordinates
      std::size_t state;
      double gain;
    };
    static void AddOwn(int first, int count, const std::vector<double>& change, std::vector<Own>& own) {
      for (int i = first; i < first + count; ++i) {
        if (change[i] != 0.0) own.push_back({static_cast<std::size_t>(i), change[i]});
      }
    }

    RealtimeSolver& solver_;
    mechanics::AlignedVector modal_;  // a column for each error
    std::vector<std::vector<Own>> own_;
  };

  std::unique_ptr<Correction> MakeCorrection(const std::vector<std::vector<double>>& gains,
                                             const std::vector<int>& taken) override {
    return std::make_unique<ModalCorrection>(*this, gains, taken);
  }

  bool linear() const override { return exact_; }

  Status Advance(Frame& frame, int index) override {
    const Step& step = steps_[index];
    const double begin_s = rig_.SecondsOf(frame.time) + rig_.intervals[index].begin * rig_.SecondsOf(rig_.period);
    for (const int block : roles_.held) EvaluateAt(frame, block, begin_s);
    ++periods_;
    if (exact_) {
      ReadInputs(frame, v0_);
      step.propagator.Advance(State(frame), v0_);
      return {};
    }
    for (int i = 0; i < step.substeps; ++i) Substep(frame, step, begin_s + i * step.length_s, i);
    substeps_ += step.substeps;
    for (const int block : with_memory_) {
      ApplyEvent(rig_.blocks[block], kEndOfInterval, begin_s + step.substeps * step.length_s, frame.states, frame.modes,
                 frame.signals);
    }
    return {};
  }

  void Evaluate(Frame& frame, double time_s) override {
    for (const int block : roles_.held) EvaluateAt(frame, block, time_s);
    if (carried_) {
      for (std::size_t i = 0; i < group_.writes.size(); ++i) frame.signals[group_.writes[i]] = Answers(frame)[i];
    } else {
      Settle(frame, time_s);
    }
    for (const int block : roles_.behind) EvaluateAt(frame, block, time_s);
  }

  std::map<std::string, std::int64_t> counters() const override {
    return {{"periods", periods_}, {"substeps", substeps_}};
  }
  std::string Summary() const override { return summary_; }

 private:
  struct Step {
    Propagator propagator;
    int substeps;
    double length_s;
  };

  RealtimeSolver(const Rig& rig, mechanics::Decompositions* known)
      : rig_(rig), roles_(AssignRoles(rig)), with_memory_(BlocksWithMemory(rig)), group_(JoinLinearParts(rig, roles_)) {
    exact_ = roles_.nonlinear.empty() && std::all_of(group_.channels.begin(), group_.channels.end(),
                                                     [](const auto& one) { return one.channel.law->constant(); });
    form_ = FormOf(group_.system, known);
    if (rig.run.realtime.keep_below_Hz > 0.0)
      form_ = form_.KeepBelow(2.0 * std::numbers::pi * rig.run.realtime.keep_below_Hz);
    chained_ = std::find(group_.read_is_held.begin(), group_.read_is_held.end(), false) != group_.read_is_held.end() &&
               std::any_of(roles_.nonlinear.begin(), roles_.nonlinear.end(),
                           [&rig](int index) { return PassesThrough(*rig.blocks[index].component); });
    ahead_ = rig.run.realtime.part_corrections == 1 && !roles_.nonlinear.empty() &&
             std::none_of(roles_.nonlinear.begin(), roles_.nonlinear.end(), [this, &rig](int index) {
               const Block& block = rig.blocks[index];
               return block.states() == 0 || PassesThrough(*block.component) || ReadsAPart(block) ||
                      std::max<std::size_t>(block.states(), block.inputs.size()) > kMostOfAPart;
             });
    carried_ = !exact_ && (group_.system.D.array() == 0.0).all() && (roles_.nonlinear.empty() || ahead_);
    part_steps_.assign(group_.reads.size(), 0.0);
    for (const int index : roles_.nonlinear) {
      if (!ahead_) break;
      const Block& block = rig.blocks[index];
      AheadPart& part = ahead_parts_.emplace_back(
          AheadPart{&block, {}, block.first_state, block.states(), block.component->layout().modes});
      for (const int slot : block.inputs) {
        const auto write = std::find(group_.writes.begin(), group_.writes.end(), slot);
        part.inputs.push_back(
            {slot, write == group_.writes.end() ? -1 : static_cast<int>(write - group_.writes.begin())});
      }
    }
    summary_ = fmt::format(
        "{} pairs, {} real, {} integrators, {} states dropped, condition {:.1f}{}; {} nonlinear laws, "
        "{} nonlinear parts",
        form_.layout.pairs, form_.layout.reals, form_.layout.integrators, form_.dropped_states, form_.condition,
        form_.dense_fallback ? " (dense fallback)" : "", group_.channels.size(), roles_.nonlinear.size());
    const std::size_t m = form_.inputs(), r = form_.outputs();
    for (auto* vector : {&v0_, &held_, &ramp_}) vector->assign(m, 0.0);
    for (auto* vector : {&y0_, &y_free_, &y_}) vector->assign(r, 0.0);
    states_.assign(rig.state_ports.size(), 0.0);
    modes_.assign(rig.modes, 0);
    ends_.assign(group_.channels.size(), 0.0);
    begin_guards_.assign(group_.channels.size(), 0.0);
    rests_.assign(group_.channels.size(), {});
    FindLeaders();
    for (std::size_t e = 0; e < leaders_.size(); ++e) sticks_ += leaders_[e] == e && Law_(e).sticks() ? 1 : 0;
    if (sticks_ > 1) {
      const auto most = static_cast<std::size_t>(2 * sticks_);
      unknowns_.reserve(most);
      matrix_.assign(most * most, 0.0);
      for (auto* vector : {&right_, &solution_}) vector->assign(most, 0.0);
      order_.assign(most, 0);
    }
    for (auto& stage : stages_) stage.assign(rig.state_ports.size(), 0.0);
  }

  /// Frictions of one motion (two brakes of a body) stop at one instant: they are one friction of which each has a share.
  void FindLeaders() {
    const mechanics::LinearSystem& system = group_.system;
    const auto row = [this](std::size_t e) { return static_cast<Eigen::Index>(group_.writes.size() + 2 * e); };
    const auto column = [this](std::size_t e) { return static_cast<Eigen::Index>(group_.reads.size() + e); };
    for (std::size_t e = 0; e < group_.channels.size(); ++e) {
      std::size_t leader = 0;
      while (leader < e &&
             !(Law_(e).sticks() && Law_(leader).sticks() && system.B.col(column(e)) == system.B.col(column(leader)) &&
               system.C.middleRows(row(e), 2) == system.C.middleRows(row(leader), 2)))
        ++leader;
      leaders_.push_back(leader);
      together_ = together_ || leader != e;
    }
    shares_.assign(leaders_.size(), 0.0);
  }

  ModalForm FormOf(const mechanics::LinearSystem& system, mechanics::Decompositions* known) const {
    const auto decomposed = [known](const mechanics::LinearSystem& one) {
      return known != nullptr ? ModalForm::Build(one, *known->Of(one.A)) : ModalForm::Build(one);
    };
    // A law between two bodies feels the compliance of all modes, and could not be solved for where some are static.
    const double above_Hz = rig_.run.realtime.condense_above_Hz;
    if (above_Hz == 0.0 || !exact_ || !group_.channels.empty()) return decomposed(system);
    const mechanics::Condensed condensed = mechanics::Condense(system, 2.0 * std::numbers::pi * above_Hz);
    ModalForm form = decomposed(condensed.system);
    form.Expand(condensed.follows, condensed.kept);
    return form;
  }

  /// False for a part whose outputs follow from its states alone, such as a machine: nothing is to be settled there.
  static bool PassesThrough(const Component& component) {
    for (std::size_t out = 0; out < component.layout().outputs.size(); ++out) {
      for (std::size_t in = 0; in < component.layout().inputs.size(); ++in) {
        if (component.FeedsThrough(static_cast<int>(in), static_cast<int>(out))) return true;
      }
    }
    return false;
  }

  /// True when a nonlinear part is among what the block reads.
  bool ReadsAPart(const Block& block) const {
    return std::any_of(block.inputs.begin(), block.inputs.end(), [this](int slot) {
      return std::any_of(roles_.nonlinear.begin(), roles_.nonlinear.end(), [this, slot](int index) {
        const Block& other = rig_.blocks[index];
        return slot >= other.first_output && slot < other.first_output + other.outputs();
      });
    });
  }

  /// What follows from new states: the answers of the linear part and the torques of the laws.
  void Renew(Frame& frame) {
    for (const int block : roles_.nonlinear) EvaluateAt(frame, block, rig_.SecondsOf(frame.time));
    ReadInputs(frame, v0_);
    Outputs(frame, v0_, y0_);
    std::copy(y0_.begin(), y0_.end(), Answers(frame));
    for (std::size_t e = 0; e < group_.channels.size(); ++e) {
      if (!Law_(e).sticks()) {
        const LawView view{rig_.SecondsOf(frame.time), Twist(y0_, e),     Rate(y0_, e), 0.0,
                           OwnStates(frame, e),        OwnModes(frame, e)};
        Torque(frame)[e] = BeyondLinear(e, view);
      } else if (const double rate = Rate(y0_, e); rate != 0.0) {
        Torque(frame)[e] = Law_(e).SlipTorque(
            {rig_.SecondsOf(frame.time), Twist(y0_, e), rate, 0.0, OwnStates(frame, e), {}}, rate > 0.0 ? 1 : -1);
      }
    }
  }

  const Law& Law_(std::size_t e) const { return *group_.channels[e].channel.law; }
  std::span<double> State(Frame& frame) const {
    return {frame.solver.data(), static_cast<std::size_t>(form_.state_size())};
  }
  /// The torque that each channel applies now, beyond its linear part.
  double* Torque(Frame& frame) const { return frame.solver.data() + form_.state_size(); }
  /// Where carried_: the linear outputs at the present states.
  double* Answers(Frame& frame) const { return Torque(frame) + group_.channels.size(); }
  std::span<double> OwnStates(Frame& frame, std::size_t e) const { return OwnStates(frame.states, e); }
  std::span<double> OwnStates(std::vector<double>& states, std::size_t e) const {
    return {states.data() + group_.channels[e].state, static_cast<std::size_t>(group_.channels[e].states)};
  }

  void ReadInputs(Frame& frame, std::vector<double>& v) const {
    for (std::size_t i = 0; i < group_.reads.size(); ++i) v[i] = frame.signals[group_.reads[i]];
    for (std::size_t e = 0; e < group_.channels.size(); ++e) v[group_.reads.size() + e] = Torque(frame)[e];
  }
  void EvaluateAt(Frame& frame, int block, double time_s) const {
    EvaluateBlock(rig_.blocks[block], time_s, frame.states, frame.modes, frame.signals);
  }
  /// Linear and nonlinear signals that pass each other on at one instant, made consistent: v0_, y0_ and frame.signals.
  /// Each pass settles one more nonlinear part of a chain.
  void Settle(Frame& frame, double time_s) {
    for (std::size_t pass = 0; pass <= roles_.nonlinear.size(); ++pass) {
      ReadInputs(frame, v0_);
      Outputs(frame, v0_, y0_);
      for (std::size_t i = 0; i < group_.writes.size(); ++i) frame.signals[group_.writes[i]] = y0_[i];
      for (const int block : roles_.nonlinear) EvaluateAt(frame, block, time_s);
      if (!chained_) break;
    }
  }
  void Outputs(Frame& frame, const std::vector<double>& v, std::vector<double>& y) const {
    // A propagator of any length gives the same outputs; before the first exists (never in a run) there are none.
    if (!steps_.empty()) steps_.front().propagator.Output(State(frame), v, y);
  }
  double Twist(const std::vector<double>& y, std::size_t e) const { return y[group_.writes.size() + 2 * e]; }
  double Rate(const std::vector<double>& y, std::size_t e) const { return y[group_.writes.size() + 2 * e + 1]; }

  double BeyondLinear(std::size_t e, double time_s, const std::vector<double>& y, std::span<const double> own) const {
    return BeyondLinear(e, {time_s, Twist(y, e), Rate(y, e), 0.0, own, {}});
  }
  double BeyondLinear(std::size_t e, const LawView& view) const {
    const SpringDamper& linear = group_.channels[e].channel.linear;
    return Law_(e).Torque(view) - linear.stiffness * view.twist - linear.damping * view.rate;
  }

  /// True for a law whose torque may jump with its mode: the time of the jump is found within the substep.
  bool Switches(std::size_t e) const { return group_.channels[e].switches; }
  std::span<int> OwnModes(Frame& frame, std::size_t e) const { return OwnModes(frame.modes, e); }
  std::span<int> OwnModes(std::vector<int>& modes, std::size_t e) const {
    return {modes.data() + group_.channels[e].mode, static_cast<std::size_t>(group_.channels[e].modes)};
  }

  /// A law between y0_ (s = 0) and y_ (s = 1) of a substep of length h: the twist by its cubic, the rate its slope.
  LawView Between(std::size_t e, double time_s, double h, double s, std::span<const double> own,
                  std::span<const int> modes) const {
    const double d0 = Twist(y0_, e), d1 = Twist(y_, e), w0 = Rate(y0_, e), w1 = Rate(y_, e), r = 1.0 - s;
    return {time_s + s * h,
            r * r * (1.0 + 2.0 * s) * d0 + s * s * (3.0 - 2.0 * s) * d1 + s * r * h * (r * w0 - s * w1),
            6.0 * s * r * (d1 - d0) / h + r * (1.0 - 3.0 * s) * w0 + s * (3.0 * s - 2.0) * w1,
            0.0,
            own,
            modes};
  }

  static constexpr std::size_t kMostLawStates = 8;  // more states than any law of the field has
  /// Carries the states of a law that switches from s0 to s1 of the substep in its present mode.
  void AdvanceSwitching(std::size_t e, double time_s, double h, double s0, double s1, std::span<double> own,
                        std::span<const int> modes) const {
    if (own.empty()) return;
    assert(own.size() <= kMostLawStates);
    RungeKutta4(own, (s1 - s0) * h, [&](double share, std::span<const double> x, std::span<double> rates) {
      Law_(e).Derivative(Between(e, time_s, h, s0 + share * (s1 - s0), x, modes), rates);
    });
  }

  /// Runs a law from s0 to s1 in its present mode; `own` ends there.
  Course Run(std::size_t e, double time_s, double h, double s0, double s1, double begin, std::span<double> own,
             std::span<const int> modes) const {
    const double half = 0.5 * (s0 + s1);
    AdvanceSwitching(e, time_s, h, s0, half, own, modes);
    const double middle = BeyondLinear(e, Between(e, time_s, h, half, own, modes));
    AdvanceSwitching(e, time_s, h, half, s1, own, modes);
    return {begin, middle, BeyondLinear(e, Between(e, time_s, h, s1, own, modes))};
  }

  /// The torque of a law with modes over the substep, in one course or in two around its event.
  Line Switch(std::size_t e, double time_s, double h, double begin, std::span<double> own, std::span<int> modes) {
    assert(own.size() <= kMostLawStates);
    double saved[kMostLawStates];
    const Law& law = Law_(e);
    const auto restore = [&] { std::copy_n(saved, own.size(), own.begin()); };
    std::copy(own.begin(), own.end(), saved);
    double guard[2] = {begin_guards_[e], 0.0};
    const Course whole = Run(e, time_s, h, 0.0, 1.0, begin, own, modes);
    law.Guards(Between(e, time_s, h, 1.0, own, modes), {&guard[1], 1});
    if (guard[0] > 0.0 && guard[1] > 0.0) return LineOf(whole, Course::Flat(whole.end), 1.0);
    // The zero of the guard by false position, bracketed; the guard is smooth within a mode.
    double low = 0.0, high = 1.0, at = guard[0] <= 0.0 ? 0.0 : guard[0] / (guard[0] - guard[1]);
    for (int i = 0; i < 3 && at > 0.0; ++i) {
      restore();
      AdvanceSwitching(e, time_s, h, 0.0, at, own, modes);
      double value = 0.0;
      law.Guards(Between(e, time_s, h, at, own, modes), {&value, 1});
      (value > 0.0 ? low : high) = at;
      guard[value > 0.0 ? 0 : 1] = value;
      at = low + (high - low) * guard[0] / (guard[0] - guard[1]);
    }
    restore();
    const Course before = Run(e, time_s, h, 0.0, at, begin, own, modes);
    const LawView event = Between(e, time_s, h, at, own, modes);
    law.OnEvent(event, 0, own, modes);
    const double jumped = BeyondLinear(e, Between(e, time_s, h, at, own, modes));
    return LineOf(before, Run(e, time_s, h, at, 1.0, jumped, own, modes), at);
  }

  /// Carries a law's own states over a substep along the straight line between twists and rates y0_ and y_.
  void AdvanceLaw(std::size_t e, double time_s, double h, std::span<double> own) {
    assert(own.size() <= kMostLawStates);
    RungeKutta4(own, h, [&](double s, std::span<const double> x, std::span<double> rates) {
      const LawView view{time_s + s * h,
                         Twist(y0_, e) + s * (Twist(y_, e) - Twist(y0_, e)),
                         Rate(y0_, e) + s * (Rate(y_, e) - Rate(y0_, e)),
                         0.0,
                         x,
                         {}};
      Law_(e).Derivative(view, rates);
    });
  }

  Reach ReachOf(const Propagator& propagator, std::size_t row, std::size_t column) const {
    const double held = propagator.held_gain()(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    const double ramp = propagator.ramp_gain()(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    return {y_[row] - held * held_[column] - ramp * ramp_[column], held, ramp};
  }

  /// Friction over a substep. Who slips on in the same direction has the torques of both ends. Else the motion stops
  /// within the substep, and from there on a torque holds it, or what slips the other way. What rests is held by the
  /// straight torque that leaves neither speed nor travel at the end, until that breaks away; where another friction stops
  /// within the substep its torque jumps, and what cannot hold against that breaks away there. All of second order.
  Line StickOrSlip(std::size_t e, double time_s, const Step& step, Frame& frame) {
    const Propagator& propagator = step.propagator;
    const std::size_t row = group_.writes.size() + 2 * e, column = group_.reads.size() + e;
    const Reach rate = ReachOf(propagator, row + 1, column), twist = ReachOf(propagator, row, column);
    const double h = step.length_s, end_s = time_s + h, begin = Rate(y0_, e);
    rests_[e] = {};
    const auto slip = [&](double at_s, const std::vector<double>& y, double speed, double drive, int sign) {
      double sum = 0.0;
      for (std::size_t f = e; f < leaders_.size(); ++f) {
        if (leaders_[f] == e)
          sum += Law_(f).SlipTorque({at_s, Twist(y, e), speed, drive, OwnStates(frame, f), {}}, sign);
      }
      return sum;
    };
    double stop = 0.0, moving = 0.0;  // the share of the substep until the motion stops, the torque until then
    // A speed that round-off has left, beside what the substep makes of it, is rest.
    if (std::abs(begin) > substep::kLeastShare * std::abs(Rate(y_, e))) {
      const int sign = begin > 0.0 ? 1 : -1;
      moving = slip(time_s, y0_, begin, 0.0, sign);
      if (SameSign(begin, Rate(y_, e))) {
        const double end = slip(end_s, y_, Rate(y_, e), 0.0, sign);
        if (SameSign(rate.At(moving, end - moving), begin)) return LineOf(moving, end);
      }
      stop = StopOf(begin, rate.At(moving, 0.0), (twist.At(moving, 0.0) - Twist(y0_, e)) / h);
      rests_[e].jump = stop;
      rests_[e].before = moving;
    }
    if (stop == 1.0) return LineOf(moving, moving);
    if (stop == 0.0) {
      const double travel = Twist(y0_, e) - twist.without, scale = rate.held * twist.ramp - rate.ramp * twist.held;
      const double hold = (-rate.without * twist.ramp - rate.ramp * travel) / scale;
      const double change = (rate.held * travel + rate.without * twist.held) / scale, last = hold + change;
      const bool begins = std::abs(hold) <= std::abs(slip(time_s, y0_, 0.0, hold, hold > 0.0 ? 1 : -1));
      const int sign = last > 0.0 ? 1 : -1;
      const double limit = slip(end_s, y_, 0.0, last, sign);
      if (begins && std::abs(last) <= std::abs(limit)) {
        rests_[e].from = 0.0;
        return LineOf(hold, last);
      }
      // Where another friction that stops within the substep is why it breaks away: it holds until there.
      for (std::size_t f = 0; f < rests_.size() && stop == 0.0; ++f) {
        const Rest& its = rests_[f];
        if (f == e || its.jump <= 0.0 || its.jump >= 1.0) continue;
        const std::size_t other = group_.reads.size() + f;
        const Reach felt = ReachOf(propagator, row + 1, other);
        if (felt.held == 0.0) continue;
        const double as_before = rate.without + felt.held * (its.before - held_[other]) - felt.ramp * ramp_[other];
        const double needed = -as_before / rate.held;
        if (std::abs(needed) > std::abs(slip(time_s, y0_, 0.0, needed, needed > 0.0 ? 1 : -1))) continue;
        moving = needed;
        stop = its.jump;
      }
      if (stop == 0.0 && begins) {
        const double leave = std::clamp((limit - hold) / change, 0.0, 1.0);
        const Course still = Course::Straight(hold, limit);
        const Line line = LineOf(still, Course::Flat(limit), leave);
        const double after = slip(end_s, y_, rate.At(line.held, line.ramp), last, sign);
        return LineOf(still, Course::Flat(after), leave);
      }
    }
    const auto with = [&](double after) { return LineOf(Course::Flat(moving), Course::Flat(after), stop); };
    const auto left = [&](double after) { return rate.At(with(after).held, with(after).ramp); };
    const double free = left(0.0), hold = -free / (left(1.0) - free);
    const int sign = hold > 0.0 ? 1 : -1;
    const double limit = slip(end_s, y_, 0.0, hold, sign);
    if (std::abs(hold) <= std::abs(limit)) {
      rests_[e].from = stop;
      return with(hold);
    }
    const double after = slip(end_s, y_, left(limit), hold, sign);
    return with(std::copysign(std::min(std::abs(after), std::abs(hold)), hold));  // friction never drives
  }

  void Substep(Frame& frame, const Step& step, double time_s, int number) {
    const std::size_t reads = group_.reads.size(), channels = group_.channels.size();
    const std::span<double> state = State(frame);
    if (!carried_ && !ahead_) Settle(frame, time_s);  // a held signal that feeds through may have jumped
    if (number == 0 || (!carried_ && !ahead_)) ReadInputs(frame, v0_);
    if (carried_) {
      for (std::size_t r = 0; r < y0_.size(); ++r) y0_[r] = Answers(frame)[r];
    } else if (ahead_) {
      step.propagator.Output(state, v0_, y0_);
    }
    SaveStates(frame);
    step.propagator.Advance(state, v0_);
    step.propagator.Output(state, v0_, y_free_);
    for (std::size_t i = 0; i < v0_.size(); ++i) {
      held_[i] = v0_[i];
      ramp_[i] = 0.0;
    }
    for (std::size_t e = 0; e < channels; ++e) {
      if (leaders_[e] != e) held_[reads + leaders_[e]] += std::exchange(held_[reads + e], 0.0);
    }
    if (ahead_) {
      if (number == 0) AdvanceAhead(frame, time_s, step);
      for (std::size_t i = 0; i < reads; ++i) {
        ramp_[i] = part_steps_[i];
        AddGain(step.propagator.ramp_gain(), i, ramp_[i], 0, y_free_);
      }
    }
    std::copy(y_free_.begin(), y_free_.end(), y_.begin());
    for (std::size_t e = 0; e < channels; ++e) {
      if (!Switches(e)) continue;
      Law_(e).Guards(Between(e, time_s, step.length_s, 0.0, OwnStates(frame, e), OwnModes(frame, e)),
                     {&begin_guards_[e], 1});
    }
    std::fill(rests_.begin(), rests_.end(), Rest{});
    for (int sweep = 0; sweep < rig_.run.realtime.corrections; ++sweep) {
      if (!roles_.nonlinear.empty() && !ahead_ &&
          (rig_.run.realtime.part_corrections == 0 || sweep < rig_.run.realtime.part_corrections)) {
        AdvanceParts(frame, time_s, step.length_s, sweep == 0 && !carried_);
        for (std::size_t i = 0; i < reads; ++i) {
          if (!group_.read_is_held[i]) ramp_[i] = frame.signals[group_.reads[i]] - v0_[i];
        }
        Correct(step.propagator);
      }
      for (std::size_t e = 0; e < channels; ++e) {
        SweepLaw(frame, step, time_s, e);
        Correct(step.propagator);
      }
    }
    SettleSticks(frame, step, time_s);
    for (std::size_t c = 0; c < v0_.size(); ++c) {
      if (held_[c] != v0_[c] || ramp_[c] != 0.0) {
        step.propagator.Respond(state, static_cast<int>(c), held_[c] - v0_[c], ramp_[c]);
      }
    }
    if (carried_) {
      Correct(step.propagator, 0);
      std::copy(y_.begin(), y_.end(), Answers(frame));
    }
    if (together_) ShareOut(frame, time_s + step.length_s);
    for (std::size_t i = 0; i < v0_.size(); ++i) v0_[i] = held_[i] + ramp_[i];  // the next substep goes on from there
    for (std::size_t e = 0; e < channels; ++e) {
      v0_[reads + e] = ends_[e];
      Torque(frame)[e] = v0_[reads + e];
    }
  }

  /// What frictions of one motion have together at the end of a substep, to each in proportion to what it can have.
  void ShareOut(Frame& frame, double time_s) {
    for (std::size_t e = 0; e < leaders_.size(); ++e) {
      if (leaders_[e] != e || !Law_(e).sticks()) continue;
      const auto each = [&](const auto& body) {
        for (std::size_t f = e; f < leaders_.size(); ++f) {
          if (leaders_[f] == e) body(f);
        }
      };
      const auto own = [&](std::size_t f) {
        return std::abs(Law_(f).SlipTorque({time_s, Twist(y_, e), Rate(y_, e), 0.0, OwnStates(frame, f), {}},
                                           ends_[e] > 0.0 ? 1 : -1));
      };
      const double all = ends_[e];
      double most = 0.0;
      each([&](std::size_t f) { most += own(f); });
      each([&](std::size_t f) { shares_[f] = most > 0.0 ? all * (own(f) / most) : 0.0; });
      if (most > 0.0) each([&](std::size_t f) { ends_[f] = shares_[f]; });
    }
  }

  /// Keeps what a substep begins with: the states of laws and parts, and modes.
  void SaveStates(const Frame& frame) {
    for (const auto& channel : group_.channels) {
      std::copy_n(frame.states.begin() + channel.state, channel.states, states_.begin() + channel.state);
      std::copy_n(frame.modes.begin() + channel.mode, channel.modes, modes_.begin() + channel.mode);
    }
    if (ahead_) return;
    for (const int index : roles_.nonlinear) {
      const Block& block = rig_.blocks[index];
      std::copy_n(frame.states.begin() + block.first_state, block.states(), states_.begin() + block.first_state);
    }
  }

  /// One correction of a law: its states at the end of the substep, and the course of its torque in held_ and ramp_.
  void SweepLaw(Frame& frame, const Step& step, double time_s, std::size_t e) {
    const auto& channel = group_.channels[e];
    const std::size_t column = group_.reads.size() + e;
    const std::span<double> own = OwnStates(frame, e);
    std::copy_n(states_.begin() + channel.state, channel.states, own.begin());
    const double h = step.length_s;
    Line torque;
    if (channel.switches) {
      std::copy_n(modes_.begin() + channel.mode, channel.modes, OwnModes(frame, e).begin());
      torque = Switch(e, time_s, h, v0_[column], own, OwnModes(frame, e));
    } else {
      AdvanceLaw(e, time_s, h, own);
      if (leaders_[e] != e) {
        ends_[e] = 0.0;
        return;
      }
      torque = Law_(e).sticks() ? StickOrSlip(e, time_s, step, frame)
                                : LineOf(v0_[column], BeyondLinear(e, time_s + h, y_, own));
    }
    held_[column] = torque.held;
    ramp_[column] = torque.ramp;
    ends_[e] = torque.end;
  }

  /// What one stick holds depends on what the others hold: a clutch beside a brake. Those that rest at the end of the
  /// substep are solved for together, then all laws are asked again with that, until none says anything else.
  void SettleSticks(Frame& frame, const Step& step, double time_s) {
    if (sticks_ < 2) return;
    const std::size_t reads = group_.reads.size(), channels = group_.channels.size();
    for (int round = 0; round < kMostRounds; ++round) {
      HoldTogether(step);
      double moved = 0.0, size = 0.0;
      for (std::size_t e = 0; e < channels; ++e) {
        const double held = held_[reads + e], ramp = ramp_[reads + e];
        SweepLaw(frame, step, time_s, e);
        Correct(step.propagator);
        moved = std::max({moved, std::abs(held_[reads + e] - held), std::abs(ramp_[reads + e] - ramp)});
        size = std::max({size, std::abs(held), std::abs(ramp)});
      }
      if (moved <= kSettled * size) return;
    }
  }

  /// The torques of all sticks that rest, changed so that none has a speed at the end of the substep, nor a travel
  /// where it rested all along. Where two hold the same, one takes the change: any share of each would do.
  void HoldTogether(const Step& step) {
    const std::size_t reads = group_.reads.size(), channels = group_.channels.size();
    unknowns_.clear();
    for (std::size_t e = 0; e < channels; ++e) {
      const double from = Law_(e).sticks() ? rests_[e].from : 1.0, rest = 1.0 - from;
      if (rest == 0.0) continue;
      if (from > 0.0) {  // the torque behind the stop: substep::LineOf
        unknowns_.push_back({e, group_.writes.size() + 2 * e + 1, rest * (1.0 - 3.0 * from), 6.0 * from * rest, 1.0});
        continue;
      }
      unknowns_.push_back({e, group_.writes.size() + 2 * e + 1, 1.0, 0.0, 1.0});
      unknowns_.push_back({e, group_.writes.size() + 2 * e, 0.0, 1.0, 1.0});
    }
    const std::size_t n = unknowns_.size();
    if (n < 2) return;
    const Eigen::MatrixXd &held = step.propagator.held_gain(), &ramp = step.propagator.ramp_gain();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t row = unknowns_[i].row;
      const bool travel = (row - group_.writes.size()) % 2 == 0;
      const double scale = travel ? 1.0 / step.length_s : 1.0;  // speeds
      for (std::size_t j = 0; j < n; ++j) {
        const std::size_t column = reads + unknowns_[j].channel;
        matrix_[i * n + j] = scale * (unknowns_[j].held * held.data()[column * y_.size() + row] +
                                      unknowns_[j].ramp * ramp.data()[column * y_.size() + row]);
      }
      right_[i] = scale * ((travel ? y0_[row] : 0.0) - y_[row]);
    }
    substep::SolveWhatIsSure({matrix_.data(), n * n}, {right_.data(), n}, {solution_.data(), n}, {order_.data(), n});
    for (std::size_t i = 0; i < n; ++i) {
      const Unknown& one = unknowns_[i];
      held_[reads + one.channel] += one.held * solution_[i];
      ramp_[reads + one.channel] += one.ramp * solution_[i];
      ends_[one.channel] += one.end * solution_[i];
    }
    Correct(step.propagator);
  }

  /// y += gain's column of an input times `amount`, from row `first` on.
  static void AddGain(const Eigen::MatrixXd& gain, std::size_t input, double amount, std::size_t first,
                      std::vector<double>& y) {
    if (amount == 0.0) return;
    const double* column = gain.data() + input * y.size();
    for (std::size_t r = first; r < y.size(); ++r) y[r] += column[r] * amount;
  }

  /// y_ for the present held_ and ramp_; without parts that listen only the channels' twists and rates.
  void Correct(const Propagator& propagator) {
    Correct(propagator, roles_.nonlinear.empty() || ahead_ ? group_.writes.size() : 0);
  }
  void Correct(const Propagator& propagator, std::size_t first) {
    for (std::size_t r = first; r < y_.size(); ++r) y_[r] = y_free_[r];
    for (std::size_t c = ahead_ ? group_.reads.size() : 0; c < v0_.size();
         ++c) {  // ahead: y_free_ has the parts' share
      AddGain(propagator.held_gain(), c, held_[c] - v0_[c], first, y_);
      AddGain(propagator.ramp_gain(), c, ramp_[c], first, y_);
    }
  }

  /// Carries parts that follow from their states alone (machines) over the whole interval in its first substep, with
  /// the linear signals running on as straight as they begin; what they answer then changes in equal steps.
  void AdvanceAhead(Frame& frame, double time_s, const Step& step) {
    const double h = step.substeps * step.length_s;
    for (const AheadPart& part : ahead_parts_) {
      const std::size_t inputs = part.inputs.size();
      double begin[kMostOfAPart], change[kMostOfAPart], u[kMostOfAPart];
      for (std::size_t i = 0; i < inputs; ++i) {
        const auto [slot, write] = part.inputs[i];
        begin[i] = write < 0 ? frame.signals[slot] : y0_[write];
        change[i] = write < 0 ? 0.0 : step.substeps * (y_free_[write] - y0_[write]);
      }
      const std::span<double> own(frame.states.data() + part.first_state, part.states);
      const std::span<const int> modes(frame.modes.data() + part.block->first_mode, part.modes);
      RungeKutta4(own, h, [&](double s, std::span<const double> x, std::span<double> rates) {
        for (std::size_t i = 0; i < inputs; ++i) u[i] = begin[i] + s * change[i];
        part.block->component->Derivative({time_s + s * h, {u, inputs}, x, modes}, rates);
      });
      EvaluateBlock(*part.block, time_s + h, frame.states, frame.modes, frame.signals);
    }
    for (std::size_t i = 0; i < group_.reads.size(); ++i) {
      part_steps_[i] = group_.read_is_held[i] ? 0.0 : (frame.signals[group_.reads[i]] - v0_[i]) / step.substeps;
    }
  }

  /// Carries the nonlinear parts over a substep (Runge-Kutta 4) while the linear signals run straight from y0_ to y_.
  /// `settled`: they have been evaluated at its beginning.
  void AdvanceParts(Frame& frame, double time_s, double h, bool settled) {
    const double weight[5] = {0.0, 0.5, 0.5, 1.0, 1.0};
    for (int stage = 0; stage < 5; ++stage) {
      const double s = weight[stage];
      if (stage > 0 || !settled) {
        for (std::size_t i = 0; i < group_.writes.size(); ++i) {
          frame.signals[group_.writes[i]] = y0_[i] + s * (y_[i] - y0_[i]);
        }
        for (const int index : roles_.nonlinear) PutStage(frame, rig_.blocks[index], stage, s * h, h);
        for (const int index : roles_.nonlinear) EvaluateAt(frame, index, time_s + s * h);
      }
      if (stage == 4) break;
      for (const int index : roles_.nonlinear) {
        EvaluateRates(rig_.blocks[index], time_s + s * h, frame.states, frame.modes, frame.signals, stages_[stage]);
      }
    }
  }

  /// The states of a part where a stage of the Runge-Kutta method wants them; 4: at the end.
  void PutStage(Frame& frame, const Block& block, int stage, double step, double h) const {
    const std::size_t first = static_cast<std::size_t>(block.first_state),
                      count = static_cast<std::size_t>(block.states());
    double* const x = frame.states.data() + first;
    const double* const begin = states_.data() + first;
    if (stage == 0) {
      std::copy_n(begin, count, x);
    } else if (stage < 4) {
      const double* const rate = stages_[stage - 1].data() + first;
      for (std::size_t i = 0; i < count; ++i) x[i] = begin[i] + step * rate[i];
    } else {
      const double* const k[4] = {stages_[0].data() + first, stages_[1].data() + first, stages_[2].data() + first,
                                  stages_[3].data() + first};
      for (std::size_t i = 0; i < count; ++i) {
        x[i] = begin[i] + h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
      }
    }
  }

  const Rig& rig_;
  Roles roles_;
  std::vector<int> with_memory_;
  LinearGroup group_;
  ModalForm form_;
  bool ahead_ = false;    // part_corrections = 1 and no part reads another or passes its inputs through
  bool carried_ = false;  // nothing feeds through: what a substep ends with is what the next begins with
  struct AheadPart {
    const Block* block;
    struct Input {
      int slot, write;  // place among group_.writes, or -1
    };
    std::vector<Input> inputs;
    int first_state, states, modes;
  };
  std::vector<AheadPart> ahead_parts_;
  std::vector<double> part_steps_;  // by reads: their change in a substep, for such parts
  bool chained_ = false;            // the linear group reads a nonlinear part that passes its inputs through
  bool exact_ = true;               // nothing is nonlinear, but constant: one exact step per interval
  std::vector<Step> steps_;         // by interval
  std::string summary_;
  std::int64_t periods_ = 0, substeps_ = 0;
  // Scratch memory of a step: inputs at its beginning, held and straight parts of their course; outputs.
  mechanics::AlignedVector shift_;
  std::vector<double> v0_, held_, ramp_, y0_, y_free_, y_, states_, ends_, begin_guards_;
  std::vector<int> modes_;
  std::vector<double> stages_[4];
  // Sticks: where each rests until the end of the substep, from which share of it on (1: it does not), and the equations
  // of those that do.
  struct Rest {
    double from = 1.0;
    double jump = 0.0;    // the share at which it stops and its torque jumps; 0, 1: not within
    double before = 0.0;  // its torque until then
  };
  struct Unknown {
    std::size_t channel, row;  // what its torque is to bring to rest: a rate or a twist among y
    double held, ramp, end;    // what a change of it by 1 does to the torque
  };
  int sticks_ = 0;
  bool together_ = false;             // frictions of one motion are there
  std::vector<std::size_t> leaders_;  // by channel: the first one of the same motion, itself where there is none before
  std::vector<double> shares_;
  std::vector<Rest> rests_;
  std::vector<Unknown> unknowns_;
  std::vector<double> matrix_, right_, solution_;
  std::vector<std::size_t> order_;
};

}  // namespace

Result<std::unique_ptr<Solver>> MakeRealtimeSolver(const Rig& rig, mechanics::Decompositions* known) {
  return RealtimeSolver::Make(rig, known);
}

}  // namespace dynoproof
