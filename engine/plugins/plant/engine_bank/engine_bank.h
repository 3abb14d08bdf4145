// Plant `engine_bank`: gas side of one bank of a multi-cylinder engine with two-stage turbocharging, thesis Sec. 6.1.3,
// (6.1): compressors and coolers, receiver with blow-off valve, cylinders, exhaust pipe, turbines.
//
//   ambient > C_lp > cooler > [between] > C_hp > cooler > [receiver] > cylinders > [exhaust] > T_hp > [middle] > T_lp
//   > ambient, [receiver] > blow-off valve > ambient
//
// States: masses of air and exhaust gas and internal energy of each volume and cylinder (physics/gas_exchange.h),
// kinetic energy of both rotors (power balance), what crossed the border, what was trapped when an intake last closed.
// Combustion is not modelled: as cylinder i passes the opening of its exhaust valves it takes the pressure `p_evo` that
// was measured (Fig. 6.3), its air and the fuel become exhaust gas. That, and what is trapped, is noticed when an
// interval of the run ends (guard -1), a tick late at most; the pressure is carried on to there by p V^chi = const.
//
// Inputs angle [rad], speed [rad/s] of the crankshaft, p_evo [Pa], fuel [kg per cycle and cylinder], blow_off [%].
// Outputs below. `torque` is that of the gas against ambient pressure while a valve is open, of all banks; the work of
// the closed part is measured and enters the power train. Balances: what is there less what was and crossed, over all
// that came in.
#pragma once

#include "model/registry.h"
#include "plugins/physics/cylinder_geometry.h"
#include "plugins/physics/gas_exchange.h"
#include "plugins/physics/gas_flow.h"
#include "plugins/plant/engine_bank/turbocharger.h"

namespace dynoproof {

class EngineBank : public Component {
 public:
  struct Volume {
    double volume_m3 = 0.0, start_pressure_Pa = 101300.0, start_theta_K = 300.0;
    void Visit(auto& v) {
      v.Required("volume_m3", volume_m3, Positive(), "volume");
      v.Optional("start_pressure_Pa", start_pressure_Pa, Positive(), "pressure at t = 0");
      v.Optional("start_theta_K", start_theta_K, Positive(), "temperature at t = 0");
    }
  };
  struct Turbocharger {
    double radius_m = 0.0, flow_max = 0.14, head_max = 0.7, compressor_efficiency = 0.8, turbine_area_m2 = 0.0,
           turbine_efficiency = 0.8, mechanical_efficiency = 0.97, inertia_kg_m2 = 0.0, start_speed_rad_per_s = 0.0,
           cooler_effectiveness = 0.9;
    void Visit(auto& v) {
      v.Required("radius_m", radius_m, Positive(), "radius of the compressor's wheel");
      v.Optional("flow_max", flow_max, Positive("1"), "flow coefficient without head");
      v.Optional("head_max", head_max, Positive("1"), "head coefficient without flow");
      v.Optional("compressor_efficiency", compressor_efficiency, Between(0.1, 1.0), "isentropic efficiency");
      v.Required("turbine_area_m2", turbine_area_m2, Positive(), "effective area of the turbine");
      v.Optional("turbine_efficiency", turbine_efficiency, Between(0.1, 1.0), "isentropic efficiency");
      v.Optional("mechanical_efficiency", mechanical_efficiency, Between(0.1, 1.0), "of the shaft");
      v.Required("inertia_kg_m2", inertia_kg_m2, Positive(), "inertia of the rotor");
      v.Optional("start_speed_rad_per_s", start_speed_rad_per_s, NonNegative(), "speed at t = 0");
      v.Optional("cooler_effectiveness", cooler_effectiveness, Between(0.0, 1.0), "of the cooler behind it");
    }
  };
  struct Params {
    int cylinders = 10, banks = 2;
    CylinderGeometry geometry;
    std::vector<std::pair<std::string, ValveParams>> valves;
    std::vector<std::pair<std::string, Volume>> volume;
    std::vector<std::pair<std::string, Turbocharger>> turbocharger;
    double blow_off_area_m2 = 0.0, wall_theta_K = 450.0, wall_factor = 1.0, coolant_theta_K = 315.0,
           ambient_pressure_Pa = 101300.0, ambient_theta_K = 298.0, laminar_ratio = 0.01;
    std::string trapped_of = "each";
    GasParams gases;
    void Visit(auto& v) {
      v.Optional("cylinders", cylinders, Between(1, 12), "of the bank, evenly spaced");
      v.Optional("banks", banks, Between(1, 4), "alike: `torque` counts them all, one is carried");
      geometry.Visit(v);
      v.Required("valves", valves, Any(), "[plant.valves.intake] and [plant.valves.exhaust]");
      v.Required("volume", volume, Any(), "[plant.volume.between], .receiver, .exhaust and .middle");
      v.Required("turbocharger", turbocharger, Any(), "[plant.turbocharger.low] and .high pressure");
      v.Optional("trapped_of", trapped_of, std::vector<std::string>{"each", "first"},
                 "cylinder whose charge is told: each as its intake closes, or the first, once a cycle");
      v.Optional("blow_off_area_m2", blow_off_area_m2, NonNegative(), "effective area of the open blow-off valve");
      v.Optional("wall_theta_K", wall_theta_K, Positive(), "temperature of the cylinders' walls");
      v.Optional("wall_factor", wall_factor, NonNegative("1"), "factor on the heat transfer coefficient; 0: none");
      v.Optional("coolant_theta_K", coolant_theta_K, Positive(), "temperature of the coolers' water");
      v.Optional("ambient_pressure_Pa", ambient_pressure_Pa, Positive(), "pressure outside");
      v.Optional("ambient_theta_K", ambient_theta_K, Positive(), "temperature outside");
      gases.Visit(v);
      v.Optional("laminar_ratio", laminar_ratio, Between(1e-6, 0.5),
                 "flow is laminar for pressure ratios below 1 + this");
    }
    void Check(Faults& faults) const;
  };
  enum Output_ {
    kChargePressure,
    kChargeTheta,
    kExhaustPressure,
    kExhaustTheta,
    kSpeedLow,
    kSpeedHigh,
    kTorque,
    kCylinderPressure,
    kTrappedAir,
    kTrappedTheta,
    kTrappedPressure,
    kTrappedFuel,
    kAirFlow,
    kBlowOffFlow,
    kMassBalance,
    kEnergyBalance,
    kExhaustAir
  };
  static PluginInfo Info();
  static PlantTraits Traits();
  explicit EngineBank(const Params& params);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int in, int out) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;
  void OnEvent(const View& view, int guard, std::span<double> states, std::span<int> modes) const override;

 private:
  /// Where a crank stands: its angle within the cycle, sine and cosine.
  struct Crank {
    double phi, sine, cosine;
  };
  static Crank CrankAt(double angle);
  /// Of cylinder i, when the first one's is `first`.
  Crank CrankOf(const Crank& first, int i) const {
    const Crank& by = offset_[i];
    const double phi = first.phi + by.phi;
    return {phi < mechanics::kCycle ? phi : phi - mechanics::kCycle, first.sine * by.cosine + first.cosine * by.sine,
            first.cosine * by.cosine - first.sine * by.sine};
  }
  bool Closed(const Crank& crank) const;
  double VolumeAt(double angle) const;
  mechanics::GasState VolumeState(std::span<const double> states, int volume) const;
  mechanics::Charge TotalOf(std::span<const double> states) const;
  double BlowOffArea(double percent) const;

  Params p_;
  mechanics::GasPair gases_;
  mechanics::GasState ambient_;
  mechanics::LaminarFlowFunction psi_;
  mechanics::SliderCrank crank_;
  double piston_area_, clearance_, volume_m3_[4];
  Volume start_[4];
  mechanics::ValveTrain intake_, exhaust_;
  double closed_begin_, closed_duration_;  // part of the cycle with all valves closed
  double begin_[2];                        // where mode 0 counts a cycle, opening exhaust, and mode 1, closed intake
  std::vector<Crank> offset_;              // of the cylinders to the first
  Turbocharger charger_[2];
  mechanics::Compressor compressor_[2];
  mechanics::Turbine turbine_[2];
};

}  // namespace dynoproof
