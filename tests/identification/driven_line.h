// The lumped line under a random torque, and records of it with an effect and noise.
#pragma once

#include <memory>
#include <vector>

#include "identification/estimation_problem.h"
#include "tests/identification/lumped_line.h"
#include "tests/identification/made_record.h"

namespace dynoproof::identification {

class DrivenLine : public LumpedLine {
 protected:
  explicit DrivenLine(std::size_t rows) {
    time_ = Shared(Times(rows));
    record_.inputs["T_airgap"] = {time_, Shared(RandomTorque(rows))};
    record_.end_s = time_->back();
  }

  /// The record of a machine with these effects, simulated with so many substeps; `noise`: of each signal's spread.
  EstimationProblem Measure(const std::vector<EffectInstance>& effects, int substeps, double noise) {
    MappedRecord silent = record_;
    for (const char* output : {"T_shaft", "omega_1"})
      silent.outputs[output] = {time_, Shared(std::vector<double>(time_->size(), 1.0))};
    const EstimationProblem problem(*plan_, {silent}, registry_);
    Plan plan = problem.PlanOf({problem.Nominal().z, effects});
    SetSubsteps(plan, substeps);
    const Result<Eigen::VectorXd> clean = problem.PredictPlan(plan);
    EXPECT_TRUE(clean.ok());
    std::uint64_t stream = 2;
    for (const Channel& channel : problem.channels()) {
      const Eigen::VectorXd rows = clean->segment(channel.begin, channel.count);
      record_.outputs[channel.name] = {time_, Noisy({rows.begin(), rows.end()}, noise, stream++)};
    }
    return EstimationProblem(*plan_, {record_}, registry_);
  }

  std::shared_ptr<const std::vector<double>> time_;
  MappedRecord record_;
};

}  // namespace dynoproof::identification
