// How strongly a record corrects a run. A model that runs beside its record and is corrected by it forgets an error after
// a while, the memory; what remains is what it predicts wrongly within that time. The gains are those of a stationary
// Kalman filter of the nominal model for unknown white forces at each body and each input; how large they are is found
// such that the slowest time constant of the corrected run is the memory. They serve every hypothesis alike.
#pragma once

#include <Eigen/Dense>
#include <map>
#include <string>
#include <vector>

#include "base/status.h"
#include "estimation/built_run.h"
#include "estimation/data_set.h"
#include "linear/discrete_equations.h"

namespace dynoproof::estimation {

/// The nominal model over one period, about where it runs: of the states that forces move and outputs see, sensors apart.
struct LinearModel {
  std::vector<std::string> states, modes, outputs, forces;  // by name; outputs as in the record
  Eigen::VectorXd scale;                                    // usual magnitude of each state
  mechanics::BalancedPart part;                             // of the scaled states
  double period_s = 0.0;
  Eigen::VectorXd slopes, kept;  // by output: of the sensor's chain, and what a lag in it keeps of itself over a period
  struct Regime {
    std::vector<int> modes;   // their values: contact or none
    Eigen::MatrixXd A, G, C;  // r x r, r x forces, outputs x r: one period of the part; outputs as if no sensor lagged
  };
  std::vector<Regime> regimes;  // the most visited first; at least one
  /// Orthonormal basis of the part that outputs see in one regime or another [r x s]. No gain changes the rest, as the common speed of
  /// a line of which a twist is measured.
  Eigen::MatrixXd seen;
  /// Whether there are states at all: in a plant without them nothing is there that a record could correct.
  bool HasStates() const { return part.basis.cols() > 0; }
  /// A system matrix as outputs see it [s x s].
  Eigen::MatrixXd Seen(const Eigen::MatrixXd& A) const { return seen.transpose() * A * seen; }

  /// `record`: of a data set of `plan`. A rig that is linear is linearised once; another one along its free run, a median for
  /// each regime that it visits.
  static Result<LinearModel> Of(const Plan& plan, const MappedRecord& record, const Registry& registry);
  /// Another rig in the same coordinates, about the start of its run: with its sensors, and without them
  /// (WithoutSensors). Fails where that cannot be had.
  Result<LinearModel> Reduced(const BuiltRun& whole, const BuiltRun& run) const;

 private:
  /// Takes the slopes and lags of a run's sensors.
  Status SeeThrough(const BuiltRun& run);
};

class Observer {
 public:
  /// A gain for each regime of the model: `memory_s` or, where no unknown forces make it as short, the shortest there is.
  /// `noise`: standard deviation of each output of the model. `step_s`: of the samples.
  Observer(const LinearModel& model, const Eigen::VectorXd& noise, double step_s, double memory_s);

  /// Slowest time constant of the corrected run [s], of the most visited regime.
  double memory_s() const { return memory_s_; }
  /// Unknown forces, over the usual magnitude of what drives, white over the samples' period.
  double share() const { return share_; }
  /// Covariance of the innovations [outputs x outputs], if forces as large as share() act and nothing else is unknown.
  const Eigen::MatrixXd& innovation_covariance() const { return innovation_covariance_; }
  /// RMS by output that measurement noise of these standard deviations alone causes in the innovations of a corrected
  /// linear model (its first regime), whose errors are carried back through its own sensors' chains.
  Eigen::VectorXd NoiseAlone(const LinearModel& model, const Eigen::VectorXd& white) const;

  /// By output of the model: the slope of the nominal sensor, in whose unit the gains take errors.
  const Eigen::VectorXd& slopes() const { return slopes_; }
  /// For a rig in these modes: by output, the change of each of the rig's states, by the regime in which most of the nominal model's own
  /// modes are as the rig's of the same name. States that the nominal model does not have are not corrected.
  std::vector<std::vector<double>> GainsFor(const Rig& rig, const std::vector<int>& modes) const;

 private:
  struct Gain {
    std::vector<int> modes;
    Eigen::MatrixXd reduced, physical;  // r x outputs; states x outputs
  };
  std::vector<std::string> states_, modes_;
  std::vector<Gain> gains_;
  Eigen::VectorXd slopes_;  // of the nominal sensors
  int stride_ = 1;          // periods between samples
  double memory_s_ = 0.0, share_ = 0.0;
  Eigen::MatrixXd innovation_covariance_;
};

/// The memory [s] for searches in a record of that length: fifteen periods of the slowest mode; of a plant without modes a
/// tenth of its slowest time constant.
double MemoryFor(const LinearModel& model, double duration_s);

/// How much of a record that begins in motion is not compared [s]: five memories, after which what a start was wrong by is
/// e^-5 of it, and a fifth of the record at most.
double LeadInOf(double memory_s, double duration_s);

}  // namespace dynoproof::estimation
