// A record of the line that no engine code simulated.
#pragma once

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "experiment/records.h"
#include "tests/blind/independent_line.h"
#include "tests/identification/made_record.h"

namespace dynoproof::identification {

/// Dry [N m] and viscous [N m s/rad] friction that differ with direction, as a torque of the speed [rad/s]. It creeps
/// where the engine's sticks: below 1e-4 rad/s.
inline std::function<double(double)> FrictionByDirection(double dry_forth, double dry_back, double viscous_forth,
                                                         double viscous_back) {
  return [=](double speed) {
    const double rubs = std::tanh(speed / 1e-4);
    return speed > 0.0 ? -dry_forth * rubs - viscous_forth * speed : -dry_back * rubs - viscous_back * speed;
  };
}

/// Driven by `torque` at 10 kHz [N m], with white noise of `noise` of each output's spread.
inline MappedRecord LineRecord(const blind::IndependentLine& line, std::vector<double> torque, double noise) {
  const blind::IndependentLine::Output output = line.Run(torque);
  MappedRecord record;
  const auto time = Shared(Times(torque.size()));
  record.inputs["T_airgap"] = {time, Shared(std::move(torque))};
  record.outputs["T_shaft"] = {time, Noisy(output.T_shaft, noise, 2)};
  record.outputs["omega_1"] = {time, Noisy(output.omega_1, noise, 3)};
  record.end_s = time->back();
  return record;
}

}  // namespace dynoproof::identification
