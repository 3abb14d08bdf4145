// What makes a made record unlike any model: machines, sensors and loggers as they are, none of it in the contract's list
// of effects. An inexact case has one or two of them, and what it hides shows at least twice as much.
#pragma once

#include "model/plan.h"
#include "model/registry.h"
#include "tests/blind/blind_case.h"

namespace dynoproof::blind {

/// How many times as much as what is inexact a cause shows where it is the main one.
inline constexpr double kMain = 2.0;

/// Draws one or two that this case can have. `fitted` stands for nominal values fitted to the record (FittedNumbers()).
void DrawInexact(Case& hidden, Dice& dice);

/// Registers what no scenario names: the law `creeping`, the stage `soft_stop`.
void RegisterInexact(Registry& registry);

/// Changes the machine: `absorber` hangs a small mass on a spring at a body, `soft_stop` lets a drive give less and less
/// near its limit. `healthy`: the record before. Whether there was anything to change.
bool MakeInexact(Plan& plan, const Columns& healthy, Case& hidden, Dice& dice);

/// The hidden Coulomb friction of `plan` as it is where it creeps before it slips, and changes with the angle.
void LetCreep(Plan& plan, Case& hidden, Dice& dice);

/// Changes what was recorded: `hum`, `filtered`, `drifting`, `coloured`, `noisy_input`, `decimated`.
void RecordInexactly(Columns& columns, Case& hidden, Dice& dice);
/// Rounds outputs to steps of two to six times their noise, which they have by then.
void Quantise(Columns& columns, const Case& hidden, Dice& dice);

/// Numbers of a plan that its owner has fitted to the record, by dotted path: three of its bodies, springs and volumes.
std::vector<std::string> FittedNumbers(const Plan& plan, Dice& dice);

}  // namespace dynoproof::blind
