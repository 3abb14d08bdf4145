#include "estimation/predictor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "base/subnormals.h"
#include "estimation/sensor_chain.h"
#include "experiment/drive_by_record.h"
#include "score/series.h"
#include "sim/simulate.h"

namespace dynoproof::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kOnTick = 1e-3;  // of a period: a stamp so near a tick is there
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Where in a course by tick an instant is: the tick at or before it, and the share of the period behind that.
struct Instant {
  std::size_t tick;
  double share;

  Instant(double time_s, double period_s, std::size_t ticks) {
    const double at = std::clamp(time_s / period_s, 0.0, static_cast<double>(ticks - 1));
    const auto nearest = static_cast<std::size_t>(at + 0.5);
    const bool there = std::abs(at - static_cast<double>(nearest)) < kOnTick;
    tick = there ? nearest : static_cast<std::size_t>(at);
    share = there ? 0.0 : at - static_cast<double>(tick);
  }
};

/// A signal by tick: as each period ends there, after the correction as the next one begins, and as its sensor has seen it last.
struct Course {
  std::vector<double> ends, begins, seen;

  explicit Course(std::int64_t steps)
      : ends(static_cast<std::size_t>(steps) + 1), begins(ends.size()), seen(ends.size()) {}

  /// What a period changes.
  double Change(std::size_t tick) const { return ends[tick + 1] - begins[tick]; }

  /// Between ticks the cubic by what this period changes and its neighbours (Bessel's formula), which have no step in them;
  /// at the ends the straight line. The straight line lowers a sine of six ticks a
  /// period by 16 %, the cubic by 3 %.
  double At(const Instant& at) const {
    const auto& [k, x] = at;
    if (!(x > 0.0)) return ends[k];
    double value = begins[k] + x * Change(k);
    if (k == 0 || k + 2 >= ends.size()) return value;
    const double before = Change(k - 1), after = Change(k + 1);
    value += 0.25 * x * (x - 1.0) * (after - before);
    return value + (x - 0.5) * x * (x - 1.0) / 6.0 * (after - 2.0 * Change(k) + before);
  }
};

/// A record's value at an instant near its sample i: the cubic through the four samples around it; the straight line beside a
/// gap; beyond the ends the sample itself.
double ValueNear(const Series& measured, std::size_t i, double time_s) {
  constexpr double kEven = 1.5;  // steps between which there is no gap
  const std::vector<double>&time = *measured.time, &values = *measured.values;
  if (time_s == time[i]) return values[i];
  const std::size_t k = time_s < time[i] ? i - 1 : i;  // of the step that holds the instant
  if ((k == i - 1 && i == 0) || k + 1 >= time.size()) return values[i];
  const double step = time[k + 1] - time[k], x = (time_s - time[k]) / step;
  const auto even = [&](std::size_t from) { return time[from + 1] - time[from] < kEven * step; };
  if (k == 0 || k + 2 >= time.size() || !even(k - 1) || !even(k + 1))
    return values[k] + x * (values[k + 1] - values[k]);
  double value = 0.0;
  for (std::size_t a = k - 1; a <= k + 2; ++a) {
    double share = values[a];
    for (std::size_t b = k - 1; b <= k + 2; ++b) share *= b == a ? 1.0 : (time_s - time[b]) / (time[a] - time[b]);
    value += share;
  }
  return value;
}

/// Error of a sensor where its chain begins, in the unit of the nominal sensor.
class SensorError {
 public:
  /// A sample tells of an instant that the sensor's delay ago was: it counts at the first tick from then on. One between ticks
  /// is taken as what the record is at the nearest tick: a run is not known between ticks, where it has modes as fast as that.
  SensorError(const Rig& rig, std::size_t output, double nominal_slope, const Series* measured, double period_s)
      : rig_(rig),
        line_(rig.outputs[output]),
        chain_(rig, output),
        inverse_(chain_.lag_s()),
        slope_(nominal_slope),
        period_s_(period_s) {
    for (std::size_t i = 0; i < rig.intervals.size() && line_.sample_fraction > 0.0; ++i) {
      if (std::ranges::count(rig.intervals[i].samples, static_cast<int>(output)) > 0) taken_ = static_cast<int>(i);
    }
    if (measured == nullptr) return;
    measured_.assign(static_cast<std::size_t>(rig.steps) + 1, kNone);
    for (std::size_t i = 0; i < measured->time->size(); ++i) {
      const double tick = (*measured->time)[i] / period_s;
      if (!(tick > -0.5)) continue;
      const auto nearest = static_cast<std::int64_t>(tick + 0.5), counts = nearest - late();
      if (counts < 0 || counts > rig.steps) continue;
      const auto there = static_cast<double>(nearest);
      measured_[static_cast<std::size_t>(counts)] =
          std::abs(tick - there) < kOnTick ? (*measured->values)[i] : ValueNear(*measured, i, there * period_s);
    }
  }

  const SensorChain& chain() const { return chain_; }
  /// The interval of a period at whose beginning the sensor looks; -1: at the ticks.
  int taken() const { return taken_; }
  /// Ticks from where a sample counts to where it shows.
  int late() const { return line_.delay_periods - (taken_ >= 0 ? 1 : 0); }
  /// The signal at the sensor's last look, in a frame at a tick.
  double SeenIn(const Frame& frame) const {
    if (taken_ < 0 || frame.step == 0) return frame.signals[static_cast<std::size_t>(chain_.end())];
    return frame.rings[static_cast<std::size_t>(line_.ring + (frame.step - 1) % line_.delay_periods)];
  }
  /// At each tick, in order, where the run stands; 0 where there is no sample, or the sensor does not react.
  double At(const Frame& frame, std::size_t tick) {
    constexpr double kDead = 1e-3;  // of the nominal slope
    if (measured_.empty() || !std::isfinite(measured_[tick])) return 0.0;
    const double error = inverse_(measured_[tick] - SeenIn(frame), static_cast<double>(tick - last_) * period_s_);
    last_ = tick;
    const double slope = chain_.SlopeAt(frame, rig_.SecondsOf(frame.time));
    return std::abs(slope) > kDead * slope_ ? error * slope_ / slope : 0.0;
  }

 private:
  const Rig& rig_;
  const OutputLine& line_;
  SensorChain chain_;
  LagInverse inverse_;
  double slope_, period_s_;
  int taken_ = -1;
  std::vector<double> measured_;  // by tick
  std::size_t last_ = 0;
};

/// A column of an observer for each output, by what the run's modes are.
class Corrections {
 public:
  Corrections(const Observer& observer, const BuiltRun& run, std::vector<int> taken)
      : observer_(observer), run_(run), taken_(std::move(taken)) {}

  Correction& For(const std::vector<int>& modes) {
    if (last_ != nullptr && run_.rig->modes == 0) return *last_;
    std::unique_ptr<Correction>& own = by_modes_[modes];
    if (own == nullptr) own = run_.solver->MakeCorrection(observer_.GainsFor(*run_.rig, modes), taken_);
    last_ = own.get();
    return *last_;
  }

 private:
  Correction* last_ = nullptr;
  const Observer& observer_;
  const BuiltRun& run_;
  std::vector<int> taken_;
  std::map<std::vector<int>, std::unique_ptr<Correction>> by_modes_;
};

/// By record, whether any row lies between ticks.
std::vector<bool> BetweenTicks(const DataSet& data, double period_s) {
  std::vector<bool> between(data.records().size(), false);
  for (const Channel& channel : data.channels()) {
    const auto ticks = static_cast<std::size_t>(std::ceil(data.records()[channel.record].end_s / period_s)) + 2;
    for (Index i = channel.begin; i < channel.begin + channel.count && !between[channel.record]; ++i)
      between[channel.record] = Instant(data.time_s()[static_cast<std::size_t>(i)], period_s, ticks).share > 0.0;
  }
  return between;
}

/// The finest step of a record's outputs [s].
double StepOf(const MappedRecord& record) {
  double step_s = std::numeric_limits<double>::infinity();
  for (const auto& [name, series] : record.outputs) step_s = std::min(step_s, score::MedianStep(*series.time));
  return step_s;
}

}  // namespace

Predictor::Predictor(const DataSet& data, const LinearModel& model, const Registry& registry,
                     std::optional<double> memory_s, std::shared_ptr<mechanics::Decompositions> decompositions)
    : data_(&data),
      model_(&model),
      registry_(&registry),
      decompositions_(std::move(decompositions)),
      between_(BetweenTicks(data, model.period_s)) {
  observer_ = ObserverOf(memory_s);
}

Predictor::Predictor(const Predictor& lead, double until_s, std::optional<double> memory_s)
    : data_(lead.data_),
      model_(lead.model_),
      registry_(lead.registry_),
      leads_(lead.leads_),
      decompositions_(lead.decompositions_),
      between_(lead.between_) {
  leads_.push_back({lead.observer_, until_s});
  observer_ = ObserverOf(memory_s);
}

std::optional<Observer> Predictor::ObserverOf(std::optional<double> memory_s) const {
  if (!memory_s || !model_->HasStates()) return std::nullopt;
  VectorXd noise(std::ssize(model_->outputs));
  for (Index j = 0; j < noise.size(); ++j)
    noise[j] =
        std::ranges::find(data_->channels(), model_->outputs[static_cast<std::size_t>(j)], &Channel::name)->noise;
  return Observer(*model_, noise, StepOf(data_->records().front()), *memory_s);
}

Status Predictor::RunBeside(const BuiltRun& run, const MappedRecord& record, std::size_t r,
                            VectorXd& innovations) const {
  const FlushSubnormals flush;
  const Rig& rig = *run.rig;
  const double period_s = rig.SecondsOf(rig.period);
  const std::size_t count = model_->outputs.size();
  std::vector<std::size_t> lines;
  std::vector<SensorError> sensors;
  std::vector<Course> courses;
  std::vector<int> taken;
  for (std::size_t j = 0; j < count; ++j) {
    const std::string& name = model_->outputs[j];
    const auto line = std::ranges::find(rig.outputs, name, &OutputLine::name);
    const auto series = record.outputs.find(name);
    if (line == rig.outputs.end()) return Failure{"the plan lost this output", name};
    lines.push_back(static_cast<std::size_t>(line - rig.outputs.begin()));
    sensors.emplace_back(rig, lines.back(), model_->slopes[static_cast<Index>(j)],
                         series != record.outputs.end() ? &series->second : nullptr, period_s);
    taken.push_back(sensors.back().taken());
    courses.emplace_back(rig.steps);
  }
  Simulation simulation(rig, *run.solver);
  if (Status failed = simulation.Start()) return failed;
  auto lead = leads_.begin();
  std::unique_ptr<Corrections> corrections;
  const auto correct_by = [&](const std::optional<Observer>& observer) {
    corrections = observer ? std::make_unique<Corrections>(*observer, run, taken) : nullptr;
  };
  correct_by(lead != leads_.end() ? lead->observer : observer_);
  // Rows are told one after the other: a list of them would be larger than the courses.
  const auto for_each_row = [&](const auto& tell) {
    for (const Channel& channel : data_->channels()) {
      if (channel.record != r) continue;
      const auto j =
          static_cast<std::size_t>(std::ranges::find(model_->outputs, channel.name) - model_->outputs.begin());
      for (Index i = channel.begin; i < channel.begin + channel.count; ++i)
        tell(i, j, data_->time_s()[static_cast<std::size_t>(i)]);
    }
  };
  const bool between = between_[r] || period_s != model_->period_s;
  std::vector<double> errors(count);
  for (std::int64_t step = 0; step <= rig.steps; ++step) {
    const auto k = static_cast<std::size_t>(step);
    if (Status failed = simulation.Tick()) return failed;
    const auto now = [&](std::size_t j) {
      return free_run() ? simulation.OutputSample(lines[j])
                        : simulation.frame().signals[static_cast<std::size_t>(sensors[j].chain().end())];
    };
    for (std::size_t j = 0; j < count; ++j) {
      courses[j].ends[k] = courses[j].begins[k] = now(j);
      courses[j].seen[k] = free_run() ? courses[j].ends[k] : sensors[j].SeenIn(simulation.frame());
    }
    if (step == rig.steps) break;
    for (; lead != leads_.end() && !(static_cast<double>(step) * period_s < lead->until_s); ++lead)
      correct_by(std::next(lead) != leads_.end() ? std::next(lead)->observer : observer_);
    if (corrections) {
      for (std::size_t j = 0; j < count; ++j) errors[j] = sensors[j].At(simulation.frame(), k);
      simulation.Correct(corrections->For(simulation.frame().modes), errors);
      if (between) {
        simulation.Evaluate();
        for (std::size_t j = 0; j < count; ++j) courses[j].begins[k] = now(j);
      }
    }
    if (Status failed = simulation.Integrate()) return failed;
  }
  for_each_row([&](Index i, std::size_t j, double time_s) {
    const Course& course = courses[j];
    Instant at(time_s, period_s, course.ends.size());
    const bool on_tick = !(at.share > 0.0);  // then what the sensor had seen last is compared
    // A delayed sample would have been corrected by what it is compared with: the delay is counted when they are compared.
    if (!free_run() && on_tick)
      at.tick -= std::min(at.tick, static_cast<std::size_t>(sensors[j].late()));
    else if (!free_run())
      at = Instant(time_s - sensors[j].chain().delay_s(), period_s, course.ends.size());
    innovations[i] = data_->measured()[i] - (on_tick ? course.seen[at.tick] : course.At(at));
  });
  return {};
}

Result<BuiltRun> Predictor::Build(const Plan& plan, std::size_t record) const {
  return BuildRun(StartingInto(plan, record), data_->records()[record], *registry_, decompositions_.get());
}

Result<VectorXd> Predictor::Innovations(const Plan& plan) const {
  Result<Prediction> prediction = Predict(plan, false);
  if (!prediction.ok()) return prediction.failure();
  return std::move(prediction->innovations);
}

Result<Prediction> Predictor::Predict(const Plan& plan) const { return Predict(plan, true); }

Result<Prediction> Predictor::Predict(const Plan& plan, bool with_noise) const {
  Prediction prediction{VectorXd(data_->measured().size()), {}, false};
  for (std::size_t r = 0; r < data_->records().size(); ++r) {
    const Result<BuiltRun> run = Build(plan, r);
    if (!run.ok()) return run.failure();
    ++simulations_;
    if (with_noise && r == 0) prediction.noise_alone = NoiseAlone(plan, *run);
    prediction.rough = prediction.rough || run->rig->guards > 0;
    if (Status failed = RunBeside(*run, data_->records()[r], r, prediction.innovations)) return *failed;
  }
  if (!prediction.innovations.allFinite()) return Failure{"a prediction is not finite", plan.id};
  return prediction;
}

VectorXd Predictor::NoiseOfNominal() const {
  if (learned_.size() > 0) return learned_;
  return NoiseBy(*model_);
}

VectorXd Predictor::NoiseBy(const LinearModel& model) const {
  VectorXd white(std::ssize(model_->outputs)), alone(std::ssize(data_->channels()));
  for (Index j = 0; j < white.size(); ++j)
    white[j] =
        std::ranges::find(data_->channels(), model_->outputs[static_cast<std::size_t>(j)], &Channel::name)->white;
  const VectorXd by_output = observer_->NoiseAlone(model, white);
  for (Index c = 0; c < alone.size(); ++c) {
    const Channel& channel = data_->channels()[static_cast<std::size_t>(c)];
    alone[c] =
        std::max(channel.noise, by_output[std::ranges::find(model_->outputs, channel.name) - model_->outputs.begin()]);
  }
  return alone;
}

VectorXd Predictor::NoiseAlone(const Plan& plan, const BuiltRun& whole) const {
  if (free_run()) {
    VectorXd alone(std::ssize(data_->channels()));
    for (Index c = 0; c < alone.size(); ++c) alone[c] = data_->channels()[static_cast<std::size_t>(c)].noise;
    return alone;
  }
  const Result<BuiltRun> bare = HasSensors(plan) ? Build(WithoutSensors(plan), 0) : Failure{};
  const Result<LinearModel> own = model_->Reduced(whole, bare.ok() ? *bare : whole);
  return own.ok() ? NoiseBy(*own) : NoiseOfNominal();
}

Result<VectorXd> Predictor::CorrectedByOthers(const Plan& plan,
                                              const std::function<void(MappedRecord&, std::size_t)>& change) const {
  VectorXd innovations = VectorXd::Zero(data_->measured().size());
  for (std::size_t r = 0; r < data_->records().size(); ++r) {
    const Result<BuiltRun> run = Build(plan, r);
    if (!run.ok()) return run.failure();
    MappedRecord record = data_->records()[r];
    change(record, r);
    ++simulations_;
    if (Status failed = RunBeside(*run, record, r, innovations)) return *failed;
  }
  if (!innovations.allFinite()) return Failure{"a prediction is not finite", plan.id};
  return innovations;
}

void Predictor::LearnNoise(const Plan& nominal) {
  constexpr std::uint64_t kSeed = 1;
  if (free_run() || !leads_.empty()) return;
  const Result<BuiltRun> built = Build(nominal, 0);
  if (!built.ok() || model_->Reduced(*built, *built).ok()) return;  // broken, or linear
  const auto louder = [&](MappedRecord& record, std::size_t r) {
    std::uint64_t stream = r * model_->outputs.size();
    for (auto& [name, series] : record.outputs) {
      const auto channel = std::ranges::find(data_->channels(), name, &Channel::name);
      std::vector<double> values = *series.values;
      for (std::size_t i = 0; channel != data_->channels().end() && i < values.size(); ++i)
        values[i] += channel->white * RandomNormal(kSeed, stream, i);
      series.values = std::make_shared<const std::vector<double>>(std::move(values));
      ++stream;
    }
  };
  const Result<VectorXd> as_is = Innovations(nominal), with_noise = CorrectedByOthers(nominal, louder);
  if (!as_is.ok() || !with_noise.ok()) return;
  VectorXd learned(std::ssize(data_->channels()));
  for (Index c = 0; c < learned.size(); ++c) {
    const Channel& channel = data_->channels()[static_cast<std::size_t>(c)];
    const auto moved = (*with_noise - *as_is).segment(channel.begin, channel.count);
    learned[c] = std::hypot(channel.noise,
                            std::sqrt(moved.squaredNorm() / static_cast<double>(std::max<Index>(1, channel.count))));
  }
  learned_ = learned;
}

}  // namespace dynoproof::estimation
