// Effects of the pressure plants charge_air and fuel_gas: leakage, flow_area_error, actuator_hysteresis,
// valve_stiction, supply_droop.
#pragma once

#include <memory>

#include "model/effect.h"

namespace dynoproof::effects {

std::unique_ptr<Effect> ActuatorHysteresis();
std::unique_ptr<Effect> FlowAreaError();
std::unique_ptr<Effect> Leakage();
std::unique_ptr<Effect> SupplyDroop();
std::unique_ptr<Effect> ValveStiction();

}  // namespace dynoproof::effects
