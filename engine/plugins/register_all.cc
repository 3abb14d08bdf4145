// Every built-in plugin, one sorted line each: explicit, because linkers drop what registers itself.
#include "model/registry.h"
#include "plugins/actuator/linear_stages/linear_stages.h"
#include "plugins/actuator/play/play.h"
#include "plugins/actuator/rate_limited_lag/rate_limited_lag.h"
#include "plugins/actuator/static_stages/static_stages.h"
#include "plugins/control/back_pressure_control/back_pressure_control.h"
#include "plugins/control/charge_air_control/charge_air_control.h"
#include "plugins/control/classical_core/classical_core.h"
#include "plugins/control/core_10k/core_10k.h"
#include "plugins/control/encoder/encoder.h"
#include "plugins/control/engine_control/engine_control.h"
#include "plugins/control/indication/indication.h"
#include "plugins/control/inverter/inverter.h"
#include "plugins/control/pressure_pi/pressure_pi.h"
#include "plugins/control/rotor_flux_control/rotor_flux_control.h"
#include "plugins/control/speed_pi/speed_pi.h"
#include "plugins/effect/contact_changes.h"
#include "plugins/effect/coupling_effects.h"
#include "plugins/effect/load_effects.h"
#include "plugins/effect/parameter_changes.h"
#include "plugins/effect/pressure_effects.h"
#include "plugins/effect/stage_effects.h"
#include "plugins/effect/structure_changes.h"
#include "plugins/law/backlash/backlash.h"
#include "plugins/law/dahl/dahl.h"
#include "plugins/law/dry_friction/dry_friction.h"
#include "plugins/law/hydrodynamic_coupling/hydrodynamic_coupling.h"
#include "plugins/law/loads/loads.h"
#include "plugins/law/springs/springs.h"
#include "plugins/plant/back_pressure/back_pressure.h"
#include "plugins/plant/balance/balance.h"
#include "plugins/plant/breathing_cylinder/breathing_cylinder.h"
#include "plugins/plant/charge_air/charge_air.h"
#include "plugins/plant/drive_line/drive_line.h"
#include "plugins/plant/engine_bank/engine_bank.h"
#include "plugins/plant/equations/equations.h"
#include "plugins/plant/fired_cylinder/fired_cylinder.h"
#include "plugins/plant/firing_order/firing_order.h"
#include "plugins/plant/fmu/fmu.h"
#include "plugins/plant/fuel_gas/fuel_gas.h"
#include "plugins/plant/induction_machine/induction_machine.h"
#include "plugins/plant/moved_body/moved_body.h"
#include "plugins/plant/power_train/power_train.h"
#include "plugins/plant/single_cylinder/single_cylinder.h"
#include "plugins/plant/volumetric_engine/volumetric_engine.h"
#include "plugins/sensor/sampled_stages/sampled_stages.h"
#include "plugins/sensor/static_stages/static_stages.h"
#include "plugins/source/chirp/chirp.h"
#include "plugins/source/levels/levels.h"
#include "plugins/source/noise/noise.h"
#include "plugins/source/replay/replay.h"
#include "plugins/source/sum/sum.h"
#include "plugins/source/tones/tones.h"

namespace dynoproof {
namespace {

void RegisterActuators(Registry& registry) {
  registry.Add<stages::AsActuator<stages::Delay>>();
  registry.Add<stages::AsActuator<stages::FirstOrderLag>>();
  registry.Add<stages::AsActuator<stages::Gain>>();
  registry.Add<stages::DeadZone>();
  registry.Add<stages::Harmonic>();
  registry.Add<stages::Play>();
  registry.Add<stages::RateLimitedLag>();
  registry.Add<stages::Saturation>();
}

void RegisterControls(Registry& registry) {
  registry.Add<controls::BackPressureControl>();
  registry.Add<controls::ChargeAirControl>();
  registry.Add<controls::ChargeAirLegacy>();
  registry.Add<controls::ClassicalCore>();
  registry.Add<controls::Core10k>();
  registry.Add<controls::Encoder>();
  registry.Add<controls::EngineGovernor>();
  registry.Add<controls::Inverter>();
  registry.Add<controls::GasReference>();
  registry.Add<controls::Indication>();
  registry.Add<controls::KnockControl>();
  registry.Add<controls::NoxControl>();
  registry.Add<controls::PressurePi>();
  registry.Add<controls::RotorFluxControl>();
  registry.Add<controls::SpeedPi>();
  registry.Add<controls::VoltageControl>();
}

void RegisterEffects(Registry& registry) {
  registry.Add(effects::ActuatorDeadZone());
  registry.Add(effects::ActuatorDelay());
  registry.Add(effects::ActuatorGain());
  registry.Add(effects::ActuatorHarmonic());
  registry.Add(effects::ActuatorHysteresis());
  registry.Add(effects::ActuatorLag());
  registry.Add(effects::ActuatorSaturation());
  registry.Add(effects::AsymmetricFriction());
  registry.Add(effects::BacklashEffect());
  registry.Add(effects::ConstantLoad());
  registry.Add(effects::ContactFreeDamping());
  registry.Add(effects::CoulombFriction());
  registry.Add(effects::CubicStiffness());
  registry.Add(effects::DahlFriction());
  registry.Add(effects::DampingChange());
  registry.Add(effects::DistributedInertia());
  registry.Add(effects::FlowAreaError());
  registry.Add(effects::GapChange());
  registry.Add(effects::InertiaChange());
  registry.Add(effects::Leakage());
  registry.Add(effects::OilDynamics());
  registry.Add(effects::ParameterChange());
  registry.Add(effects::QuadraticDrag());
  registry.Add(effects::SensorDelay());
  registry.Add(effects::SensorDrift());
  registry.Add(effects::SensorGain());
  registry.Add(effects::SensorLag());
  registry.Add(effects::SensorOffset());
  registry.Add(effects::SensorRectified());
  registry.Add(effects::SeriesElasticity());
  registry.Add(effects::StiffnessChange());
  registry.Add(effects::StribeckFriction());
  registry.Add(effects::SupplyDroop());
  registry.Add(effects::TorqueRipple());
  registry.Add(effects::ValveStiction());
  registry.Add(effects::ViscosityDrift());
  registry.Add(effects::ViscousFriction());
}

void RegisterLaws(Registry& registry) {
  registry.Add<laws::Asymmetric>();
  registry.Add<laws::ConstantLoad>();
  registry.Add<laws::Coulomb>();
  registry.Add<laws::CubicSpring>();
  registry.Add<laws::Dahl>();
  registry.Add<laws::DampedDeadZone>();
  registry.Add<laws::DampedPhasePlane>();
  registry.Add<laws::DampedRevisedDeadZone>();
  registry.Add<laws::DeadZone>();
  registry.Add<laws::FullStateBacklash>();
  registry.Add<laws::PhasePlane>();
  registry.Add<laws::RevisedDeadZone>();
  registry.Add<laws::KelvinVoigt>();
  registry.Add<laws::OilCoupling>();
  registry.Add<laws::OilCouplingGeometry>();
  registry.Add<laws::QuadraticDrag>();
  registry.Add<laws::Ripple>();
  registry.Add<laws::SpringDamperLaw>();
  registry.Add<laws::Stribeck>();
  registry.Add<laws::Viscous>();
  registry.Add<laws::WarmingSpring>();
}

void RegisterPlants(Registry& registry) {
  registry.Add<BackPressure>();
  registry.Add<Balance>();
  registry.Add<BreathingCylinder>();
  registry.Add<ChargeAir>();
  registry.Add<DriveLine>();
  registry.Add<EngineBank>();
  registry.Add<Equations>();
  registry.Add<FiredCylinder>();
  registry.Add<FmuPlant>();
  registry.Add<FiringOrder>();
  registry.Add<FuelGas>();
  registry.Add<InductionMachine>();
  registry.Add<MovedBody>();
  registry.Add<PowerTrain>();
  registry.Add<ResistorLoad>();
  registry.Add<SingleCylinder>();
  registry.Add<VolumetricEngine>();
}

void RegisterSensors(Registry& registry) {
  registry.Add<stages::AsSensor<stages::Delay>>();
  registry.Add<stages::AsSensor<stages::FirstOrderLag>>();
  registry.Add<stages::AsSensor<stages::Gain>>();
  registry.Add<stages::Drift>();
  registry.Add<stages::Noise>();
  registry.Add<stages::Offset>();
  registry.Add<stages::Quantisation>();
  registry.Add<stages::Range>();
  registry.Add<stages::Rectified>();
}

void RegisterSources(Registry& registry) {
  registry.Add<sources::Chirp>();
  registry.Add<sources::Constant>();
  registry.Add<sources::Jump>();
  registry.Add<sources::Multisine>();
  registry.Add<sources::NoiseSource>();
  registry.Add<sources::Ramp>();
  registry.Add<sources::Replay>();
  registry.Add<sources::SineSum>();
  registry.Add<sources::Step>();
  registry.Add<sources::Sum>();
}

}  // namespace

void RegisterBuiltIns(Registry& registry) {
  RegisterActuators(registry);
  RegisterControls(registry);
  RegisterEffects(registry);
  RegisterLaws(registry);
  RegisterPlants(registry);
  RegisterSensors(registry);
  RegisterSources(registry);
}

}  // namespace dynoproof
