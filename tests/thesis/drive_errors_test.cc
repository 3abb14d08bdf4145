// Errors of the drive in the loop of chapter 5: switched on with nothing, they leave a run as it is, bit by bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/thesis/shaft_torque.h"

namespace dynoproof {
namespace {

/// The shaft torque of suppression/adaptive_machine with these changes.
std::vector<double> ShaftTorque(std::vector<std::string> changes) {
  changes.insert(changes.end(), {"check=[]", "run.duration_s=0.6"});
  return ShaftTorqueOf("suppression/adaptive_machine", changes);
}

/// Inverter and current sensor in the loop; `sensor`: the stages of the sensor.
std::vector<std::string> Drive(const std::string& dead_time_s, const std::string& sensor) {
  return {"control.inverter={ type = \"inverter\", dc_link_V = 630.0, dead_time_s = " + dead_time_s +
              ", inputs = { u_alpha = \"control.machine.u_alpha\", u_beta = \"control.machine.u_beta\", i_alpha = "
              "\"part.machine.i_alpha\", i_beta = \"part.machine.i_beta\" } }",
          "part.machine.inputs={ u_alpha = \"control.inverter.u_alpha\", u_beta = \"control.inverter.u_beta\", speed = "
          "\"plant.I1.left.speed\" }",
          "output.i_alpha={ of = \"part.machine.i_alpha\", unit = \"A\", nominal = 1000.0, description = \"current\", "
          "sensor = [{ type = " +
              sensor + " }] }",
          "control.machine.inputs={ torque = \"control.core.T_ref\", i_alpha = \"output.i_alpha\", i_beta = "
          "\"part.machine.i_beta\", speed = \"output.omega_1\" }"};
}

double LargestDistance(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0.0 : INFINITY;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(DriveErrors, OfNothingLeaveTheRunAsItIsBitByBit) {
  const std::vector<double> plain = ShaftTorque({});
  ASSERT_GT(plain.size(), 5000u);
  EXPECT_EQ(LargestDistance(ShaftTorque(Drive("0.0", "\"offset\", offset = 0.0")), plain), 0.0);
  // A gain is carried with the line and the machine, whose sums then have another order: round-off of some 10 N m.
  EXPECT_LT(LargestDistance(ShaftTorque(Drive("0.0", "\"gain\", gain = 1.0")), plain), 1e-10);
  EXPECT_GT(LargestDistance(ShaftTorque(Drive("3e-6", "\"offset\", offset = 0.0")), plain), 1e-3);
  EXPECT_GT(LargestDistance(ShaftTorque(Drive("0.0", "\"offset\", offset = 1.0")), plain), 1e-3);
  EXPECT_GT(LargestDistance(ShaftTorque(Drive("0.0", "\"gain\", gain = 1.01")), plain), 1e-3);
}

}  // namespace
}  // namespace dynoproof
