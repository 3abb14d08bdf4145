// The loop of a scenario with the machine (scenarios/suppression/_machine.toml) as the eigenvalue problem of MachineLoop:
// line, drive and places from the scenario as it runs, changes by --set included.
#pragma once

#include "model/plan.h"
#include "sim/rig.h"
#include "thesis/machine_loop.h"

namespace dynoproof {

/// Line and drive as the plan and its rig have them: the machine's torque acts where the plant's input takes it, the core
/// is fed with the torque of one shaft, and the field turns with the speed that it is fed with. The machine is the one
/// that its control is told of. Fails (exit code 2) on a scenario without `control.core`, `control.machine` and
/// `part.machine`, or one where something stands between core and control.
Result<MachineLoop> MachineLoopOf(const Plan& plan, const Rig& rig, double highest_Hz);

}  // namespace dynoproof
