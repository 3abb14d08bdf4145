// Motion through a gap: when the sides of a shaft with play meet, how fast and how hard.
#pragma once

#include <string>
#include <vector>

#include "base/status.h"
#include "model/registry.h"
#include "sim/simulate.h"

namespace dynoproof {

/// The two sides of a gap meet, at the other side than before or after more than 1 ms apart.
struct Impact {
  double time_s;
  int side;                        // +1: twist > 0
  double approach_rad_per_s;       // difference of the mean speeds of the line's two parts (by inertia) just before
  double speed_rad_per_s;          // mean speed of the part behind the shaft just before
  double peak_torque_Nm = 0.0;     // largest torque of the shaft until the next impact
  double rebound_rad_per_s = 0.0;  // mean speed of the part behind when it first leaves for more than 1 ms
};

struct ContactCourse {
  Samples samples;  // outputs of the scenario first, then what this analysis adds
  std::vector<Impact> impacts;
};

/// Simulates `plan` (effects applied) and follows the contacts of [plant.shaft.`shaft`], a shaft with half_gap_rad.
Result<ContactCourse> FollowContacts(const Plan& plan, const std::string& shaft, const std::string& solver,
                                     const Registry& registry, const Records& records);

}  // namespace dynoproof
