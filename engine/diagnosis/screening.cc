#include "diagnosis/screening.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <set>

#include "diagnosis/parallel.h"

namespace dynoproof::diagnosis {
namespace {

/// What the screening of one candidate needs: the base's whitened error, freed of what the doubts explain.
class Look {
 public:
  Look(const Study& study, const Fitter& fitter, const Fit& base) : study_(study), fitter_(fitter), base_(base) {
    const auto m = static_cast<Eigen::Index>(base.doubts.free.size());
    white_.resize(study.measured().size(), m);
    for (Eigen::Index k = 0; k < m; ++k) white_.col(k) = fitter.whitener()(base.doubts.jacobian.col(k));
    Eigen::MatrixXd information = white_.transpose() * white_;
    for (Eigen::Index k = 0; k < m; ++k) {
      const double freedom = base.doubts.freedom[static_cast<std::size_t>(base.doubts.free[static_cast<std::size_t>(k)])];
      information(k, k) += 1.0 / (freedom * freedom);
    }
    if (m > 0) factor_.compute(information);
    const Result<Eigen::VectorXd> at = study.Predict({base.doubts.z0, base.hypothesis.effects});
    if (at.ok()) predicted_ = *at;
    error_ = fitter.whitener()(study.measured() - predicted_);
    freed_error_ = Free(error_);
  }

  /// Without what the doubts can mimic. A doubt that is the candidate's own parameter stays with the others here, so
  /// parameter changes are projected at the freedom their prior leaves.
  Eigen::VectorXd Free(const Eigen::VectorXd& x) const {
    return white_.cols() > 0 ? Eigen::VectorXd(x - white_ * factor_.solve(white_.transpose() * x)) : x;
  }

  Screened At(const Candidate& candidate, double threshold) const {
    Screened best;
    best.chi2 = best.criterion = std::numeric_limits<double>::infinity();
    best.smallest = std::numeric_limits<double>::quiet_NaN();
    // The candidate's own doubt must not compete with it.
    DoubtModel doubts = Without(candidate);
    const auto take = [&](const Fit& fit) {
      best.simulations += fit.simulations;
      if (!fit.ok() || !(fit.criterion < best.criterion)) return;
      best.chi2 = fit.chi2;
      best.criterion = fit.criterion;
      best.parameters = fit.hypothesis.effects.back().parameters;
    };
    const auto evaluate = [&](const std::vector<double>& parameters) {
      std::vector<Assumed> effects = base_.hypothesis.effects;
      effects.push_back(candidate.At(parameters));
      return fitter_.Evaluate(effects, doubts);
    };
    for (const std::vector<double>& start : candidate.starts) {
      if (candidate.strengths.empty()) {
        take(evaluate(start));
        continue;
      }
      std::vector<double> from = start;
      const int rounds = candidate.strengths.size() == 1 ? 2 : 1;
      for (int round = 0; round < rounds; ++round) {
        const std::optional<std::vector<double>> scaled = Scale(candidate, from, threshold, best);
        if (!scaled) break;
        take(evaluate(*scaled));
        if (*scaled == from) break;
        from = *scaled;
        if (std::abs(from[candidate.strengths[0]] - candidate.effect->info().parameters[candidate.strengths[0]].neutral) <
            1e-9 * std::abs(start[candidate.strengths[0]] - candidate.effect->info().parameters[candidate.strengths[0]].neutral))
          break;
      }
    }
    if (candidate.strengths.empty() && !candidate.effect->info().parameters.empty() && !best.parameters.empty()) {
      std::vector<Assumed> effects = base_.hypothesis.effects;
      effects.push_back(candidate.At(best.parameters));
      take(fitter_.Optimise(effects, doubts, 4));
    }
    return best;
  }

 private:
  DoubtModel Without(const Candidate& candidate) const {
    std::vector<Assumed> effects = base_.hypothesis.effects;
    effects.push_back(candidate.At(candidate.starts.front()));
    const std::vector<double> freedom = FreedomOf(study_, effects);
    DoubtModel doubts = base_.doubts;
    std::vector<int> columns;
    for (std::size_t k = 0; k < doubts.free.size(); ++k) {
      const auto i = static_cast<std::size_t>(doubts.free[k]);
      doubts.freedom[i] = std::min(doubts.freedom[i], freedom[i]);
      if (doubts.freedom[i] > 0.0) columns.push_back(static_cast<int>(k));
    }
    if (columns.size() == doubts.free.size()) return doubts;
    DoubtModel fewer = doubts;
    fewer.free.clear();
    fewer.jacobian.resize(doubts.jacobian.rows(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) {
      fewer.free.push_back(doubts.free[static_cast<std::size_t>(columns[k])]);
      fewer.jacobian.col(static_cast<Eigen::Index>(k)) = doubts.jacobian.col(columns[k]);
    }
    return fewer;
  }

  /// One signature a strength at its size in `from`; the sizes that fit best, within the bounds.
  std::optional<std::vector<double>> Scale(const Candidate& candidate, const std::vector<double>& from,
                                           double threshold, Screened& screened) const {
    const std::vector<EffectParameter>& parameters = candidate.effect->info().parameters;
    const std::vector<std::size_t>& strengths = candidate.strengths;
    std::vector<double> neutral = from;
    for (const std::size_t i : strengths) neutral[i] = parameters[i].neutral;
    Eigen::MatrixXd signatures(error_.size(), static_cast<Eigen::Index>(strengths.size()));
    for (std::size_t k = 0; k < strengths.size(); ++k) {
      std::vector<double> at = neutral;
      at[strengths[k]] = from[strengths[k]];
      std::vector<Assumed> effects = base_.hypothesis.effects;
      effects.push_back(candidate.At(at));
      ++screened.simulations;
      const Result<Eigen::VectorXd> predicted = study_.Predict({base_.doubts.z0, effects});
      if (!predicted.ok() || !predicted->allFinite()) return std::nullopt;
      const Eigen::VectorXd signature = Free(fitter_.whitener()(*predicted - predicted_));
      signatures.col(static_cast<Eigen::Index>(k)) = signature;
      const double size = std::abs(from[strengths[k]] - neutral[strengths[k]]);
      const double norm = signature.norm();
      if (k == 0 && norm > 0.0) {
        const double seen = size * std::sqrt(threshold) / norm;
        if (!(screened.smallest <= seen)) screened.smallest = seen;
      }
    }
    // Strengths that would leave their bounds on the wrong side of neutral fall out one by one.
    std::vector<double> scaled = neutral;
    std::set<std::size_t> in;
    for (std::size_t k = 0; k < strengths.size(); ++k) in.insert(k);
    while (!in.empty()) {
      Eigen::MatrixXd used(error_.size(), static_cast<Eigen::Index>(in.size()));
      Eigen::Index column = 0;
      for (const std::size_t k : in) used.col(column++) = signatures.col(static_cast<Eigen::Index>(k));
      Eigen::MatrixXd gram = used.transpose() * used;
      gram.diagonal().array() *= 1.0 + 1e-9;
      gram.diagonal().array() += 1e-12;
      const Eigen::VectorXd alpha = gram.ldlt().solve(used.transpose() * freed_error_);
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

  const Study& study_;
  const Fitter& fitter_;
  const Fit& base_;
  Eigen::MatrixXd white_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd predicted_, error_, freed_error_;
};

}  // namespace

std::vector<Screened> Screen(const Study& study, const Fitter& fitter, const Fit& base,
                             const std::vector<Candidate>& candidates, double threshold,
                             const std::function<void(double)>& progress) {
  const Look look(study, fitter, base);
  std::vector<Screened> all(candidates.size());
  std::vector<std::size_t> first, second;
  std::set<std::string> promising;
  for (std::size_t i = 0; i < candidates.size(); ++i) (candidates[i].refinement ? second : first).push_back(i);
  std::atomic<std::size_t> done = 0;
  const auto run = [&](const std::vector<std::size_t>& which) {
    ParallelFor(which.size(), 0, [&](std::size_t k) {
      const std::size_t i = which[k];
      all[i] = look.At(candidates[i], threshold);
      all[i].candidate = i;
      ++done;
      if (k % 2 == 0) progress(static_cast<double>(done) / static_cast<double>(candidates.size()));
    });
  };
  run(first);
  for (const std::size_t i : first) {
    const std::string& name = candidates[i].effect->info().name;
    const bool friction = name == "coulomb_friction" || name == "viscous_friction" || name == "constant_load" ||
                          name == "quadratic_drag";
    if (friction && base.chi2 - all[i].chi2 > threshold) promising.insert(candidates[i].place.ToString());
  }
  std::erase_if(second, [&](std::size_t i) { return !promising.contains(candidates[i].place.ToString()); });
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
