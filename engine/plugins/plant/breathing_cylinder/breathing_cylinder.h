// Part `breathing_cylinder`: the single-cylinder engine of the test bed over its crank angle, thesis Sec. 6.1.2, Fig. 6.2:
// it breathes from a charge pipe into an exhaust pipe, gets its gas in one injection a cycle, burns and is measured.
//
//   m_j' = flows through the valves -+ what burns      U' = sum h q + Q_w + H_u m_fuel x'(phi) w - p V'
//   fuel' = A(phi) p_g/sqrt(R theta) Psi(p_g/p_ch) + s m_wanted y'(phi) w - m_fuel x'(phi) w
// Valves, wall heat and gases are those of engine_bank: with the same pipes the two trap the same charge. The gas valve is
// timed for the pressures that are wanted; what it lets pass depends on those that are. Fuel takes no room and brings no
// heat before it burns, as in the bank; burning turns all air of the charge into exhaust gas.
//
// Measured once a cycle, as the exhaust opens, and held: p_evo, work of the closed part against the crankcase, air ratio,
// knock, NOx. That and what a closing intake traps is noticed as an interval ends (guard -1) and carried back to the
// angle of the valve.
//
// States: charge, fuel, work since the start, what was trapped, what was measured. Inputs and outputs below.
#pragma once

#include "model/registry.h"
#include "plugins/physics/cylinder_geometry.h"
#include "plugins/physics/gas_flow.h"
#include "plugins/plant/breathing_cylinder/burn.h"
#include "plugins/plant/fired_cylinder/cycle_indices.h"

namespace dynoproof {

class BreathingCylinder : public Component {
 public:
  struct Params {
    CylinderGeometry geometry;
    std::vector<std::pair<std::string, ValveParams>> valves;
    GasParams gases;
    CycleIndices indices;
    double wall_theta_K = 450.0, wall_factor = 1.0, crankcase_pressure_Pa = 101300.0, heating_value_J_per_kg = 47e6,
           heat_share = 1.0, heat_at_deg = 10.0, burn_deg = 40.0, laminar_ratio = 0.01, injection_area_m2 = 0.0,
           injection_opens_deg = 0.0, injection_edge_deg = 10.0, prechamber_share = 0.0, fuel_R_J_per_kg_K = 518.0,
           fuel_theta_K = 300.0, start_p_evo_Pa = 0.0, start_work_J = 0.0;
    void Visit(auto& v) {
      geometry.Visit(v);
      v.Required("valves", valves, Any(), "intake and exhaust, as in the bank");
      v.Required("injection_area_m2", injection_area_m2, Positive(), "effective area of the open gas valve");
      v.Required("injection_opens_deg", injection_opens_deg, Between(0.0, 360.0, "deg"),
                 "crank angle, behind the end of scavenging");
      v.Optional("injection_edge_deg", injection_edge_deg, Between(1.0, 90.0, "deg"),
                 "crank angle over which it opens, and closes");
      v.Optional("prechamber_share", prechamber_share, Between(0.0, 0.5),
                 "of the fuel, that scavenges the pre-chamber from a line of its own");
      v.Optional("fuel_R_J_per_kg_K", fuel_R_J_per_kg_K, Positive(), "specific gas constant of the fuel gas");
      v.Optional("fuel_theta_K", fuel_theta_K, Positive(), "its temperature");
      gases.Visit(v);
      v.Optional("wall_theta_K", wall_theta_K, Positive(), "temperature of the walls");
      v.Optional("wall_factor", wall_factor, NonNegative("1"), "factor on the heat transfer coefficient; 0: none");
      v.Optional("crankcase_pressure_Pa", crankcase_pressure_Pa, NonNegative(), "pressure underneath the piston");
      v.Optional("heating_value_J_per_kg", heating_value_J_per_kg, Positive(), "lower heating value H_u");
      v.Optional("heat_share", heat_share, Between(0.0, 1.0), "of the fuel's heat that burning gives to the gas");
      v.Optional("heat_at_deg", heat_at_deg, Between(0.0, 90.0, "deg"), "half is burnt here without retard");
      v.Optional("burn_deg", burn_deg, Between(0.5, 120.0, "deg"), "crank angle from the first to the last heat");
      v.Optional("laminar_ratio", laminar_ratio, Between(1e-6, 0.5), "as in the bank");
      indices.Visit(v);
      v.Required("start_p_evo_Pa", start_p_evo_Pa, Positive(), "p_evo that was measured before t = 0");
      v.Required("start_work_J", start_work_J, Any(), "work that was measured then; NOx was at its limit");
    }
    void Check(Faults& faults) const;
  };
  enum Input_ {
    kAngle,
    kSpeed,
    kChargePressure,
    kChargeTheta,
    kExhaustPressure,
    kExhaustTheta,
    kExhaustAir,
    kGasPressure,
    kChargeReference,
    kGasReference,
    kFuel,
    kRetard
  };
  enum Output_ {
    kPressure,
    kTorque,
    kAirFlow,
    kFuelFlow,
    kExhaustAirFlow,
    kExhaustGasFlow,
    kExhaustEnthalpy,
    kMass,
    kEnergy,
    kEnergyIn,
    kTrappedAir,
    kTrappedTheta,
    kTrappedPressure,
    kTrappedFuel,
    kEvoPressure,
    kWork,
    kAirRatio,
    kKnock,
    kNox,
    kPrechamberFlow
  };
  static PluginInfo Info();
  explicit BreathingCylinder(const Params& params);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int in, int out) const override {
    return in != kRetard && (out < kTrappedAir || out == kPrechamberFlow);
  }
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;
  void OnEvent(const View& view, int guard, std::span<double> states, std::span<int> modes) const override;

 private:
  /// All that crosses the border of the cylinder at an instant.
  struct Exchange {
    mechanics::GasState gas;
    mechanics::Charge intake, exhaust;  // into the cylinder, out of it
    double fuel, burn;                  // through the gas valve [kg/s], share of the trapped fuel that burns [1/s]
    double heat, power;                 // from walls and combustion [W]; to the piston [W]
    double lever;                       // dV/dphi [m^3/rad]
  };
  Exchange At(const View& view) const;
  double FuelFlow(const View& view, double phi) const;
  double PrechamberFlow(const View& view) const;
  double VolumeAt(double angle) const { return p_.geometry.Volume(angle); }
  /// What the closing intake traps, and what the opening exhaust shows, at an angle up to a tick behind it.
  void Trap(const View& view, std::span<double> states) const;
  void Measure(const View& view, std::span<double> states) const;

  Params p_;
  mechanics::GasPair gases_;
  mechanics::LaminarFlowFunction psi_;
  mechanics::SliderCrank crank_;
  double piston_area_, clearance_;
  mechanics::ValveTrain intake_, exhaust_;
  mechanics::InjectionValve injection_;
  mechanics::Gas fuel_gas_;
  double closes_, opens_, volume_closed_, volume_open_;  // intake closes, exhaust opens
};

}  // namespace dynoproof
