// Effects on inputs and outputs: each adds one stage to the chain of an actuator or sensor.
//
// Places: input:NAME for every [input.NAME], output:NAME for every [output.NAME]. An actuator's stage goes to the end
// of its chain, a sensor's before the sampled stages (noise, quantisation), which must stay last.
#pragma once

#include <memory>

#include "model/effect.h"

namespace dynoproof::effects {

std::unique_ptr<Effect> ActuatorLag();
std::unique_ptr<Effect> ActuatorDelay();
std::unique_ptr<Effect> ActuatorGain();
std::unique_ptr<Effect> ActuatorSaturation();
std::unique_ptr<Effect> ActuatorDeadZone();
std::unique_ptr<Effect> ActuatorHarmonic();

std::unique_ptr<Effect> SensorGain();
std::unique_ptr<Effect> SensorOffset();
std::unique_ptr<Effect> SensorDelay();
std::unique_ptr<Effect> SensorLag();
std::unique_ptr<Effect> SensorDrift();
std::unique_ptr<Effect> SensorRectified();

}  // namespace dynoproof::effects
