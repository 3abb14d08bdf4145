#include "diagnosis/screening.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "base/parallel.h"
#include "identification/noise_model.h"
#include "linear/dense.h"
#include "score/align.h"
#include "score/nrmse.h"

namespace dynoproof::diagnosis {
namespace {

/// Whether the starts of an effect, beyond the first, are tried as they stand: a resonance that moved, or a signal
/// that comes late, looks like no multiple of one that did so a little.
bool AsItStands(const Candidate& candidate) {
  const EffectTraits& traits = candidate.effect->info().traits;
  return !candidate.effect->ScaledParameter(candidate.place).empty() || traits.delay || traits.lag;
}

/// What the screening of one candidate needs: the base's whitened error, freed of what the nuisance parameters explain.
class Look {
 public:
  Look(const EstimationProblem& problem, const Estimator& estimator, const Estimate& base)
      : problem_(problem),
        estimator_(estimator),
        base_(base),
        plan_(problem.PlanOf({base.nuisances.z0, base.hypothesis.effects})),
        projection_(base.nuisances, estimator.whitener()) {
    const Result<Eigen::VectorXd> at = problem.Predict({base.nuisances.z0, base.hypothesis.effects});
    if (at.ok()) predicted_ = *at;
    error_ = estimator.whitener()(problem.measured() - predicted_);
    freed_error_ = FreeError(projection_);
    for (const Channel& c : problem.channels())
      floors_.push_back(std::max(HighFrequencyFloor(problem.measured().segment(c.begin, c.count)), 1e-9 * c.nominal));
    power_ = PowerOf(base.predicted);
  }

  Screened At(const Candidate& candidate, double threshold) const {
    Screened best;
    best.chi2 = best.criterion = std::numeric_limits<double>::infinity();
    best.smallest = std::numeric_limits<double>::quiet_NaN();
    // What the base's effects have replaced is no place any more.
    const std::vector<Place> places = candidate.effect->Places(plan_);
    if (std::find(places.begin(), places.end(), candidate.place) == places.end()) return best;
    // The candidate's own nuisance parameter must not compete with it.
    const std::optional<NuisanceModel> fewer = Without(candidate);
    const std::optional<Projection> own =
        fewer ? std::optional<Projection>(Projection(*fewer, estimator_.whitener())) : std::nullopt;
    const NuisanceModel& nuisances = fewer ? *fewer : base_.nuisances;
    const Projection& projection = own ? *own : projection_;
    const auto take = [&](const Estimate& fit) {
      best.simulations += fit.simulations;
      if (!fit.ok()) return;
      const std::vector<double>& parameters = fit.hypothesis.effects.back().parameters;
      if (const double left = PowerOf(fit.predicted) / power_; left < best.left) {
        best.left = left;
        best.closest = parameters;
      }
      if (!(fit.criterion < best.criterion)) return;
      best.chi2 = fit.chi2;
      best.criterion = fit.criterion;
      best.parameters = parameters;
    };
    const auto evaluate = [&](const std::vector<double>& parameters) {
      std::vector<EffectInstance> effects = base_.hypothesis.effects;
      effects.push_back(candidate.At(parameters));
      return estimator_.Evaluate(effects, nuisances, projection);
    };
    std::vector<std::vector<double>> starts = candidate.starts;
    if (const double late_s = candidate.effect->info().traits.delay ? LateBy(candidate) : 0.0; late_s > 0.0)
      starts.push_back({late_s});
    for (const std::vector<double>& start : starts) {
      if (candidate.effect->info().traits.harmonic) {
        const std::optional<std::vector<double>> sized = SizeRipple(candidate, projection, start, threshold, best);
        if (sized) take(evaluate(*sized));
        continue;
      }
      if (candidate.strengths.empty()) {
        take(evaluate(start));
        continue;
      }
      if (&start != &starts.front() && AsItStands(candidate)) {
        take(evaluate(start));
        continue;
      }
      std::vector<double> from = start;
      const int rounds = candidate.strengths.size() == 1 ? 2 : 1;
      for (int round = 0; round < rounds; ++round) {
        double gain = 0.0;
        const std::optional<std::vector<double>> scaled = Scale(candidate, projection, from, threshold, best, gain);
        if (!scaled || gain < 0.3 * threshold) break;  // not worth a run at that size
        take(evaluate(*scaled));
        if (*scaled == from) break;
        from = *scaled;
        if (std::abs(from[candidate.strengths[0]] -
                     candidate.effect->info().parameters[candidate.strengths[0]].neutral) <
            1e-9 * std::abs(start[candidate.strengths[0]] -
                            candidate.effect->info().parameters[candidate.strengths[0]].neutral))
          break;
      }
    }
    if (candidate.strengths.empty() && !candidate.effect->info().parameters.empty() && !best.parameters.empty()) {
      std::vector<EffectInstance> effects = base_.hypothesis.effects;
      effects.push_back(candidate.At(best.parameters));
      take(estimator_.Optimise(effects, nuisances, 4));
    }
    return best;
  }

 private:
  /// The shift that brings what was predicted of the candidate's signals closest to what was measured, within its
  /// bounds [s]; 0: none does. Behind an actuator all signals come late; the one that shows it best counts.
  double LateBy(const Candidate& candidate) const {
    const EffectParameter& delay = candidate.effect->info().parameters[0];
    double late_s = 0.0, least = 1.0;
    for (const Channel& c : problem_.channels()) {
      if (candidate.place.kind == "output" && c.name != candidate.place.name) continue;
      const auto rows = static_cast<std::size_t>(c.count);
      const score::AlignmentFit fit = score::FitArrays(
          {predicted_.data() + c.begin, rows}, {problem_.measured().data() + c.begin, rows}, c.step_s, {.gain = false});
      if (!fit.ok() || !(fit.unexplained < least)) continue;
      least = fit.unexplained;
      late_s = std::clamp(fit.shift_s, delay.lower, delay.upper);
    }
    return late_s;
  }

  /// Of what a prediction leaves, in units of the noise's highest frequencies by channel.
  double PowerOf(const Eigen::VectorXd& predicted) const {
    const Eigen::VectorXd left = problem_.measured() - predicted;
    double power = 0.0;
    for (const Channel& c : problem_.channels()) {
      const double floor = floors_[static_cast<std::size_t>(&c - problem_.channels().data())];
      power += left.segment(c.begin, c.count).squaredNorm() / (floor * floor);
    }
    return power;
  }

  /// What the nuisance parameters leave of the base's error, and what they cost.
  Eigen::VectorXd FreeError(const Projection& projection) const {
    return projection.Residual(error_, projection.Shift(error_));
  }

  std::optional<NuisanceModel> Without(const Candidate& candidate) const {
    std::vector<EffectInstance> effects = base_.hypothesis.effects;
    effects.push_back(candidate.At(candidate.starts.front()));
    const std::vector<double> freedom = FreedomOf(problem_, effects);
    NuisanceModel nuisances = base_.nuisances;
    std::vector<int> columns;
    for (std::size_t k = 0; k < nuisances.free.size(); ++k) {
      const auto i = static_cast<std::size_t>(nuisances.free[k]);
      nuisances.freedom[i] = std::min(nuisances.freedom[i], freedom[i]);
      if (nuisances.freedom[i] > 0.0) columns.push_back(static_cast<int>(k));
    }
    if (columns.size() == nuisances.free.size()) return std::nullopt;
    NuisanceModel fewer = nuisances;
    fewer.free.clear();
    fewer.jacobian.resize(nuisances.jacobian.rows(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) {
      fewer.free.push_back(nuisances.free[static_cast<std::size_t>(columns[k])]);
      fewer.jacobian.col(static_cast<Eigen::Index>(k)) = nuisances.jacobian.col(columns[k]);
    }
    return fewer;
  }

  /// A ripple of that order: sine and cosine are two signatures, amplitude and phase follow.
  std::optional<std::vector<double>> SizeRipple(const Candidate& candidate, const Projection& projection,
                                                const std::vector<double>& start, double threshold,
                                                Screened& screened) const {
    const Eigen::VectorXd error = &projection == &projection_ ? freed_error_ : FreeError(projection);
    Eigen::MatrixXd signatures(error.size(), 2);
    for (int k = 0; k < 2; ++k) {
      std::vector<EffectInstance> effects = base_.hypothesis.effects;
      effects.push_back(candidate.At({start[0], start[1], k * 0.5 * std::numbers::pi}));
      ++screened.simulations;
      const Result<Eigen::VectorXd> predicted = problem_.Predict({base_.nuisances.z0, effects});
      if (!predicted.ok() || !predicted->allFinite()) return std::nullopt;
      signatures.col(k) = projection.Free(estimator_.whitener()(*predicted - predicted_));
    }
    const double norm = signatures.col(0).norm();
    if (norm > 0.0 && !(screened.smallest <= start[0] * std::sqrt(threshold) / norm))
      screened.smallest = start[0] * std::sqrt(threshold) / norm;
    Eigen::Matrix2d gram = signatures.transpose() * signatures;
    gram.diagonal().array() += 1e-12;
    const Eigen::Vector2d right = signatures.transpose() * error;
    const Eigen::Vector2d alpha = gram.ldlt().solve(right);
    if (alpha.dot(right) < 0.3 * threshold) return std::nullopt;
    const EffectParameter& amplitude = candidate.effect->info().parameters[0];
    return std::vector<double>{std::clamp(start[0] * alpha.norm(), amplitude.lower, amplitude.upper), start[1],
                               std::atan2(alpha[1], alpha[0])};
  }

  /// One signature a strength at its size in `from`; the sizes that fit best, within the bounds.
  /// `gain`: of chi2, if the signatures stay what they are.
  std::optional<std::vector<double>> Scale(const Candidate& candidate, const Projection& projection,
                                           const std::vector<double>& from, double threshold, Screened& screened,
                                           double& gain) const {
    const std::vector<EffectParameter>& parameters = candidate.effect->info().parameters;
    const std::vector<std::size_t>& strengths = candidate.strengths;
    const Eigen::VectorXd error = &projection == &projection_ ? freed_error_ : FreeError(projection);
    std::vector<double> neutral = from;
    for (const std::size_t i : strengths) neutral[i] = parameters[i].neutral;
    Eigen::MatrixXd signatures(error.size(), static_cast<Eigen::Index>(strengths.size()));
    for (std::size_t k = 0; k < strengths.size(); ++k) {
      std::vector<double> at = neutral;
      at[strengths[k]] = from[strengths[k]];
      std::vector<EffectInstance> effects = base_.hypothesis.effects;
      effects.push_back(candidate.At(at));
      ++screened.simulations;
      const Result<Eigen::VectorXd> predicted = problem_.Predict({base_.nuisances.z0, effects});
      if (!predicted.ok() || !predicted->allFinite()) return std::nullopt;
      const Eigen::VectorXd signature = projection.Free(estimator_.whitener()(*predicted - predicted_));
      signatures.col(static_cast<Eigen::Index>(k)) = signature;
      const double size = std::abs(from[strengths[k]] - neutral[strengths[k]]);
      const double norm = signature.norm();
      if (k == 0 && norm > 0.0) {
        double seen = size * std::sqrt(threshold) / norm;
        // Play shows at once or not at all: its signature does not grow with its size.
        if (candidate.effect->info().traits.play) seen = norm * norm > threshold ? size : screened.smallest;
        if (!(screened.smallest <= seen)) screened.smallest = seen;
      }
    }
    // Strengths that would leave their bounds on the wrong side of neutral fall out one by one.
    std::vector<double> scaled = neutral;
    std::set<std::size_t> in;
    for (std::size_t k = 0; k < strengths.size(); ++k) in.insert(k);
    while (!in.empty()) {
      Eigen::MatrixXd used(error.size(), static_cast<Eigen::Index>(in.size()));
      Eigen::Index column = 0;
      for (const std::size_t k : in) used.col(column++) = signatures.col(static_cast<Eigen::Index>(k));
      Eigen::MatrixXd gram = used.transpose() * used;
      gram.diagonal().array() *= 1.0 + 1e-9;
      gram.diagonal().array() += 1e-12;
      const Eigen::VectorXd alpha = dense::SolveLdlt(gram, used.transpose() * error);
      gain = 2.0 * alpha.dot(used.transpose() * error) - (used * alpha).squaredNorm();
      column = 0;
      std::optional<std::size_t> out;
      for (const std::size_t k : in) {
        const std::size_t i = strengths[k];
        const double value = neutral[i] + alpha[column++] * (from[i] - neutral[i]);
        if ((value < parameters[i].lower && neutral[i] <= parameters[i].lower) ||
            (value > parameters[i].upper && neutral[i] >= parameters[i].upper)) {
          out = k;
        }
        scaled[i] = std::clamp(value, parameters[i].lower, parameters[i].upper);
      }
      if (!out) break;
      scaled[strengths[*out]] = neutral[strengths[*out]];
      in.erase(*out);
    }
    return scaled;
  }

  const EstimationProblem& problem_;
  const Estimator& estimator_;
  const Estimate& base_;
  const Plan plan_;  // of the base
  Projection projection_;
  Eigen::VectorXd predicted_, error_, freed_error_;
  std::vector<double> floors_;  // of the measured signals' highest frequencies, by channel
  double power_ = 0.0;          // of what the base leaves
};

}  // namespace

std::vector<Screened> Screen(const EstimationProblem& problem, const Estimator& estimator, const Estimate& base,
                             const std::vector<Candidate>& candidates, double threshold,
                             const std::function<void(double)>& progress) {
  const Look look(problem, estimator, base);
  std::vector<Screened> all(candidates.size());
  std::vector<std::size_t> first, second;
  std::set<std::string> promising;
  for (std::size_t i = 0; i < candidates.size(); ++i) (candidates[i].refinement ? second : first).push_back(i);
  std::atomic<std::size_t> done = 0;
  std::vector<double> ripple;  // the best one at either end
  const auto run = [&](const std::vector<std::size_t>& which) {
    ParallelFor(which.size(), 0, [&](std::size_t k) {
      const std::size_t i = which[k];
      Candidate candidate = candidates[i];
      if (!ripple.empty() && candidate.effect->info().traits.harmonic) candidate.starts = {ripple};
      all[i] = look.At(candidate, threshold);
      all[i].candidate = i;
      ++done;
      if (k % 2 == 0) progress(static_cast<double>(done) / static_cast<double>(candidates.size()));
    });
  };
  run(first);
  const auto family_at = [](const Candidate& one) { return one.family + "@" + one.place.ToString(); };
  double rippled = base.chi2 - 0.3 * threshold;
  for (const std::size_t i : first) {
    if (base.chi2 - all[i].chi2 > threshold) promising.insert(family_at(candidates[i]));
    if (candidates[i].effect->info().traits.harmonic && all[i].chi2 < rippled) {
      ripple = all[i].parameters;
      rippled = all[i].chi2;
    }
  }
  std::erase_if(second, [&](std::size_t i) {
    if (candidates[i].effect->info().traits.harmonic) return ripple.empty();
    return !promising.contains(family_at(candidates[i]));
  });
  run(second);
  std::vector<Screened> screened;
  for (const std::vector<std::size_t>* which : {&first, &second}) {
    for (const std::size_t i : *which) screened.push_back(std::move(all[i]));
  }
  std::stable_sort(screened.begin(), screened.end(),
                   [](const Screened& a, const Screened& b) { return a.criterion < b.criterion; });
  return screened;
}

}  // namespace dynoproof::diagnosis
