// Every candidate fitted to the same data, beside the record at some levels of correction and in the free run: nobody is
// dropped before it has been fitted once.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "diagnosis/conduct.h"
#include "diagnosis/contestant.h"
#include "diagnosis/diagnose.h"
#include "model/registry.h"

namespace dynoproof::diagnosis {

/// The null, which may have effects already, and the ten candidates on top of it that remove most, each fitted at every
/// level.
struct Contest {
  bool released = false;                // nominal values without priors
  bool complete = true;                 // false: the conduct has ended it before the free run
  std::size_t first = 0;                // the level of the first look
  std::vector<Contestant> contestants;  // the null first
  std::vector<Contestant> left_behind;  // after the first look, the best first
  std::vector<NotTestable> silent;      // that moved no output
  struct Cost {
    std::string stage;
    std::int64_t simulations;
  };
  std::vector<Cost> cost;

  const Contestant& null() const { return contestants.front(); }
  static std::string Pass(bool released) {
    return released ? "nominal values released" : "nominal values on their priors";
  }
  std::string pass() const { return Pass(released); }
};

/// The plan without further effects, its nominal values and the starts of records that it holds free.
estimation::Hypothesis NullHypothesis(const Plan& plan, bool released, const Levels& levels, const Registry& registry);

/// Fits a model at all levels, one after the other, each from where the last one that holds has come to.
void FitAlong(Contestant& one, const Levels& levels, Eigen::VectorXd from);

/// The same, fitted at every level.
Contestant NullOf(const Plan& plan, bool released, const Levels& levels, const Registry& registry);

/// `magnitudes`: of the first record. `admitted`: models with one effect on top of the same plan that another pass has admitted; they are
/// carried along, from the values to which they have come there. Fails where the null breaks at every level.
Result<Contest> Compete(Contestant null, bool released, const Levels& levels, const Magnitudes& magnitudes,
                        const Registry& registry, const Conduct& conduct, std::span<const Contestant> admitted = {});

}  // namespace dynoproof::diagnosis
