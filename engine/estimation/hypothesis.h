// A model structure: a nominal plan, what is free in it, and effects at places on top.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "model/effect.h"
#include "model/registry.h"

namespace dynoproof::estimation {

class Hypothesis {
 public:
  /// An effect of the hypothesis.
  struct Applied {
    const Effect* effect;
    Place place;
    bool operator==(const Applied&) const = default;
  };

  /// The plan with its effects applied, and nothing free.
  explicit Hypothesis(Plan nominal) : nominal_(std::move(nominal)) {}

  /// The nominal values that its plant knows to a tolerance only, each with its prior and bounds of three deviations: what
  /// needs more is not within the prior, and says so as an effect or not at all.
  Hypothesis WithNominalValuesFree(const Registry& registry) const;
  /// The same without priors, anywhere within a decade: a model that was fitted without its missing effect has swallowed it,
  /// and gives it back only when it is let go.
  Hypothesis WithNominalValuesReleased(const Registry& registry) const;
  /// One of the plan's free numbers without its prior, anywhere within a decade.
  Hypothesis WithReleased(const std::string& name) const;
  /// Where a record starts, in the numbers that its plant declares for that, as far as the plan holds them for it
  /// (StartOfRecord()): each with its prior.
  Hypothesis WithStartFree(std::size_t record, const Registry& registry) const;
  /// How numbers differ from record to record (NumbersThatDiffer()): of each of `records`, where there are several, a factor
  /// of each such number, with its prior. Named DifferenceOfRecord(r) + "." + path.
  Hypothesis WithDifferencesFree(std::size_t records) const;
  /// The same machine, simulated as exactly as another plan is: in as many substeps a period, with as many modes of soft rotors.
  Hypothesis AsExactAs(const Plan& plan) const;
  /// A number of the plan, by its dotted path.
  Hypothesis WithFree(Parameter parameter) const;
  /// An effect on top. The number that it scales, if any, is not free any more. Starts and sizes are those of its first
  /// start for a record of these magnitudes.
  Hypothesis With(const Effect& effect, const Place& place, const Magnitudes& magnitudes) const;

  const Plan& nominal() const { return nominal_; }
  /// In the order in which they came on top.
  const std::vector<Applied>& effects() const { return effects_; }
  /// How many of the parameters are those of effects.
  std::size_t of_effects() const;
  /// Effects' first, in order; then the plan's.
  const std::vector<Parameter>& parameters() const { return parameters_; }
  /// Where a search begins: effects at their starts, the plan as it is. [parameters]
  const Eigen::VectorXd& start() const { return start_; }
  /// Bounds of the coordinates.
  Eigen::VectorXd lower() const;
  Eigen::VectorXd upper() const;
  /// The plan at these coordinates [parameters].
  Plan At(const Eigen::VectorXd& q) const;
  /// "coulomb_friction@inertia:I5", or "nominal".
  std::string Name() const;

 private:
  void Insert(std::size_t at, Parameter parameter, double value);
  Hypothesis WithNominalValues(const Registry& registry, bool released) const;

  Plan nominal_;
  std::vector<Applied> effects_;
  std::vector<Parameter> parameters_;
  Eigen::VectorXd start_;
};

}  // namespace dynoproof::estimation
