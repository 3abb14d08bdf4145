// Plans for tests, written as nested initialiser lists instead of TOML.
#pragma once

#include <string>
#include <utility>

#include "model/plan.h"

namespace dynoproof::testing {

inline Plan PlanOf(Value root, std::string id = "test") { return {std::move(id), "test.toml", std::move(root)}; }

/// A linear shaft between two bodies.
inline Value Shaft(const char* from, const char* to, double stiffness, double damping) {
  return {{"between", Value::Array{from, to}}, {"stiffness_Nm_per_rad", stiffness}, {"damping_Nms_per_rad", damping}};
}

/// The heavy-duty line as a straight chain of five inertias (thesis Table A.1, setup 1), its first three being a run,
/// with one load, one input and two outputs.
inline Plan LumpedPlan() {
  return PlanOf(Value{
      {"run", Value{{"duration_s", 1.0}}},
      {"plant", Value{{"type", "drive_line"},
                      {"inertia", Value{{"I1", 25.082}, {"I2", 6.352}, {"I3", 1.572}, {"I4", 0.159}, {"I5", 0.140}}},
                      {"shaft", Value{{"k1", Shaft("I1", "I2", 60.99e6, 850.4)},
                                      {"k2", Shaft("I2", "I3", 17.99e6, 800.0)},
                                      {"k3", Shaft("I3", "I4", 3.36e6, 0.0)},
                                      {"k4", Shaft("I4", "I5", 6.28e6, 0.0)}}},
                      {"load", Value{{"fan", Value{{"on", "I1"}, {"law", "viscous"}, {"b_Nms_per_rad", 0.5}}}}},
                      {"torque", Value{{"T_airgap", Value{{"on", "I1"}}}}},
                      {"run", Value{{"R", Value{{"inertias", Value::Array{"I1", "I2", "I3"}}}}}}}},
      {"input", Value{{"T_airgap", Value{{"to", "plant.T_airgap"},
                                         {"unit", "N m"},
                                         {"nominal", 1000.0},
                                         {"source", Value{{"type", "constant"}, {"value", 1.0}}},
                                         {"actuator", Value::Array{Value{{"type", "gain"}, {"gain", 1.0}}}}}}}},
      {"output", Value{{"T_shaft", Value{{"of", "plant.k4.torque"},
                                         {"sensor", Value::Array{Value{{"type", "gain"}, {"gain", 1.0}},
                                                                 Value{{"type", "noise"}, {"std", 0.1}}}}}},
                       {"omega_1", Value{{"of", "plant.I1.speed"}}}}}});
}

/// The same test bed with its soft rotor (Table A.5, setup 1).
inline Plan SoftPlan() {
  return PlanOf(Value{
      {"run", Value{{"duration_s", 1.0}}},
      {"plant", Value{{"type", "drive_line"},
                      {"rotor", Value{{"I1", Value{{"inertia_kg_m2", 25.308},
                                                   {"stiffness_Nm_per_rad", 16.5e6},
                                                   {"damping_Nms_per_rad", 85.6},
                                                   {"slices", 100}}}}},
                      {"inertia", Value{{"I4", 0.235}, {"I5", 0.159}}},
                      {"shaft", Value{{"k3", Shaft("I1", "I4", 5.1e6, 18.2)}, {"k4", Shaft("I4", "I5", 7.99e6, 23.0)}}},
                      {"torque", Value{{"T_airgap", Value{{"on", "I1"}, {"slices", Value::Array{6, 95}}}}}}}},
      {"input",
       Value{{"T_airgap", Value{{"to", "plant.T_airgap"}, {"source", Value{{"type", "constant"}, {"value", 1.0}}}}}}},
      {"output", Value{{"T_shaft", Value{{"of", "plant.k4.torque"}}}}}});
}

/// Three inertias, the second shaft with play.
inline Plan PlayPlan() {
  return PlanOf(Value{{"run", Value{{"duration_s", 0.2}}},
                      {"plant", Value{{"type", "drive_line"},
                                      {"nominal_torque_Nm", 10.0},
                                      {"inertia", Value{{"I1", 0.05}, {"I2", 6e-3}, {"I3", 3e-3}, {"I4", 3e-3}}},
                                      {"shaft", Value{{"k1", Shaft("I1", "I2", 1e4, 0.1)},
                                                      {"k2", Value{{"between", Value::Array{"I2", "I3"}},
                                                                   {"law", "phase_plane"},
                                                                   {"stiffness_Nm_per_rad", 15e3},
                                                                   {"damping_Nms_per_rad", 0.5},
                                                                   {"half_gap_rad", 0.01}}},
                                                      {"k3", Shaft("I3", "I4", 2e4, 0.1)}}},
                                      {"torque", Value{{"T_1", Value{{"on", "I4"}}}}}}},
                      {"input", Value{{"T_1", Value{{"to", "plant.T_1"},
                                                    {"source", Value{{"type", "jump"},
                                                                     {"times_s", Value::Array{0.0, 0.06}},
                                                                     {"values", Value::Array{-1.0, 1.0}}}}}}}},
                      {"output", Value{{"w3", Value{{"of", "plant.I3.speed"}}},
                                       {"w1", Value{{"of", "plant.I1.speed"}}},
                                       {"twist", Value{{"of", "plant.k2.twist"}}},
                                       {"T", Value{{"of", "plant.k2.torque"}}}}}});
}

/// Two inertias joined by a Kelvin-Voigt coupling (thesis Table 4.1, all on either side lumped).
inline Plan CouplingPlan() {
  Value coupling = Shaft("A", "B", 94e3, 618.0);
  coupling["law"] = Value("kelvin_voigt");
  return PlanOf(Value{
      {"run", Value{{"duration_s", 1.0}}},
      {"plant", Value{{"type", "drive_line"},
                      {"inertia", Value{{"A", 17.68}, {"B", 597.7}}},
                      {"shaft", Value{{"coupling", std::move(coupling)}}},
                      {"torque", Value{{"T_c", Value{{"on", "A"}}}}}}},
      {"input", Value{{"T_c", Value{{"to", "plant.T_c"}, {"source", Value{{"type", "constant"}, {"value", 1000.0}}}}}}},
      {"output", Value{{"T", Value{{"of", "plant.coupling.torque"}}}, {"w_A", Value{{"of", "plant.A.speed"}}}}}});
}

inline Value ConstantInput(const char* to, double value) {
  return {{"to", to}, {"source", Value{{"type", "constant"}, {"value", value}}}};
}

/// The air path of a single-cylinder engine with the data of scenarios/pressure/_charge_air.toml.
inline Plan AirPlan() {
  return PlanOf(
      Value{{"run", Value{{"duration_s", 10.0}, {"period_s", 0.02}}},
            {"plant", Value{{"type", "charge_air"},
                            {"volume", Value{{"V_1", Value{{"volume_m3", 0.4}, {"start_pressure_Pa", 3.5e5}}},
                                             {"V_2", Value{{"volume_m3", 1.2}, {"start_pressure_Pa", 5.0e5}}}}},
                            {"flap", Value{{"1", Value{{"area_offset_m2", 1e-5}, {"area_span_m2", 9e-3}}},
                                           {"2", Value{{"area_offset_m2", 1e-5}, {"area_span_m2", 4.5e-3}}}}}}},
            {"input", Value{{"u_1", ConstantInput("plant.u_1", 25.0)},
                            {"u_2", ConstantInput("plant.u_2", 30.0)},
                            {"q_e", ConstantInput("plant.q_e", 0.75)},
                            {"q_c", ConstantInput("plant.q_c", 1.3)}}},
            {"output", Value{{"p_ch", Value{{"of", "plant.p_ch"}, {"nominal", 1e5}}},
                             {"p_s", Value{{"of", "plant.p_s"}, {"nominal", 1e5}}}}}});
}

/// The fuel gas supply with the data of scenarios/pressure/_fuel_gas.toml.
inline Plan GasPlan() {
  return PlanOf(
      Value{{"run", Value{{"duration_s", 1.0}, {"period_s", 1e-3}}},
            {"plant", Value{{"type", "fuel_gas"},
                            {"mass_kg", 0.5},
                            {"membrane_area_m2", 0.02},
                            {"preload_N", 200.0},
                            {"stiffness_N_per_m", 2e4},
                            {"damping_Ns_per_m", 400.0},
                            {"valve", Value{{"v_g", Value{{"area_slope_m", 0.02}, {"flow_at_rest_kg_per_s", 0.03}}}}},
                            {"reservoir", Value{{"res", Value{{"pressure_Pa", 10e5}}}}},
                            {"volume", Value{{"V", Value{{"volume_m3", 0.02}}}}}}},
            {"input", Value{{"p_mem", ConstantInput("plant.p_mem", 5e5)}, {"q_e", ConstantInput("plant.q_e", 0.02)}}},
            {"output", Value{{"p_g", Value{{"of", "plant.p_g"}, {"nominal", 1e5}}},
                             {"q_g", Value{{"of", "plant.q_g"}, {"nominal", 0.01}}},
                             {"x", Value{{"of", "plant.x"}, {"nominal", 1e-3}}}}}});
}

/// Two bodies on a shaft under a chirp, as a drive line.
inline Plan TwoBodiesPlan() {
  return PlanOf(Value{
      {"run", Value{{"duration_s", 0.5}, {"period_s", 1e-4}}},
      {"plant", Value{{"type", "drive_line"},
                      {"inertia", Value{{"A", 0.2}, {"B", 0.3}}},
                      {"shaft", Value{{"k", Value{{"between", Value::Array{"A", "B"}},
                                                  {"stiffness_Nm_per_rad", 500.0},
                                                  {"damping_Nms_per_rad", 0.5}}}}},
                      {"load", Value{{"bearing", Value{{"on", "B"}, {"law", "viscous"}, {"b_Nms_per_rad", 0.1}}}}},
                      {"torque", Value{{"T", Value{{"on", "A"}}}}}}},
      {"input", Value{{"T", Value{{"to", "plant.T"},
                                  {"unit", "N m"},
                                  {"nominal", 5.0},
                                  {"source", Value{{"type", "chirp"},
                                                   {"amplitude", 5.0},
                                                   {"start_Hz", 1.0},
                                                   {"end_Hz", 30.0},
                                                   {"duration_s", 0.5}}}}}}},
      {"output", Value{{"T_shaft", Value{{"of", "plant.k.torque"}, {"nominal", 5.0}}},
                       {"w_B", Value{{"of", "plant.B.speed"}, {"nominal", 5.0}}}}}});
}

/// The same, its equations written down.
inline Plan EquationsPlan() {
  Plan plan = TwoBodiesPlan();
  plan.root["plant"] =
      Value{{"type", "equations"},
            {"parameter", Value{{"I_A", 0.2}, {"I_B", 0.3}, {"k", 500.0}, {"c", 0.5}}},
            {"input", Value{{"T", Value{{"unit", "N m"}, {"nominal", 5.0}}}}},
            {"define", Value{{"T_k", "k*(A - B) + c*rate"}, {"rate", "w_A - w_B"}}},
            {"state", Value{{"A", Value{{"unit", "rad"}, {"rate", "w_A"}}},
                            {"B", Value{{"unit", "rad"}, {"rate", "w_B"}}},
                            {"w_A", Value{{"unit", "rad/s"}, {"rate", "(T - T_k)/I_A"}}},
                            {"w_B", Value{{"unit", "rad/s"}, {"rate", "(T_k + load_B)/I_B"}}}}},
            {"output", Value{{"T_shaft", Value{{"unit", "N m"}, {"value", "T_k"}}}}},
            {"body", Value{{"B", Value{{"position", "B"}, {"speed", "w_B"}}}}},
            {"load", Value{{"bearing", Value{{"on", "B"}, {"law", "viscous"}, {"b_Nms_per_rad", 0.1}}}}}};
  plan.root["output"]["T_shaft"]["of"] = Value("plant.T_shaft");
  plan.root["output"]["w_B"]["of"] = Value("plant.w_B");
  return plan;
}

/// A plan without any mechanics.
inline Plan PressurePlan() {
  return PlanOf(Value{{"plant", Value{{"type", "charge_air"}, {"inertia", Value{{"I1", 1.0}}}}}});
}

}  // namespace dynoproof::testing
