#include "diagnosis/candidates.h"

#include <algorithm>
#include <cmath>

#include "score/series.h"

namespace dynoproof::diagnosis {
namespace {

std::string FamilyOf(const Effect& effect) {
  return effect.info().traits.family.empty() ? effect.info().name : effect.info().traits.family;
}

}  // namespace

std::vector<std::size_t> StrengthsOf(const Effect& effect) {
  std::vector<std::size_t> strengths;
  const std::vector<EffectParameter>& parameters = effect.info().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (std::isfinite(parameters[i].neutral) && parameters[i].neutral < parameters[i].upper) strengths.push_back(i);
  }
  return strengths;
}

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
  for (const Channel& channel : problem.channels()) {
    if (channel.record != 0) continue;
    m.output_spread[channel.name] = channel.spread;
    const double rms = score::RootMeanSquare(*record.outputs.at(channel.name).values);
    if (channel.unit == "N m" || channel.unit == "N") torque = std::max(torque, rms);
    if (channel.unit == "rad/s") speed = std::max(speed, rms);
  }
  m.torque = torque > 0.0 ? torque : m.input > 0.0 ? m.input : 1.0;
  m.speed = speed > 0.0 ? speed : 1.0;
  return m;
}

std::vector<Candidate> CandidatesFor(const EstimationProblem& problem, const Magnitudes& magnitudes) {
  std::vector<Candidate> candidates;
  const bool given = problem.registry().PlantOf(problem.plan()).prescribed_motion;
  for (const Effect* effect : problem.registry().Effects()) {
    const EffectTraits& traits = effect->info().traits;
    const Effect* plainer = problem.registry().FindEffect(traits.refines);
    const std::vector<Place> places = effect->Places(problem.plan());
    for (const Place& place : places) {
      if (!CanBeSeen(place, problem.channels(), problem.records().front())) continue;
      Candidate candidate{effect, place, effect->Starts(problem.plan(), place, magnitudes), StrengthsOf(*effect),
                          false};
      candidate.family = FamilyOf(plainer != nullptr ? *plainer : *effect);
      // Any order of a harmonic is tried at both ends of the line, of which one may be heavy; the rest follow them.
      // Where the motion is given a run costs next to nothing, and elastic friction need not look like a dry one.
      const bool between = place != places.front() && place != places.back();
      candidate.refinement = (plainer != nullptr && !given) || (traits.harmonic && between);
      for (std::vector<double>& start : candidate.starts) {
        for (std::size_t i = 0; i < start.size(); ++i)
          start[i] = std::clamp(start[i], effect->info().parameters[i].lower, effect->info().parameters[i].upper);
      }
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

const Effect* PlainFriction(const Registry& registry) {
  for (const Effect* effect : registry.Effects()) {
    if (!effect->info().traits.dry_friction) continue;
    const Effect* plain = registry.FindEffect(effect->info().traits.refines);
    if (plain != nullptr && plain->info().traits.refines.empty()) return plain;
  }
  return nullptr;
}

}  // namespace dynoproof::diagnosis
