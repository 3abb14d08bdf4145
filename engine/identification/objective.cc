#include "identification/objective.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <map>
#include <string>
#include <utility>

#include "identification/noise_model.h"
#include "identification/start.h"
#include "identification/step_spectrum.h"

namespace dynoproof::identification {
namespace {

class FreeRun : public Objective {
 public:
  explicit FreeRun(const EstimationProblem& problem) : problem_(problem) {
    std::map<std::string, std::pair<double, double>> of_output;  // squares of spreads, and rows
    for (const ComparedOutput& c : problem.channels()) {
      auto& [squares, rows] = of_output[c.name];
      squares += static_cast<double>(c.count) * std::pow(c.spread, 2);
      rows += static_cast<double>(c.count);
    }
    for (const ComparedOutput& c : problem.channels()) {
      const auto& [squares, rows] = of_output[c.name];
      const double spread = std::sqrt(squares / std::max(1.0, rows));
      size_of_.push_back(spread > 1e-9 * c.nominal ? spread : c.nominal);
    }
  }

  Eigen::Index size() const override { return problem_.measured().size(); }

  Result<Eigen::VectorXd> Of(const Plan& plan) const override {
    const Result<Plan> from_start = FitStarts(problem_, plan);
    if (!from_start.ok()) return from_start.failure();
    Result<Eigen::VectorXd> predicted = problem_.PredictPlan(*from_start);
    if (!predicted.ok()) return predicted;
    Eigen::VectorXd error = problem_.measured() - *predicted;
    for (std::size_t k = 0; k < size_of_.size(); ++k) {
      const ComparedOutput& c = problem_.channels()[k];
      error.segment(c.begin, c.count) /= size_of_[k];
    }
    return error;
  }

  std::vector<std::pair<Eigen::Index, Eigen::Index>> Courses() const override {
    std::vector<std::pair<Eigen::Index, Eigen::Index>> courses;
    for (const ComparedOutput& c : problem_.channels()) courses.emplace_back(c.begin, c.count);
    return courses;
  }

 private:
  const EstimationProblem& problem_;
  /// By channel: the spread of its output over all records, for an error of one size is as bad in each. A constant has no spread; its unit
  /// has a size.
  std::vector<double> size_of_;
};

// Narrow bands know more, and have false minima beside the truth: a transient's spectrum has fringes.
constexpr double kBand = 0.1;        // half of the width over the frequency ...
constexpr std::size_t kLines = 32;   // ... and so many lines of the transform at least
constexpr double kRoundOff = 1e-20;  // of the largest power: below there is nothing to compare

/// Mean by band of what a transform of `rows` rows has in its lines. Bands overlap and fade out: a resonance that moves
/// moves smoothly from one into the next.
template <class Line>
Eigen::VectorXd ByBand(std::size_t rows, const Line& line) {
  std::vector<double> means;
  for (std::size_t middle = 1; middle < rows / 2;) {
    const std::size_t width = std::max(kLines, static_cast<std::size_t>(kBand * static_cast<double>(middle)));
    double sum = 0.0, weights = 0.0;
    for (std::size_t k = middle > width ? middle - width : 1; k < std::min(middle + width, rows / 2); ++k) {
      const double weight = static_cast<double>(width) - std::abs(static_cast<double>(k) - static_cast<double>(middle));
      sum += weight * line(k);
      weights += weight;
    }
    means.push_back(sum / weights);
    middle += width / 2;
  }
  return Eigen::Map<const Eigen::VectorXd>(means.data(), static_cast<Eigen::Index>(means.size()));
}

/// Zeros behind a channel make a length that is quick to transform.
std::size_t Padded(Eigen::Index rows) { return std::bit_ceil(static_cast<std::size_t>(rows)); }

/// Of one channel's steps.
Eigen::VectorXd PowerByBand(const Eigen::Ref<const Eigen::VectorXd>& rows) {
  const std::vector<std::complex<double>> lines = StepLines(rows, Padded(rows.size()));
  return ByBand(lines.size(), [&](std::size_t k) { return std::norm(lines[k]); });
}

/// The same of white noise with this standard deviation.
Eigen::VectorXd NoiseByBand(Eigen::Index rows, double sigma) {
  const std::size_t padded = Padded(rows);
  return ByBand(padded, [&](std::size_t k) {
    return StepNoisePower(rows, sigma, static_cast<double>(k) / static_cast<double>(padded));
  });
}

class Spectrum : public Objective {
 public:
  explicit Spectrum(const EstimationProblem& problem) : problem_(problem) {
    Eigen::Index begin = 0;
    for (const ComparedOutput& c : problem.channels()) {
      const auto rows = problem.measured().segment(c.begin, c.count);
      measured_.push_back(PowerByBand(rows));
      noise_.push_back(NoiseByBand(c.count, HighFrequencyFloor(rows)).array() +
                       kRoundOff * measured_.back().maxCoeff());
      courses_.emplace_back(begin, measured_.back().size());
      begin += measured_.back().size();
    }
    size_ = begin;
  }

  Eigen::Index size() const override { return size_; }

  Result<Eigen::VectorXd> Of(const Plan& plan) const override {
    const Result<Eigen::VectorXd> predicted = problem_.PredictPlan(plan);
    if (!predicted.ok()) return predicted;
    Eigen::VectorXd error(size_);
    for (std::size_t k = 0; k < measured_.size(); ++k) {
      const ComparedOutput& c = problem_.channels()[k];
      const Eigen::ArrayXd power = PowerByBand(predicted->segment(c.begin, c.count)).array() + noise_[k].array();
      const Eigen::ArrayXd ratio = measured_[k].array().max(1e-3 * noise_[k].array()) / power;
      error.segment(courses_[k].first, courses_[k].second) = 0.5 * ratio.log();
    }
    return error;
  }

  std::vector<std::pair<Eigen::Index, Eigen::Index>> Courses() const override { return courses_; }

 private:
  const EstimationProblem& problem_;
  std::vector<Eigen::VectorXd> measured_, noise_;  // power by channel and band
  std::vector<std::pair<Eigen::Index, Eigen::Index>> courses_;
  Eigen::Index size_ = 0;
};

}  // namespace

std::unique_ptr<Objective> FreeRunObjective(const EstimationProblem& problem) {
  return std::make_unique<FreeRun>(problem);
}
Result<double> NrmseOf(const Objective& free_run, const Plan& plan) {
  const Result<Eigen::VectorXd> error = free_run.Of(plan);
  if (!error.ok()) return error.failure();
  return std::sqrt(error->squaredNorm() / static_cast<double>(error->size()));
}

std::unique_ptr<Objective> SpectrumObjective(const EstimationProblem& problem) {
  return std::make_unique<Spectrum>(problem);
}

}  // namespace dynoproof::identification
