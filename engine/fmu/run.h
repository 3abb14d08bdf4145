// A scenario's run that somebody else paces: inputs from outside are held over whole periods.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/status.h"
#include "experiment/prepare.h"
#include "sim/simulate.h"

namespace dynoproof::fmu {

class Run {
 public:
  /// Started at t = 0. Inputs that the scenario's sources drive are driven by inputs() from now on, which begins with `first` or, where that
  /// is empty, with what the sources give at t = 0. Fails where the plan is faulty or the run breaks.
  static Result<std::unique_ptr<Run>> Of(const Plan& plan, const Registry& registry,
                                         std::span<const double> first = {});

  std::span<double> inputs() { return inputs_; }
  std::size_t outputs() const { return scenario_->rig->outputs.size(); }
  double period_s() const { return scenario_->rig->SecondsOf(scenario_->rig->period); }

  /// Goes on by so many periods.
  Status Advance(std::int64_t periods);
  /// The samples of the outputs now.
  Result<std::vector<double>> Outputs();

 private:
  Run() = default;

  std::unique_ptr<Prepared> scenario_;
  std::unique_ptr<Solver> solver_;
  std::unique_ptr<Simulation> simulation_;
  std::vector<double> inputs_;
};

}  // namespace dynoproof::fmu
