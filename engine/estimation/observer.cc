#include "estimation/observer.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "base/subnormals.h"
#include "estimation/sensor_chain.h"
#include "linear/dense.h"
#include "model/motion.h"
#include "score/series.h"
#include "sim/simulate.h"

namespace dynoproof::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// More states than these change no gain by a ten-thousandth (a soft rotor of 143 states: 39 or 23 give the same gain).
constexpr int kMostStates = 40;
constexpr std::int64_t kLooks = 64;      // frames of a nonlinear model's free run that tell its regimes
constexpr std::size_t kMostRegimes = 8;  // the rarer ones use the gain of the most visited
constexpr std::size_t kMostFrames = 9;   // of a regime, whose mean is taken
constexpr double kStep = 1e-6;           // of differences of a nonlinear model, in usual magnitudes
// Shares between which unknown forces are sought, four a decade: beyond, a record is followed rather than predicted.
constexpr double kLeastShare = 1e-6, kMostShare = 10.0;
constexpr int kShares = 29, kHalvings = 8;
constexpr double kRemembered = 1e3;
constexpr double kNotSeen = 1e-9;  // of what the outputs see most of
// Periods for which is asked what outputs see: over a whole record a speed that turns a position outweighs all that swings.
constexpr double kLooked = 100.0;

/// Differences about frames of one run.
class Differences {
 public:
  explicit Differences(const BuiltRun& run)
      : run_(run), other_(*run.rig, *run.solver), step_(run.solver->linear() ? 1.0 : kStep) {}

  /// The states after one period, and the outputs before it.
  Result<std::pair<VectorXd, VectorXd>> After(const Frame& frame, const std::vector<int>& outputs) {
    Frame now = frame;
    run_.solver->Evaluate(now, run_.rig->SecondsOf(now.time));
    VectorXd seen(std::ssize(outputs));
    for (Index j = 0; j < seen.size(); ++j) {
      const int signal = run_.rig->outputs[static_cast<std::size_t>(outputs[static_cast<std::size_t>(j)])].signal;
      seen[j] = now.signals[static_cast<std::size_t>(signal)];
    }
    other_.Restore(frame);
    if (Status failed = other_.Integrate()) return *failed;
    return std::pair(StatesOf(other_.frame()), seen);
  }

  VectorXd StatesOf(const Frame& frame) const {
    const std::vector<double> states = run_.solver->States(frame);
    return Eigen::Map<const VectorXd>(states.data(), std::ssize(states));
  }

  Frame Shifted(const Frame& frame, const VectorXd& change) const {
    Frame shifted = frame;
    run_.solver->Shift(shifted, {change.data(), change.data() + change.size()});
    return shifted;
  }

  double step() const { return step_; }

 private:
  const BuiltRun& run_;
  Simulation other_;
  double step_;
};

/// d(states after a period) and d(outputs now) along the columns of `directions` [states x k].
Result<std::pair<MatrixXd, MatrixXd>> Along(Differences& differences, const Frame& frame, const MatrixXd& directions,
                                            const std::vector<int>& outputs) {
  // Moved by nothing: what a solver carries over from the period before is renewed in all that are compared.
  const auto base = differences.After(differences.Shifted(frame, VectorXd::Zero(directions.rows())), outputs);
  if (!base.ok()) return base.failure();
  MatrixXd A(base->first.size(), directions.cols()), C(base->second.size(), directions.cols());
  for (Index i = 0; i < directions.cols(); ++i) {
    const auto moved = differences.After(differences.Shifted(frame, differences.step() * directions.col(i)), outputs);
    if (!moved.ok()) return moved.failure();
    A.col(i) = (moved->first - base->first) / differences.step();
    C.col(i) = (moved->second - base->second) / differences.step();
  }
  return std::pair(std::move(A), std::move(C));
}

/// The value of a mode by its name; none where the rig has no such mode.
std::optional<int> ModeOf(const Rig& rig, const std::vector<int>& modes, const std::string& name) {
  const auto found = std::ranges::find(rig.mode_names, name);
  if (found == rig.mode_names.end()) return std::nullopt;
  return modes[static_cast<std::size_t>(found - rig.mode_names.begin())];
}

/// A frame of `from` as one of `to`, a rig of the same machine: states, signals and modes by their names.
Result<Frame> Transplanted(const BuiltRun& from, const Frame& frame, const BuiltRun& to) {
  Frame result = to.rig->MakeFrame();
  result.time = frame.time;
  result.step = frame.step;
  const std::vector<double> states = from.solver->States(frame);
  for (std::size_t i = 0; i < to.rig->state_ports.size(); ++i) {
    for (std::size_t k = 0; k < states.size(); ++k) {
      if (from.rig->state_ports[k].name == to.rig->state_ports[i].name) result.states[i] = states[k];
    }
  }
  for (std::size_t i = 0; i < to.rig->slots.size(); ++i) {
    const int slot = from.rig->FindSlot(to.rig->slots[i]);
    if (slot >= 0) result.signals[i] = frame.signals[static_cast<std::size_t>(slot)];
  }
  if (result.rings.size() == frame.rings.size()) result.rings = frame.rings;
  for (std::size_t i = 0; i < to.rig->mode_names.size(); ++i)
    result.modes[i] = ModeOf(*from.rig, frame.modes, to.rig->mode_names[i]).value_or(0);
  if (Status failed = to.solver->Resume(result)) return *failed;
  return result;
}

/// RMS of a record's input; the usual magnitude of one that the record does not drive.
double SizeOf(const InputLine& line, const MappedRecord& record) {
  const auto driven = record.inputs.find(line.name);
  const double rms = driven != record.inputs.end() ? score::RootMeanSquare(*driven->second.values) : 0.0;
  return rms > 0.0 ? rms : line.nominal;
}

/// A torque on each body that has one, as plans, and the torque that the inputs usually have [N m].
std::vector<std::pair<std::string, Plan>> Loaded(const Plan& plan, double torque, const Registry& registry) {
  std::vector<std::pair<std::string, Plan>> loaded;
  const PlantTraits& plant = registry.PlantOf(plan);
  const Effect* load = registry.FindEffect("constant_load");
  if (load == nullptr || !plant.bodies) return loaded;
  for (const Place& place : plant.bodies(plan)) {
    Plan with = plan;
    load->Apply(with, place, {torque});
    loaded.emplace_back(place.ToString(), std::move(with));
  }
  return loaded;
}

/// Change of each state by one period of each unknown force of its usual size [states x forces].
Result<MatrixXd> Moved(const BuiltRun& run, Differences& differences, const Frame& frame, const MappedRecord& record,
                       const std::vector<BuiltRun>& loaded) {
  const VectorXd none = VectorXd::Zero(std::ssize(run.rig->state_ports));
  const auto base = differences.After(differences.Shifted(frame, none), {});
  if (!base.ok()) return base.failure();
  MatrixXd G(base->first.size(), std::ssize(loaded) + std::ssize(run.rig->inputs));
  Index column = 0;
  for (const BuiltRun& other : loaded) {
    const Result<Frame> there = Transplanted(run, frame, other);
    if (!there.ok()) return there.failure();
    Differences by_load(other);
    const auto moved = by_load.After(*there, {});
    if (!moved.ok()) return moved.failure();
    for (Index i = 0; i < G.rows(); ++i) {
      G(i, column) = 0.0;
      for (std::size_t k = 0; k < other.rig->state_ports.size(); ++k) {
        if (other.rig->state_ports[k].name == run.rig->state_ports[static_cast<std::size_t>(i)].name)
          G(i, column) = moved->first[static_cast<Index>(k)] - base->first[i];
      }
    }
    ++column;
  }
  for (const InputLine& line : run.rig->inputs) {
    Frame driven = frame;
    const double size = SizeOf(line, record);
    driven.signals[static_cast<std::size_t>(line.delayed)] += differences.step() * size;
    const auto moved = differences.After(differences.Shifted(driven, none), {});
    if (!moved.ok()) return moved.failure();
    G.col(column++) = (moved->first - base->first) / differences.step();
  }
  return G;
}

/// Frames of the run for which it is linearised, by regime, the most visited first.
Result<std::vector<std::vector<Frame>>> FramesOf(const BuiltRun& run) {
  const FlushSubnormals flush;
  Simulation simulation(*run.rig, *run.solver);
  if (Status failed = simulation.Start()) return *failed;
  struct Visited {
    std::int64_t periods = 0;
    std::vector<Frame> looked,
        first;  // at regular looks; its first ones, which do where it is so short that no look meets it
  };
  std::map<std::vector<int>, Visited> by_modes;
  const std::int64_t every = std::max<std::int64_t>(1, run.rig->steps / kLooks);
  for (std::int64_t step = 0; step < run.rig->steps; ++step) {
    if (Status failed = simulation.Tick()) {
      if (by_modes.empty()) return *failed;
      break;  // a free run that breaks says enough until then
    }
    Visited& visited = by_modes[simulation.frame().modes];
    ++visited.periods;
    if (step % every == 0) visited.looked.push_back(simulation.frame());
    if (visited.first.size() < kMostFrames) visited.first.push_back(simulation.frame());
    if (run.solver->linear()) break;
    if (simulation.Integrate()) break;
  }
  std::vector<Visited> most;
  for (auto& [modes, visited] : by_modes) most.push_back(std::move(visited));
  std::ranges::stable_sort(most, std::ranges::greater(), &Visited::periods);
  if (most.size() > kMostRegimes) most.resize(kMostRegimes);
  std::vector<std::vector<Frame>> regimes;
  for (Visited& visited : most) regimes.push_back(std::move(visited.looked.empty() ? visited.first : visited.looked));
  for (std::vector<Frame>& frames : regimes) {
    std::vector<Frame> few;
    for (std::size_t i = 0; i < std::min(kMostFrames, frames.size()); ++i)
      few.push_back(frames[(2 * i + 1) * frames.size() / (2 * std::min(kMostFrames, frames.size()))]);
    frames = std::move(few);
  }
  return regimes;
}

/// Element by element.
MatrixXd Median(const std::vector<MatrixXd>& all) {
  MatrixXd median = all.front();
  std::vector<double> values(all.size());
  for (Index i = 0; i < median.size(); ++i) {
    for (std::size_t k = 0; k < all.size(); ++k) values[k] = all[k].data()[i];
    median.data()[i] = score::Median(values);
  }
  return median;
}

std::vector<int> OutputsOf(const Rig& rig, const std::vector<std::string>& names) {
  std::vector<int> outputs;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(rig.outputs, name, &OutputLine::name);
    if (found != rig.outputs.end()) outputs.push_back(static_cast<int>(found - rig.outputs.begin()));
  }
  return outputs;
}

/// A to the power of `count`, and the covariance that as many periods of white forces leave.
std::pair<MatrixXd, MatrixXd> Over(int count, const MatrixXd& A, const MatrixXd& G) {
  MatrixXd power = MatrixXd::Identity(A.rows(), A.rows()), covariance = MatrixXd::Zero(A.rows(), A.rows());
  for (int k = 0; k < count; ++k) {
    covariance = (A * covariance * A.transpose() + G * G.transpose()).eval();
    power = (A * power).eval();
  }
  return {power, covariance};
}

/// LinearModel::seen, each output by its own size.
MatrixXd SeenIn(const std::vector<LinearModel::Regime>& regimes) {
  const Index n = regimes.front().A.rows();
  if (n == 0) return MatrixXd(0, 0);
  MatrixXd gramian = MatrixXd::Zero(n, n);
  for (const LinearModel::Regime& regime : regimes) {
    const VectorXd size = regime.C.rowwise().norm().cwiseMax(1e-300);
    gramian +=
        mechanics::Observability(regime.A, size.cwiseInverse().asDiagonal() * regime.C, std::exp(-1.0 / kLooked));
  }
  MatrixXd seen = mechanics::RangeOf(gramian);
  return seen.cols() < n ? seen : MatrixXd::Identity(n, n);  // all of it: in the states' own coordinates
}

}  // namespace

Result<LinearModel> LinearModel::Of(const Plan& plan, const MappedRecord& record, const Registry& registry) {
  const Result<BuiltRun> whole = BuildRun(plan, record, registry),
                         run = BuildRun(WithoutSensors(plan), record, registry);
  for (const Result<BuiltRun>* one : {&whole, &run}) {
    if (!one->ok()) return one->failure();
  }
  LinearModel model;
  model.period_s = run->rig->SecondsOf(run->rig->period);
  for (const Port& port : run->rig->state_ports) model.states.push_back(port.name);
  model.modes = run->rig->mode_names;
  for (const auto& [name, series] : record.outputs) model.outputs.push_back(name);
  const std::vector<int> outputs = OutputsOf(*run->rig, model.outputs);
  if (outputs.size() != model.outputs.size())
    return Failure{"an output of the record is not in the plan", plan.id, {}, 2};
  if (Status failed = model.SeeThrough(*whole)) return *failed;
  const auto n = std::ssize(model.states);
  model.scale.resize(n);
  for (Index i = 0; i < n; ++i) model.scale[i] = run->rig->state_ports[static_cast<std::size_t>(i)].nominal;
  double torque = 0.0;
  for (const InputLine& line : run->rig->inputs)
    torque = std::max(torque, IsForce(line.unit) ? SizeOf(line, record) : 0.0);
  std::vector<BuiltRun> loaded;
  for (auto& [name, with] : Loaded(WithoutSensors(plan), torque > 0.0 ? torque : 1.0, registry)) {
    Result<BuiltRun> one = BuildRun(std::move(with), record, registry);
    if (!one.ok()) return one.failure();
    loaded.push_back(*std::move(one));
    model.forces.push_back(name);
  }
  for (const InputLine& line : run->rig->inputs) model.forces.push_back("input:" + line.name);
  const Result<std::vector<std::vector<Frame>>> frames = FramesOf(*run);
  if (!frames.ok()) return frames.failure();
  Differences differences(*run);
  const MatrixXd axes = model.scale.asDiagonal();
  for (const std::vector<Frame>& of_regime : *frames) {
    std::vector<MatrixXd> A, G, C;
    for (const Frame& frame : of_regime) {
      const auto slopes = Along(differences, frame, axes, outputs);
      const auto moved = Moved(*run, differences, frame, record, loaded);
      if (!slopes.ok()) return slopes.failure();
      if (!moved.ok()) return moved.failure();
      A.push_back(model.scale.cwiseInverse().asDiagonal() * slopes->first);
      G.push_back(model.scale.cwiseInverse().asDiagonal() * *moved);
      C.push_back(model.slopes.asDiagonal() * slopes->second);
    }
    model.regimes.push_back({of_regime.front().modes, Median(A), Median(G), Median(C)});
  }
  if (n == 0) return model;
  const Regime& first = model.regimes.front();
  const double leak = std::exp(-model.period_s / std::max(record.end_s, model.period_s));
  // Outputs count by their own magnitude.
  VectorXd size(std::ssize(model.outputs));
  for (Index j = 0; j < size.size(); ++j)
    size[j] =
        std::ranges::find(run->rig->outputs, model.outputs[static_cast<std::size_t>(j)], &OutputLine::name)->nominal;
  const MatrixXd weights = size.cwiseInverse().asDiagonal();
  model.part = mechanics::Balance(first.A, first.G, weights * first.C, leak, kMostStates);
  if (n <= kMostStates) {
    // Few states are all kept, but those that no regime ever sees: what one does not see another may.
    for (const Regime& regime : model.regimes)
      model.part.seen =
          model.part.seen.cwiseMax(mechanics::Balance(regime.A, regime.G, weights * regime.C, leak, kMostStates).seen);
    std::vector<Index> kept;
    for (Index i = 0; i < n; ++i) {
      if (model.part.seen[i] >= kNotSeen) kept.push_back(i);
    }
    model.part.basis = MatrixXd::Identity(n, n)(Eigen::indexing::all, kept);
    model.part.reduction = model.part.basis.transpose();
  }
  for (Regime& regime : model.regimes) {
    regime.A = (model.part.reduction * regime.A * model.part.basis).eval();
    regime.G = (model.part.reduction * regime.G).eval();
    regime.C = (regime.C * model.part.basis).eval();
  }
  model.seen = SeenIn(model.regimes);
  return model;
}

Status LinearModel::SeeThrough(const BuiltRun& run) {
  Simulation simulation(*run.rig, *run.solver);
  if (Status failed = simulation.Start()) return failed;
  if (Status failed = simulation.Tick()) return failed;
  slopes.resize(std::ssize(outputs));
  kept.resize(std::ssize(outputs));
  Index j = 0;
  for (const int output : OutputsOf(*run.rig, outputs)) {
    const SensorChain sensor(*run.rig, static_cast<std::size_t>(output));
    // A magnitude counts as what it is the magnitude of.
    slopes[j] = std::abs(sensor.SlopeAt(simulation.frame(), 0.0));
    kept[j++] = KeptOver(period_s, sensor.lag_s());
  }
  return {};
}

Result<LinearModel> LinearModel::Reduced(const BuiltRun& whole, const BuiltRun& run) const {
  if (!run.solver->linear()) return Failure{"the model is not linear", run.rig->id};
  const auto same = [](const Port& port, const std::string& name) { return port.name == name; };
  if (!std::ranges::equal(run.rig->state_ports, states, same))
    return Failure{"the model has other states", run.rig->id};
  Simulation simulation(*run.rig, *run.solver);
  if (Status failed = simulation.Start()) return *failed;
  if (Status failed = simulation.Tick()) return *failed;
  Differences differences(run);
  const auto moved =
      Along(differences, simulation.frame(), scale.asDiagonal() * part.basis, OutputsOf(*run.rig, outputs));
  if (!moved.ok()) return moved.failure();
  LinearModel reduced = *this;
  if (Status failed = reduced.SeeThrough(whole)) return *failed;
  reduced.regimes = {{regimes.front().modes, part.reduction * scale.cwiseInverse().asDiagonal() * moved->first,
                      regimes.front().G, reduced.slopes.asDiagonal() * moved->second}};
  reduced.seen = SeenIn(reduced.regimes);
  return reduced;
}

namespace {

/// How large unknown forces are for which a corrected run forgets as fast as is wanted.
class ShareSearch {
 public:
  struct Found {
    double share = 0.0;
    std::size_t regime = 0;
    double memory_s = std::numeric_limits<double>::infinity();
  };

  ShareSearch(const LinearModel& model, VectorXd variance, int stride, double memory_s)
      : model_(model), variance_(std::move(variance)), stride_(stride), memory_s_(memory_s) {
    for (const LinearModel::Regime& regime : model.regimes) over_.push_back(Over(stride, regime.A, regime.G));
  }

  mechanics::StationaryFilter Filter(std::size_t regime, double share) const {
    const auto& [A, unit] = over_[regime];
    // What no output sees in a regime, as the way through a gap, would become ever more uncertain: nothing is remembered for
    // longer than a thousand memories.
    const double leak = std::exp(-stride_ * model_.period_s / (kRemembered * memory_s_));
    return mechanics::MakeStationaryFilter(leak * A, model_.regimes[regime].C, share * share * unit, variance_);
  }

  /// The smallest share with which the most visited regime that can forgets as fast as wanted; the fastest, where none can. What no force
  /// moves, as a wall that was given a large inertia, no gain corrects: where it is all that is remembered, the memory is that of the rest.
  Found Find() const {
    const Found found = Find([](std::size_t) { return std::size_t{0}; });
    if (found.memory_s <= kRemembered * memory_s_) return found;
    return Find([&](std::size_t regime) { return Still(regime); });
  }

 private:
  /// The time constants [s] of the modes of the corrected run, the slowest first.
  std::vector<double> TimeConstants(std::size_t regime, double share) const {
    const MatrixXd &A = over_[regime].first, &C = model_.regimes[regime].C;
    std::vector<double> constants;
    for (const auto& value : dense::Eigenvalues(model_.Seen(A - A * Filter(regime, share).gain * C))) {
      const double size = std::abs(value);
      constants.push_back(!(size < 1.0) ? std::numeric_limits<double>::infinity()
                          : size > 0.0  ? stride_ * model_.period_s * (-1.0 / std::log(size))
                                        : 0.0);
    }
    std::ranges::sort(constants, std::ranges::greater());
    return constants;
  }

  static double ShareAt(double place) {
    return kLeastShare * std::pow(kMostShare / kLeastShare, place / (kShares - 1));
  }

  /// Modes that are remembered for more than a thousand memories with whatever share.
  std::size_t Still(std::size_t regime) const {
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (int i = 0; i < kShares; ++i) {
      const auto count = std::ranges::count_if(TimeConstants(regime, ShareAt(i)), [&](double constant_s) {
        return !(constant_s <= kRemembered * memory_s_);
      });
      least = std::min(least, static_cast<std::size_t>(count));
    }
    return least;
  }

  /// `still_in(regime)`: how many of its slowest modes do not count.
  template <class StillIn>
  Found Find(const StillIn& still_in) const {
    Found best;
    for (std::size_t regime = 0; regime < over_.size(); ++regime) {
      const std::size_t still = still_in(regime);
      const auto with = [&](double share) {
        const std::vector<double> all = TimeConstants(regime, share);
        const double memory_s = all.empty()          ? 0.0
                                : still < all.size() ? all[still]
                                                     : std::numeric_limits<double>::infinity();
        return Found{share, regime, memory_s};
      };
      int first = -1;
      for (int i = 0; i < kShares && first < 0; ++i) {
        const Found one = with(ShareAt(i));
        if (one.memory_s <= memory_s_) first = i;
        if (one.memory_s < best.memory_s) best = one;
      }
      if (first < 0) continue;
      double low = first - 1, high = first;
      for (int i = 0; i < kHalvings && first > 0; ++i) {
        const double middle = 0.5 * (low + high);
        (with(ShareAt(middle)).memory_s > memory_s_ ? low : high) = middle;
      }
      return with(ShareAt(high));
    }
    return best;
  }

  const LinearModel& model_;
  VectorXd variance_;
  int stride_;
  double memory_s_;  // wanted
  std::vector<std::pair<MatrixXd, MatrixXd>>
      over_;  // by regime: one sample's step, and the covariance of unit forces over it
};

}  // namespace

Observer::Observer(const LinearModel& model, const VectorXd& noise, double step_s, double memory_s)
    : states_(model.states),
      modes_(model.modes),
      slopes_(model.slopes),
      stride_(std::max(1, static_cast<int>(std::lround(step_s / model.period_s)))) {
  const VectorXd variance = noise.cwiseAbs2();
  const ShareSearch search(model, variance, stride_, memory_s);
  const ShareSearch::Found found = search.Find();
  share_ = found.share;
  memory_s_ = found.memory_s;
  for (std::size_t k = 0; k < model.regimes.size(); ++k) {
    const LinearModel::Regime& regime = model.regimes[k];
    const mechanics::StationaryFilter filter = search.Filter(k, share_);
    if (k == found.regime)
      innovation_covariance_ = regime.C * filter.covariance * regime.C.transpose() + MatrixXd(variance.asDiagonal());
    MatrixXd physical = model.scale.asDiagonal() * model.part.basis * filter.gain;
    // What no output ever sees, as the angle where speeds are measured, runs on: moved along with what is seen, it would
    // make a spring of a friction.
    for (Index i = 0; i < physical.rows(); ++i) {
      if (model.part.seen[i] < kNotSeen) physical.row(i).setZero();
    }
    gains_.push_back({regime.modes, filter.gain, std::move(physical)});
  }
}

VectorXd Observer::NoiseAlone(const LinearModel& model, const VectorXd& white) const {
  const LinearModel::Regime& regime = model.regimes.front();
  const MatrixXd A = model.Seen(Over(stride_, regime.A, regime.G).first), C = regime.C * model.seen;
  const VectorXd kept = model.kept.array().pow(stride_), passed = 1.0 - kept.array();
  const MatrixXd AK =
      A * model.seen.transpose() * gains_.front().reduced * slopes_.cwiseQuotient(model.slopes).asDiagonal();
  // States: those of the model, the noise of the sample before, and what the lags hold. What corrects is the error behind
  // the inverse of a lag, (e - kept e-) / passed; what is compared has passed it.
  const Index n = A.rows(), m = white.size();
  MatrixXd L = MatrixXd::Zero(n + 2 * m, n + 2 * m), B = MatrixXd::Zero(n + 2 * m, m), H = MatrixXd::Zero(m, n + 2 * m);
  L.topLeftCorner(n, n) = A - AK * C;
  L.block(0, n, n, m) = -AK * kept.cwiseQuotient(passed).asDiagonal();
  L.block(n + m, 0, m, n) = passed.asDiagonal() * C;
  L.block(n + m, n + m, m, m) = kept.asDiagonal();
  B.topRows(n) = AK * passed.cwiseInverse().asDiagonal();
  B.middleRows(n, m).setIdentity();
  H.leftCols(n) = passed.asDiagonal() * C;
  H.rightCols(m) = kept.asDiagonal();
  const MatrixXd covariance = mechanics::StationaryCovariance(L, B * white.cwiseAbs2().asDiagonal() * B.transpose());
  return ((H * covariance * H.transpose()).diagonal() + white.cwiseAbs2()).cwiseSqrt();
}

std::vector<std::vector<double>> Observer::GainsFor(const Rig& rig, const std::vector<int>& modes) const {
  // An effect brings modes of its own, as a friction its sticking: those count for nothing here.
  std::vector<std::optional<int>> known;
  for (const std::string& name : modes_) known.push_back(ModeOf(rig, modes, name));
  // One flank of a gap is nearer to the other, and slipping to slipping back, than to what is between.
  const auto others = [&](const Gain& one) {
    int distance = 0;
    for (std::size_t i = 0; i < known.size(); ++i) {
      if (known[i] && *known[i] != one.modes[i]) distance += std::abs(*known[i]) == std::abs(one.modes[i]) ? 1 : 2;
    }
    return distance;
  };
  const MatrixXd& gain = std::ranges::min_element(gains_, {}, others)->physical;
  std::vector<std::vector<double>> columns(static_cast<std::size_t>(gain.cols()),
                                           std::vector<double>(rig.state_ports.size(), 0.0));
  for (std::size_t i = 0; i < rig.state_ports.size(); ++i) {
    const std::optional<std::size_t> state = CorrectedAs(states_, rig.state_ports[i].name);
    if (!state) continue;
    for (Index j = 0; j < gain.cols(); ++j)
      columns[static_cast<std::size_t>(j)][i] = gain(static_cast<Index>(*state), j);
  }
  return columns;
}

double MemoryFor(const LinearModel& model, double duration_s) {
  // On the soft rotor 15 periods of its first mode are 25 ms, by which fits from nominal reach the truth; on a servo axis a
  // tenth of its slowest time constant is as much. From the sixth part of that to ten times as much the result is the same.
  constexpr double kPeriods = 15.0, kOfSlowest = 0.1;
  // A plant that forgets by itself is corrected within a third of that, or not at all.
  constexpr double kOfForgetting = 1.0 / 3.0;
  constexpr double kFewestSteps = 10.0, kMostOfRecord = 0.1;
  double period_s = 0.0, slowest_s = 0.0, forgets_s = 0.0;
  if (!model.regimes.empty() && model.HasStates()) {
    for (const std::complex<double>& value : dense::Eigenvalues(model.Seen(model.regimes.front().A))) {
      const double turn = std::abs(std::arg(value)), decay = -std::log(std::abs(value));
      const double constant_s = decay > 0.0 ? model.period_s / decay : std::numeric_limits<double>::infinity();
      forgets_s = std::max(forgets_s, constant_s);
      // The common speed of a line has an eigenvalue of 1, give or take a rounding error: it is no mode where that makes it grow.
      const bool turns = turn > std::max(decay, 0.0);
      if (turns && turn < 3.0) period_s = std::max(period_s, 2.0 * std::numbers::pi / turn * model.period_s);
      if (!turns && constant_s < duration_s) slowest_s = std::max(slowest_s, constant_s);
    }
  }
  double memory_s = period_s > 0.0 ? kPeriods * period_s : kOfSlowest * slowest_s;
  if (forgets_s > 0.0) memory_s = std::min(memory_s, kOfForgetting * forgets_s);
  if (!(memory_s > 0.0)) memory_s = 0.01 * duration_s;
  return std::max(std::min(memory_s, kMostOfRecord * duration_s), kFewestSteps * model.period_s);
}

double LeadInOf(double memory_s, double duration_s) {
  constexpr double kMemories = 5.0, kMostOfRecord = 0.2;
  return std::min(kMemories * memory_s, kMostOfRecord * duration_s);
}

}  // namespace dynoproof::estimation
