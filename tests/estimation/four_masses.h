// A drive line of four masses under a multisine on a torque that swings slowly: every mode is seen, and the speed changes
// its sign, so that friction shows.
#pragma once

#include <string>

#include "model/plan.h"

namespace dynoproof::estimation {

/// At 10 kHz. Outputs: the torque of the last shaft, the speeds of the first and the last mass.
inline Plan FourMasses(double duration_s) {
  const auto shaft = [](const char* left, const char* right, double stiffness, double damping) {
    return Value{
        {"between", Value::Array{left, right}}, {"stiffness_Nm_per_rad", stiffness}, {"damping_Nms_per_rad", damping}};
  };
  const auto output = [](const char* of, const char* unit, double nominal) {
    return Value{{"of", of}, {"unit", unit}, {"nominal", nominal}};
  };
  const Value multisine{{"type", "multisine"}, {"rms", 150.0}, {"low_Hz", 2.0},
                        {"high_Hz", 1700.0},   {"lines", 400}, {"seed", 3}};
  const Value slow{{"type", "sine_sum"},
                   {"amplitudes", Value::Array{120.0}},
                   {"frequencies_Hz", Value::Array{0.9}},
                   {"phases_rad", Value::Array{0.0}}};
  return {"four_masses", "four_masses.toml",
          Value{{"run", Value{{"duration_s", duration_s}}},
                {"plant", Value{{"type", "drive_line"},
                                {"nominal_torque_Nm", 100.0},
                                {"inertia", Value{{"I1", 2.4}, {"I2", 2.4}, {"I3", 0.137}, {"I4", 0.081}}},
                                {"shaft", Value{{"k1", shaft("I1", "I2", 8.9e6, 28.4)},
                                                {"k2", shaft("I2", "I3", 5.76e6, 5.5)},
                                                {"k3", shaft("I3", "I4", 6.37e6, 12.5)}}},
                                {"torque", Value{{"T", Value{{"on", "I1"}}}}}}},
                {"input",
                 Value{{"T", Value{{"to", "plant.T"},
                                   {"unit", "N m"},
                                   {"nominal", 150.0},
                                   {"source", Value{{"type", "sum"}, {"sources", Value::Array{multisine, slow}}}}}}}},
                {"output", Value{{"T_shaft", output("plant.k3.torque", "N m", 20.0)},
                                 {"omega_1", output("plant.I1.speed", "rad/s", 1.0)},
                                 {"omega_4", output("plant.I4.speed", "rad/s", 1.0)}}}}};
}

}  // namespace dynoproof::estimation
