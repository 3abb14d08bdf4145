#include "plugins/plant/fuel_gas/fuel_gas.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "plugins/plant/separating_flows.h"

namespace dynoproof {
namespace {

/// A law whose "twist" is a position or a pressure and whose "torque" is a flow or a force: what the linear part leaves
/// to a channel.
class ChannelLaw : public Law {
 public:
  using Function = std::function<double(double)>;
  ChannelLaw(Function function, double linear) : function_(std::move(function)), linear_(linear) {}
  SpringDamper linear() const override { return {linear_, 0.0}; }
  double Torque(const LawView& view) const override { return function_(view.twist); }

 private:
  Function function_;
  double linear_;
};

/// The straight line through (x, y) at `at`, held outside.
double Along(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (!(at > x.front())) return y.front();
  if (at >= x.back()) return y.back();
  const std::size_t i = std::upper_bound(x.begin(), x.end(), at) - x.begin();
  return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1]);
}

enum State { kPosition, kSpeed, kPressure };

}  // namespace

void FuelGas::Valve::Check(Faults& faults) const {
  if (law == "linear") {
    if (!(area_slope_m > 0.0)) faults.At("area_slope_m", "a valve that does not open", "area_slope_m > 0");
    return;
  }
  if (positions_m.size() < 2 || positions_m.size() != areas_m2.size()) {
    faults.At("areas_m2", fmt::format("{} positions and {} areas", positions_m.size(), areas_m2.size()),
              "as many areas as positions, at least two");
    return;
  }
  for (const auto& [key, values] : {std::pair("positions_m", &positions_m), std::pair("areas_m2", &areas_m2)}) {
    if (std::adjacent_find(values->begin(), values->end(), std::greater_equal<>()) != values->end()) {
      faults.At(key, "the values do not rise", "each larger than the one before");
    }
  }
}

void FuelGas::Params::Check(Faults& faults) const {
  const auto only = [&faults](const char* section, const auto& entries, const char* name) {
    if (entries.size() == 1 && entries[0].first == name) return;
    faults.At(section, fmt::format("the fuel gas supply has one entry here, \"{}\"", name),
              fmt::format("write [plant.{}.{}]", section, name));
  };
  only("valve", valve, "v_g");
  only("reservoir", reservoir, "res");
  only("volume", volume, "V");
  if (carried == "stepped" && valve.size() == 1 && valve[0].second.friction_N > 0.0) {
    faults.At("carried", "steps do not find where the friction of the valve sticks", "carried = \"exactly\"");
  }
}

PluginInfo FuelGas::Info() {
  return {"plant",
          "fuel_gas",
          "fuel gas supply with a membrane regulator",
          "m x'' = A (p_mem - p_g) - F_s0 - k_s x - c_s x', dp_g/dt = R theta/V (q_g - q_e), q_g = max(0, k_q x + d_q)",
          "thesis (6.23)-(6.29)",
          {}};
}

PlantTraits FuelGas::Traits() {
  PlantTraits traits;
  traits.nuisances = [](const Plan& plan) {
    std::vector<NuisanceParameter> nuisances;
    const Value* volumes = plan.root.FindPath("plant.volume");
    for (const std::string& name : volumes != nullptr ? KeysOf(*volumes) : std::vector<std::string>())
      nuisances.push_back({"plant.volume." + name + ".volume_m3", true, 0.01, "pipes are measured on drawings"});
    nuisances.push_back({"plant.mass_kg", true, 0.01, "a data sheet's mass"});
    nuisances.push_back({"plant.stiffness_N_per_m", true, 0.01, "a data sheet's spring"});
    nuisances.push_back({"plant.damping_Ns_per_m", true, 0.1, "nobody calculates dampings"});
    nuisances.push_back({"plant.preload_N", true, 0.02, "a spring that is set by hand"});
    return nuisances;
  };
  traits.sections = {"volume", "valve", "reservoir"};
  traits.linkages = {"plant.p_mem"};
  traits.separating_experiment = kSeparatingFlows;
  return traits;
}

FuelGas::FuelGas(const Params& params)
    : gas_{params.R_J_per_kg_K, params.theta_K},
      ambient_(params.ambient_pressure_Pa),
      mass_(params.mass_kg),
      membrane_area_(params.membrane_area_m2),
      preload_(params.preload_N),
      stiffness_(params.stiffness_N_per_m),
      damping_(params.damping_Ns_per_m),
      start_p_mem_(params.start_p_mem_Pa),
      stepped_(params.carried == "stepped") {
  const Valve& valve = params.valve[0].second;
  const Reservoir& reservoir = params.reservoir[0].second;
  const Volume& volume = params.volume[0].second;
  const double per_area = reservoir.pressure_Pa / std::sqrt(2.0 * gas_.R * gas_.theta);  // (6.24)
  const bool linear = valve.law == "linear";
  flow_slope_ = linear ? valve.area_factor * per_area * valve.area_slope_m : 0.0;
  flow_at_rest_ = linear ? valve.area_factor * valve.flow_at_rest_kg_per_s : 0.0;
  if (!linear) {
    positions_ = valve.positions_m;
    for (const double area : valve.areas_m2) flows_.push_back(valve.area_factor * per_area * area);
  }
  droop_ = reservoir.droop_Pas_per_kg / reservoir.pressure_Pa;
  leak_area_ = volume.leakage_area_m2;
  pressure_rate_ = gas_.R * gas_.theta / volume.volume_m3;
  if (valve.friction_N > 0.0) friction_ = std::make_unique<laws::Coulomb>(laws::Coulomb::Params{valve.friction_N});

  layout_.inputs = {{"p_mem", "Pa", "pressure on the membrane", 1e5},
                    {"q_e", "kg/s", "gas that the engine takes", 0.01}};
  layout_.outputs = {{"p_g", "Pa", "gas pressure", 1e5},
                     {"q_g", "kg/s", "flow through the valve", 0.01},
                     {"x", "m", "position of membrane and valve", 1e-3},
                     {"mass", "kg", "gas in the pipe", 0.01}};
  layout_.states = {{"x", "m", "position of membrane and valve", 1e-3},
                    {"v", "m/s", "their speed", 1e-2},
                    {"p_g", "Pa", "gas pressure", 1e5}};
  if (friction_ != nullptr) layout_.modes = layout_.guards = 1;
  BuildLinearPart();
}

double FuelGas::Flow(double x) const {
  const double full = positions_.empty() ? flow_slope_ * x + flow_at_rest_ : Along(positions_, flows_, x);
  const double open = std::max(0.0, full);
  return open / (1.0 + droop_ * open);  // q = open p/p_res with p = p_res - droop q
}

void FuelGas::Start(std::span<const double> inputs, std::span<double> states, std::span<int>) const {
  // At rest p_g follows from x, and what then remains of the flows rises with x: one zero, found by bisection. Where
  // the engine takes nothing, or gives, the valve is just closed.
  const double p_mem = start_p_mem_ > 0.0 ? start_p_mem_ : inputs[0];
  const auto pressure = [&](double x) { return p_mem - (preload_ + stiffness_ * x) / membrane_area_; };
  const auto surplus = [&](double x) { return Flow(x) - Leak(pressure(x)) - inputs[1]; };
  double low = positions_.empty() ? -flow_at_rest_ / flow_slope_ : positions_.front();
  double high = positions_.empty() ? low + 1e-3 : positions_.back();
  for (int i = 0; i < 60 && surplus(high) < 0.0; ++i) high = low + 2.0 * (high - low);
  if (surplus(low) >= 0.0) high = low;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (surplus(middle) < 0.0 ? low : high) = middle;
  }
  states[kPosition] = high;
  states[kSpeed] = 0.0;
  states[kPressure] = std::max(0.0, pressure(high));
}

void FuelGas::Output(const View& view, std::span<double> outputs) const {
  outputs[0] = view.states[kPressure];
  outputs[1] = Flow(view.states[kPosition]);
  outputs[2] = view.states[kPosition];
  outputs[3] = view.states[kPressure] / pressure_rate_;
}

double FuelGas::Force(const View& view) const {
  const std::span<const double> s = view.states;
  return membrane_area_ * (view.inputs[0] - s[kPressure]) - preload_ - stiffness_ * s[kPosition] - damping_ * s[kSpeed];
}

LawView FuelGas::FrictionView(const View& view) const {
  return {view.time_s, view.states[kPosition], view.states[kSpeed], Force(view), {}, view.modes};
}

void FuelGas::Derivative(const View& view, std::span<double> rates) const {
  const double friction = friction_ != nullptr ? friction_->Torque(FrictionView(view)) : 0.0;
  rates[kPosition] = view.states[kSpeed];
  rates[kSpeed] = (Force(view) - friction) / mass_;
  rates[kPressure] = pressure_rate_ * (Flow(view.states[kPosition]) - view.inputs[1] - Leak(view.states[kPressure]));
}

void FuelGas::Guards(const View& view, std::span<double> values) const {
  if (friction_ != nullptr) friction_->Guards(FrictionView(view), values);
}

void FuelGas::OnEvent(const View& view, int guard, std::span<double> states, std::span<int> modes) const {
  if (friction_ == nullptr) return;
  const LawView seen = FrictionView(view);
  friction_->OnEvent(seen, guard, {}, modes);
  if (modes[0] == 0) states[kSpeed] = 0.0;  // what it stops with is round-off
}

void FuelGas::BuildLinearPart() {
  channel_laws_.push_back(std::make_unique<ChannelLaw>([this](double) { return preload_; }, 0.0));
  channel_laws_.push_back(std::make_unique<ChannelLaw>([this](double x) { return Flow(x); }, flow_slope_));
  if (leak_area_ > 0.0) {
    channel_laws_.push_back(std::make_unique<ChannelLaw>([this](double p) { return Leak(p); }, 0.0));
  }
  // s = (x, v, p_g); columns of B: p_mem, q_e, preload, flow beyond k_q x, leak, friction.
  const int laws = static_cast<int>(channel_laws_.size()), channels = laws + (friction_ != nullptr ? 1 : 0);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3, 3), B = Eigen::MatrixXd::Zero(3, 2 + channels);
  A(kPosition, kSpeed) = 1.0;
  A.row(kSpeed) << -stiffness_ / mass_, -damping_ / mass_, -membrane_area_ / mass_;
  A(kPressure, kPosition) = pressure_rate_ * flow_slope_;
  B(kSpeed, 0) = membrane_area_ / mass_;
  B(kPressure, 1) = -pressure_rate_;
  B(kSpeed, 2) = -1.0 / mass_;
  B(kPressure, 3) = pressure_rate_;
  if (leak_area_ > 0.0) B(kPressure, 4) = -pressure_rate_;
  if (friction_ != nullptr) B(kSpeed, 2 + laws) = -1.0 / mass_;

  const int outputs = static_cast<int>(layout_.outputs.size());
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(outputs + 2 * channels, 3);
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(outputs + 2 * channels, 2 + channels);
  C(0, kPressure) = 1.0;
  C(1, kPosition) = flow_slope_;
  D(1, 3) = 1.0;
  C(2, kPosition) = 1.0;
  C(3, kPressure) = 1.0 / pressure_rate_;
  C(outputs + 2, kPosition) = 1.0;                        // twist of the flow: x
  if (leak_area_ > 0.0) C(outputs + 4, kPressure) = 1.0;  // of the leak: p_g
  if (friction_ != nullptr) {                             // of the friction: x, and its rate
    C(outputs + 2 * laws, kPosition) = 1.0;
    C(outputs + 2 * laws + 1, kSpeed) = 1.0;
  }
  // Scaled so that squares are energies of spring and mass, and a pressure weighs what its force does to the spring.
  const Eigen::Vector3d scale(std::sqrt(stiffness_), std::sqrt(mass_), membrane_area_ / std::sqrt(stiffness_));
  const Eigen::Vector3d inverse = scale.cwiseInverse();
  linear_part_.system.A = scale.asDiagonal() * A * inverse.asDiagonal();
  linear_part_.system.B = scale.asDiagonal() * B;
  linear_part_.system.C = C * inverse.asDiagonal();
  linear_part_.system.D = D;
  linear_part_.system.P = Eigen::MatrixXd(0, 3);
  linear_part_.system.E = Eigen::MatrixXd(outputs + 2 * channels, 0);
  linear_part_.x_from_state = scale.asDiagonal();
  linear_part_.state_from_x = inverse.asDiagonal();
  linear_part_.p_from_state = Eigen::MatrixXd(0, 3);
  linear_part_.state_from_p = Eigen::MatrixXd(3, 0);
  for (const std::unique_ptr<Law>& law : channel_laws_) {
    linear_part_.channels.push_back({law.get(), 3, 0, 0.0, law->linear()});
  }
  if (friction_ != nullptr) linear_part_.channels.push_back({friction_.get(), 3, 0, 1.0 / mass_, {}});
}

}  // namespace dynoproof
