// Independent references. An oracle shares no code with the engine's models and solvers: it reads the scenario's
// numbers itself and computes the outputs by another method. tests/oracles prove each against closed forms.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/status.h"
#include "model/value.h"

namespace dynoproof::oracles {

/// What an oracle is asked: a scenario (effects applied) and the commands its inputs held.
struct Question {
  const Value& scenario;
  std::span<const double> time;                           // n ticks [s], uniform; none: only whether it applies
  std::map<std::string, std::span<const double>> inputs;  // by name; value k holds from tick k to k + 1
  std::vector<std::string> outputs;                       // names of [output.NAME]
};
using Answer = std::map<std::string, std::vector<double>>;

/// A linear drive line with held inputs, solved exactly: one matrix exponential in extended precision for the period,
/// then a dense recursion in relative angles and speeds. Fails (exit code 2) when the scenario has anything else in it:
/// laws other than spring and damper, hydrodynamic couplings or viscous loads, actuator or sensor stages, further
/// parts.
Result<Answer> HeldInputExponential(const Question& question);

/// A drive line with exactly one shaft with play of a law that is linear between changes of contact (dead_zone,
/// revised_dead_zone, phase_plane, full_state_backlash), with held inputs: one matrix exponential per contact, changes
/// found by bisection down to 1e-11 of a period. Fails (exit code 2) on anything else.
Result<Answer> PiecewiseExponential(const Question& question);

/// A pressure plant (charge_air with flaps by the formula, fuel_gas with the linear valve and without friction), leaks
/// and droop included, with held inputs: extrapolation in extended precision (Bulirsch-Stoer), tick by tick. Fails
/// (exit code 2) on anything else.
Result<Answer> PressureExtrapolation(const Question& question);

/// All oracles by name. Asked without times, an oracle answers with nothing where it applies, and refuses elsewhere.
using Oracle = Result<Answer> (*)(const Question&);
const std::map<std::string, Oracle, std::less<>>& All();

}  // namespace dynoproof::oracles
