// A record of the line that no engine code simulated.
#pragma once

#include <utility>
#include <vector>

#include "experiment/records.h"
#include "tests/blind/independent_line.h"
#include "tests/diagnosis/made_record.h"

namespace dynoproof::diagnosis {

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

}  // namespace dynoproof::diagnosis
