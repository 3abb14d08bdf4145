// Sensors that warm up: what several outputs add to what the machine does, slowly and by themselves. One that drifts alone is the effect
// sensor_drift; several at once are no cause that one effect stands for, and mislead a search for one.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/contestant.h"
#include "experiment/records.h"

namespace dynoproof::diagnosis {

/// value(t) = sum_k height_k (1 - exp(-t / tau_k)) of one output of one record, t as in its series: warming with any time constant within
/// the record is a sum of three such terms to some hundredths, and a steady drift nearly so.
struct Drift {
  std::size_t record = 0;
  std::string signal, unit;
  double length_s = 0.0;    // of the record, of which the time constants are 0.1, 0.3 and 1
  Eigen::Vector3d heights;  // unit of the signal
  double of_noise = 0.0;    // its RMS over the output's noise
  /// Squares of deviations by which it is off none, of three degrees of freedom: what numbers of the model might do is no drift.
  double deviations = 0.0;

  double At(double time_s) const;
};

/// Drifts of all outputs beside a model, and its numbers fitted along.
struct Drifts {
  std::string beside;             // the model that leaves least with them
  estimation::Hypothesis model;   // that
  Eigen::VectorXd q;              // where its fit has come to
  double leaves = 1.0;            // of what the best model leaves beyond the noise without them, as a share
  bool exact = false;             // that is nothing but noise
  bool of_output = false;         // the best model without them has an effect at an output as its last one
  std::vector<Drift> of_sensors;  // one each
  std::int64_t simulations = 0;   // that were needed

  /// Whether they take most of what the best model leaves, and are several.
  bool Found() const;
  /// Whether nothing else need be asked first: what is best without them is one sensor's fault.
  bool Plainly() const;
  /// Whether they are taken off where no pair of causes leaves nothing but noise: they take nearly all.
  bool Suffice() const;
};
/// Drifts are looked for beside the null of a contest and beside its best effect on the machine; an effect at an output may be a drift
/// itself. Returns nothing where neither model holds at this level. `plan`: that of the levels.
std::optional<Drifts> FindDrifts(const Plan& plan, std::span<const Contestant> contestants, const Levels& levels,
                                 std::size_t level, const Registry& registry);

/// The drifts of other records beside a plan.
std::vector<Drift> DriftsBeside(const Plan& plan, const Levels& levels, std::size_t level);

/// "0.31 N m of T_1, -0.02 rad/s of omega_1, ...": what each has come to at the end of the data.
std::string ToText(const std::vector<Drift>& drifts);

}  // namespace dynoproof::diagnosis
