#include "experiment/prediction_windows.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/subnormals.h"
#include "experiment/checks.h"
#include "score/series.h"
#include "score/white_noise.h"

namespace dynoproof {
namespace {

// The inputs count as known to this share of their RMS over a window: it sets how long the filter remembers.
// assumed: what torque estimates of drives are good for; no other value has been tried.
constexpr double kInputShare = 0.01;
// What a simulation is good for: sensors without noise count as having this share of their spread.
constexpr double kLeastNoise = 1e-4;
// Derivatives of a period are taken anew where a mode changes, and every so many ticks.
constexpr std::int64_t kDeriveEvery = 10;
// Steps of the differences, in a state's usual magnitude: linear there, far above round-off.
constexpr double kStep = 1e-6;
// What is known of the state before the first sample: times its usual magnitudes. A twist of that much is wider than a
// gap.
constexpr double kUnknown = 100.0;

/// The sample of each tick: a series counts at the tick next to its time stamps.
std::vector<double> ByTick(const Series& series, double period_s, std::int64_t steps) {
  std::vector<double> samples(static_cast<std::size_t>(steps) + 1, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < series.time->size(); ++i) {
    const auto tick = std::llround((*series.time)[i] / period_s);
    if (tick >= 0 && tick <= steps) samples[static_cast<std::size_t>(tick)] = (*series.values)[i];
  }
  return samples;
}

/// The filter along the nominal model's run beside the record.
class Filter {
 public:
  Filter(const Rig& rig, Solver& solver, Observer& observer)
      : rig_(rig),
        solver_(solver),
        observer_(observer),
        run_(rig, solver),
        other_(rig, solver),
        n_(static_cast<Eigen::Index>(rig.state_ports.size())),
        m_(static_cast<Eigen::Index>(observer.outputs.size())) {
    for (const std::string& name : observer.outputs)
      columns_.push_back(static_cast<std::size_t>(FindOutput(rig, name)));
    scale_.resize(n_);
    for (Eigen::Index i = 0; i < n_; ++i) scale_[i] = rig.state_ports[static_cast<std::size_t>(i)].nominal;
    covariance_ = (kUnknown * scale_).cwiseAbs2().asDiagonal();
  }

  /// `noise`: variance by output; `disturbance`: standard deviation by input of the rig, white from tick to tick.
  Status Run(const Eigen::VectorXd& noise, const Eigen::VectorXd& disturbance) {
    if (Status failed = run_.Start()) return failed;
    observer_.gains.reserve(observer_.measured.front().size() * static_cast<std::size_t>(n_ * m_));
    for (std::int64_t step = 0; step <= rig_.steps; ++step) {
      if (Status failed = run_.Tick()) return failed;
      Correct(static_cast<std::size_t>(step), noise);
      if (step == rig_.steps) break;
      const Frame before = run_.frame();
      if (Status failed = run_.Integrate()) return failed;
      if (step % kDeriveEvery == 0 || before.modes != run_.frame().modes || before.modes != derived_for_) {
        derived_for_ = before.modes == run_.frame().modes ? before.modes : std::vector<int>{kNever};
        if (Status failed = Derive(before)) return failed;
      }
      covariance_ = transition_ * covariance_ * transition_.transpose();
      for (Eigen::Index i = 0; i < effect_.cols(); ++i) {
        const Eigen::VectorXd moved = disturbance[i] * effect_.col(i);
        covariance_.noalias() += moved * moved.transpose();
      }
      covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
    }
    return {};
  }

 private:
  static constexpr int kNever = std::numeric_limits<int>::min();

  void Correct(std::size_t tick, const Eigen::VectorXd& noise) {
    if (tick % kDeriveEvery == 0 || run_.frame().modes != seen_in_) DeriveOutputs();
    seen_in_ = run_.frame().modes;
    Eigen::MatrixXd gain = Eigen::MatrixXd::Zero(n_, m_);
    Eigen::VectorXd change = Eigen::VectorXd::Zero(n_);
    // One output after the other: their noises are independent.
    for (Eigen::Index j = 0; j < m_; ++j) {
      const double measured = observer_.measured[static_cast<std::size_t>(j)][tick];
      if (!std::isfinite(measured)) continue;
      const Eigen::RowVectorXd c = outputs_.row(j);
      const Eigen::VectorXd cross = covariance_ * c.transpose();
      const Eigen::VectorXd k = cross / (c.dot(cross) + noise[j]);
      covariance_.noalias() -= k * cross.transpose();
      // The gain of the outputs before acts on this one's innovation too.
      gain -= k * (c * gain);
      gain.col(j) += k;
    }
    for (Eigen::Index j = 0; j < m_; ++j) {
      const double measured = observer_.measured[static_cast<std::size_t>(j)][tick];
      if (std::isfinite(measured))
        change += gain.col(j) * (measured - run_.OutputSample(columns_[static_cast<std::size_t>(j)]));
    }
    for (Eigen::Index i = 0; i < n_; ++i) {
      for (Eigen::Index j = 0; j < m_; ++j) observer_.gains.push_back(static_cast<float>(gain(i, j)));
    }
    Shifted(run_.frame(), change, run_);
  }

  void Shifted(const Frame& from, const Eigen::VectorXd& change, Simulation& into) {
    Frame frame = from;
    solver_.Shift(frame, {change.data(), change.data() + n_});
    into.Restore(frame);
  }

  /// d outputs / d states now.
  void DeriveOutputs() {
    outputs_.resize(m_, n_);
    for (Eigen::Index i = 0; i < n_; ++i) {
      Frame frame = run_.frame();
      const double step = kStep * scale_[i];
      std::vector<double> change(static_cast<std::size_t>(n_), 0.0);
      change[static_cast<std::size_t>(i)] = step;
      solver_.Shift(frame, change);
      solver_.Evaluate(frame, rig_.SecondsOf(frame.time));
      for (Eigen::Index j = 0; j < m_; ++j) {
        const OutputLine& line = rig_.outputs[columns_[static_cast<std::size_t>(j)]];
        outputs_(j, i) = (frame.signals[static_cast<std::size_t>(line.signal)] -
                          run_.frame().signals[static_cast<std::size_t>(line.signal)]) /
                         step;
      }
    }
  }

  /// d states / d states and d states / d inputs over the period that begins with `frame`.
  Status Derive(const Frame& frame) {
    const std::vector<double> base = solver_.States(run_.frame());
    const auto column = [&](double step) -> Result<Eigen::VectorXd> {
      if (Status failed = other_.Integrate()) return *failed;
      const std::vector<double> states = solver_.States(other_.frame());
      Eigen::VectorXd slope(n_);
      for (Eigen::Index i = 0; i < n_; ++i) {
        const auto k = static_cast<std::size_t>(i);
        slope[i] = (states[k] - base[k]) / step;
      }
      return slope;
    };
    transition_.resize(n_, n_);
    for (Eigen::Index i = 0; i < n_; ++i) {
      Shifted(frame, kStep * scale_[i] * Eigen::VectorXd::Unit(n_, i), other_);
      const Result<Eigen::VectorXd> slope = column(kStep * scale_[i]);
      if (!slope.ok()) return slope.failure();
      transition_.col(i) = *slope;
    }
    effect_.resize(n_, static_cast<Eigen::Index>(rig_.inputs.size()));
    for (std::size_t i = 0; i < rig_.inputs.size(); ++i) {
      const double step = kStep * rig_.inputs[i].nominal;
      Frame moved = frame;
      moved.signals[static_cast<std::size_t>(rig_.inputs[i].delayed)] += step;
      other_.Restore(moved);
      const Result<Eigen::VectorXd> slope = column(step);
      if (!slope.ok()) return slope.failure();
      effect_.col(static_cast<Eigen::Index>(i)) = *slope;
    }
    return {};
  }

  const Rig& rig_;
  Solver& solver_;
  Observer& observer_;
  Simulation run_, other_;
  Eigen::Index n_, m_;
  std::vector<std::size_t> columns_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd covariance_, transition_, outputs_, effect_;
  std::vector<int> derived_for_ = {kNever}, seen_in_;
};

}  // namespace

std::optional<double> PredictionWindow(const Plan& plan) {
  const Value* window = plan.root.Find("prediction_window_s");
  if (window == nullptr || !window->is_number() || !(window->number() > 0.0)) return std::nullopt;
  return window->number();
}

Result<Observer> MakeObserver(const Rig& rig, const MappedRecord& record, double window_s) {
  const FlushSubnormals flush;
  const double period_s = rig.SecondsOf(rig.period);
  Observer observer;
  observer.window = std::max<std::int64_t>(1, std::llround(window_s / period_s));
  if (rig.steps < 2 * observer.window) {
    return Failure{
        "the record is shorter than two windows of prediction_window_s: no window has a past", record.file, {}, 2};
  }
  for (const Port& port : rig.state_ports) observer.states.push_back(port.name);
  std::vector<double> noise, disturbance;
  for (const auto& [name, series] : record.outputs) {
    observer.outputs.push_back(name);
    observer.measured.push_back(ByTick(series, period_s, rig.steps));
    const double floor = kLeastNoise * std::max(score::StandardDeviation(*series.values), 1e-9);
    noise.push_back(std::pow(std::max(score::WhiteNoise(*series.values), floor), 2));
  }
  if (observer.outputs.empty()) return Failure{"no output of the scenario is in the record", record.file, {}, 2};
  for (const InputLine& line : rig.inputs) {
    const auto driven = record.inputs.find(line.name);
    const double rms = driven != record.inputs.end() ? score::RootMeanSquare(*driven->second.values) : line.nominal;
    disturbance.push_back(kInputShare * rms * std::sqrt(static_cast<double>(observer.window)));
  }
  const Result<std::unique_ptr<Solver>> solver = MakeSolver("realtime", rig);
  if (!solver.ok()) return solver.failure();
  const auto vector = [](const std::vector<double>& v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
  };
  if (Status failed = Filter(rig, **solver, observer).Run(vector(noise), vector(disturbance))) return *failed;
  return observer;
}

Result<Samples> PredictInWindows(const Rig& rig, Solver& solver, const Observer& observer) {
  const FlushSubnormals flush;
  const auto rows = static_cast<std::size_t>(rig.steps) + 1;
  Samples samples;
  samples.time.resize(rows);
  samples.inputs.assign(rig.inputs.size(), std::vector<double>(rows));
  samples.outputs.assign(rig.outputs.size(), std::vector<double>(rows));
  const std::size_t n = observer.states.size(), m = observer.outputs.size();
  std::vector<std::optional<std::size_t>> rows_of;  // of a gain, by state
  for (const Port& port : rig.state_ports) rows_of.push_back(CorrectedAs(observer.states, port.name));
  std::vector<int> columns;
  for (const std::string& name : observer.outputs) columns.push_back(FindOutput(rig, name));
  Simulation beside(rig, solver), ahead(rig, solver);
  if (Status failed = beside.Start()) return *failed;
  ahead.Restore(beside.frame());
  std::vector<double> change(rig.state_ports.size()), missed(m);
  for (std::size_t k = 0; k < rows; ++k) {
    if (static_cast<std::int64_t>(k) % observer.window == 0) ahead.Restore(beside.frame());
    if (Status failed = ahead.Tick()) return *failed;
    samples.time[k] = rig.SecondsOf(ahead.frame().time);
    for (std::size_t i = 0; i < samples.inputs.size(); ++i) samples.inputs[i][k] = ahead.InputCommand(i);
    for (std::size_t i = 0; i < samples.outputs.size(); ++i) samples.outputs[i][k] = ahead.OutputSample(i);
    if (k + 1 == rows) break;
    if (Status failed = ahead.Integrate()) return *failed;
    if (Status failed = beside.Tick()) return *failed;
    for (std::size_t j = 0; j < m; ++j) {
      const double measured = k < observer.measured[j].size() ? observer.measured[j][k] : std::nan("");
      const bool known = columns[j] >= 0 && std::isfinite(measured);
      missed[j] = known ? measured - beside.OutputSample(static_cast<std::size_t>(columns[j])) : 0.0;
    }
    std::fill(change.begin(), change.end(), 0.0);
    const float* gain = observer.gains.data() + std::min(k, observer.gains.size() / (n * m) - 1) * n * m;
    for (std::size_t i = 0; i < change.size(); ++i) {
      for (std::size_t j = 0; j < m && rows_of[i]; ++j)
        change[i] += static_cast<double>(gain[*rows_of[i] * m + j]) * missed[j];
    }
    if (std::any_of(change.begin(), change.end(), [](double value) { return value != 0.0; })) {
      Frame frame = beside.frame();
      solver.Shift(frame, change);
      beside.Restore(frame);
    }
    if (Status failed = beside.Integrate()) return *failed;
  }
  samples.counters = solver.counters();
  samples.solver_summary = solver.Summary();
  return samples;
}

Series From(const Series& series, double from_s) {
  const auto first = std::lower_bound(series.time->begin(), series.time->end(), from_s) - series.time->begin();
  return {std::make_shared<const std::vector<double>>(series.time->begin() + first, series.time->end()),
          std::make_shared<const std::vector<double>>(series.values->begin() + first, series.values->end())};
}

}  // namespace dynoproof
