// SUNDIALS behind one small interface: an adaptive integrator with root finding that can be restarted anywhere.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/status.h"

namespace dynoproof {

/// x' = rates(t, x); guards(t, x) are watched for sign changes. Both write into the span they are given.
struct OdeProblem {
  std::function<void(double, std::span<const double>, std::span<double>)> rates, guards;
  std::vector<double> absolute_tolerance;  // by state
  double relative_tolerance = 1e-9;
  double max_step_s = 0.0;  // 0: none
  int guard_count = 0;
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  /// Forgets the past and begins at (t, x): after any jump of an input, state or mode.
  virtual Status Restart(double time_s, std::span<const double> states) = 0;
  /// Goes to `end_s` exactly, or to the first root before it. `time_s` and `states` are where it stopped; `roots` the
  /// guards that changed sign there (empty at the end).
  virtual Status Evolve(double end_s, double& time_s, std::span<double> states, std::vector<int>& roots) = 0;
  /// Totals since construction: "steps", "failed_steps", "rate_calls", "restarts".
  virtual std::map<std::string, std::int64_t> counters() const = 0;
  virtual std::string name() const = 0;
};

/// ARKODE, explicit Runge-Kutta of order 8 (Verner 8(6)): mildly stiff drive lines with many restarts.
Result<std::unique_ptr<Integrator>> MakeExplicitIntegrator(OdeProblem problem);
/// CVODE, BDF with a dense difference Jacobian: stiff plants with few restarts.
Result<std::unique_ptr<Integrator>> MakeBdfIntegrator(OdeProblem problem);

}  // namespace dynoproof
