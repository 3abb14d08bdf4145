#include "diagnosis/trial.h"

#include <algorithm>
#include <cmath>

#include "model/effect_size.h"
#include "model/motion.h"
#include "score/series.h"

namespace dynoproof::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using estimation::DataSet;
using estimation::Hypothesis;

}  // namespace

Magnitudes MagnitudesOf(const EstimationProblem& problem) {
  Magnitudes m;
  const MappedRecord& record = problem.records().front();
  m.duration_s = std::max(record.end_s, 1e-3);
  m.step_s = problem.channels().front().step_s;
  for (const auto& [name, series] : record.inputs) {
    m.input_rms[name] = score::RootMeanSquare(*series.values);
    m.input_peak[name] = score::Largest(*series.values);
    m.input = std::max(m.input, m.input_rms[name]);
  }
  double torque = 0.0, speed = 0.0;
  for (const ComparedOutput& channel : problem.channels()) {
    if (channel.record != 0) continue;
    m.output_spread[channel.name] = channel.spread;
    const double rms = score::RootMeanSquare(*record.outputs.at(channel.name).values);
    if (IsForce(channel.unit)) torque = std::max(torque, rms);
    if (IsSpeed(channel.unit)) speed = std::max(speed, rms);
  }
  m.torque = torque > 0.0 ? torque : m.input > 0.0 ? m.input : 1.0;
  m.speed = speed > 0.0 ? speed : 1.0;
  return m;
}

std::vector<Trial> TrialsOf(const estimation::Hypothesis& base, const Levels& levels, const Magnitudes& magnitudes,
                            const Registry& registry) {
  std::vector<Trial> candidates;
  const DataSet& data = levels.data();
  const Plan with_effects = base.At(base.start());
  for (const Effect* effect : registry.Effects()) {
    // An effect of the base may have taken a place away: lumps that it stands for as one rotor.
    const std::vector<Place> there = effect->Places(with_effects);
    for (const Place& place : effect->Places(base.nominal())) {
      if (std::ranges::find(there, place) == there.end()) continue;
      if (!CanBeSeen(place, data.channels(), data.records().front())) continue;
      if (std::ranges::find(base.effects(), Hypothesis::Applied{effect, place}) != base.effects().end()) continue;
      Trial candidate{effect, place, base.With(*effect, place, magnitudes), {}, SizedWith(effect->info())};
      const std::size_t first = base.of_effects(), count = effect->info().parameters.size();
      const auto& parameters = candidate.hypothesis.parameters();
      for (const std::vector<double>& start : effect->Starts(base.nominal(), place, magnitudes)) {
        VectorXd q(static_cast<Index>(count));
        for (std::size_t i = 0; i < count; ++i) {
          const estimation::Parameter& own = parameters[first + i];
          q[static_cast<Index>(i)] = own.CoordinateOf(std::clamp(start[i], own.lower, own.upper));
        }
        candidate.starts.push_back(std::move(q));
      }
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

Index NumberChanged(const Trial& trial, const Hypothesis& null) {
  const auto& known = null.parameters();
  const auto changed =
      std::ranges::find(known, trial.effect->ScaledIn(null.nominal(), trial.place), &estimation::Parameter::name);
  return changed != known.end() ? changed - known.begin() : -1;
}

}  // namespace dynoproof::diagnosis
