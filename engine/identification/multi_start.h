// The search for the numbers of a scenario that make an objective smallest: bounded, from several starts.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identification/objective.h"

namespace dynoproof::identification {

constexpr double kWithoutBounds =
    10.0;  // times the nominal value, up and down: where a number is sought that has no bounds

struct FreeKey {
  std::string key;                                  // dotted path of a number
  std::optional<std::pair<double, double>> bounds;  // none: kWithoutBounds
};

/// How one number is searched: by its logarithm between bounds of one sign, else by one that is linear about zero, so
/// that a damping may be none. x is 0 at the nominal value, or at zero.
class Axis {
 public:
  Axis(const FreeKey& free, double nominal);

  double At(double value) const;
  double ValueAt(double x) const;
  double Slope(double x) const;  // of the value over x
  /// The nominal value, or the bound next to it.
  double Nominal() const;
  /// `share`, 0 to 1, of the way between the bounds; without bounds within +-10 % of the nominal value.
  double Start(double share) const;
  bool OnBound(double x) const;

  std::string key;
  double nominal = 0.0, low = 0.0, high = 0.0;

 private:
  bool logarithmic_ = true, anywhere_ = false;
  double unit_ = 1.0;
};

/// The plan with these numbers.
Plan With(Plan plan, const std::vector<Axis>& axes, const std::vector<double>& x);

struct MultiStartOptions {
  int starts = 4;         // the first is the nominal one, the others the best of several random points each
  std::size_t tries = 1;  // random points for a start: as many as do not count beside a fit
  std::function<void(double)> progress = [](double) {};
  std::vector<double> first = {};  // where the first start begins [axes' own numbers]; empty: nominal values
};

/// So many random points for a start: one where no number has bounds, else 20 where each takes a run, and 200 where none does.
std::size_t TriesOf(const std::vector<FreeKey>& keys, bool by_runs);

/// Where the best of all starts came to rest.
struct Optimum {
  std::vector<double> x;
  Eigen::VectorXd error;
  Eigen::MatrixXd jacobian;
  int converged = 0;  // starts that reached its cost within 0.1 %
};

/// Fails where the nominal run breaks, and one beside the optimum; with exit code 4 where nothing is compared.
Result<Optimum> Minimise(const Plan& plan, const Objective& objective, const std::vector<Axis>& axes,
                         const MultiStartOptions& options);

}  // namespace dynoproof::identification
