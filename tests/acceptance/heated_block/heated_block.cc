// A plant and an effect of somebody else: a heated block that cools by convection, and the radiation that its model
// leaves out.
#include <model/plugin_loader.h>

#include <cmath>
#include <memory>

namespace {

using namespace dynoproof;

constexpr double kStefanBoltzmann = 5.670374419e-8;  // W/(m^2 K^4)

double Radiated(double area, double T_K, double ambient_K) {
  return area * kStefanBoltzmann * (std::pow(T_K, 4) - std::pow(ambient_K, 4));
}

/// C dT/dt = P - h (T - T_amb) - A sigma (T^4 - T_amb^4)
class HeatedBlock : public Component {
 public:
  struct Params {
    double capacity_J_per_K = 0.0, conductance_W_per_K = 0.0, ambient_K = 300.0, start_K = 300.0, radiating_m2 = 0.0;
    void Visit(auto& v) {
      v.Required("capacity_J_per_K", capacity_J_per_K, Positive(), "heat capacity C");
      v.Required("conductance_W_per_K", conductance_W_per_K, Positive(), "conductance h to the air");
      v.Optional("ambient_K", ambient_K, Positive(), "temperature of the air T_amb");
      v.Optional("start_K", start_K, Positive(), "temperature at t = 0");
      v.Optional("radiating_m2", radiating_m2, NonNegative(), "black surface A");
    }
  };
  static PluginInfo Info() {
    return {"plant", "heated_block", "a block that is heated and cools", "C dT/dt = P - h (T - T_amb)", "made up", {}};
  }
  static PlantTraits Traits() {
    PlantTraits traits;
    traits.nuisances = [](const Plan&) {
      return std::vector<NuisanceParameter>{{"plant.capacity_J_per_K", true, 0.01, "weighed"},
                                            {"plant.conductance_W_per_K", true, 0.05, "from a table of convection"},
                                            {"plant.start_K", false, 2.0, "the sensor's noise", true}};
    };
    traits.measured_starts = {{"plant.start_K", "plant.T", 0.0}};
    traits.separating_experiment = "heat the block to another temperature and let it cool";
    return traits;
  }
  explicit HeatedBlock(const Params& params) : p_(params) {
    layout_.inputs = {{"P", "W", "heating power", 1000.0}};
    layout_.outputs = {{"T", "K", "temperature", 100.0}};
    layout_.states = {{"T", "K", "temperature", 100.0}};
  }
  void Start(std::span<const double>, std::span<double> states, std::span<int>) const override {
    states[0] = p_.start_K;
  }
  void Output(const View& view, std::span<double> outputs) const override { outputs[0] = view.states[0]; }
  void Derivative(const View& view, std::span<double> rates) const override {
    const double T = view.states[0], lost = p_.conductance_W_per_K * (T - p_.ambient_K);
    rates[0] = (view.inputs[0] - lost - Radiated(p_.radiating_m2, T, p_.ambient_K)) / p_.capacity_J_per_K;
  }

 private:
  Params p_;
};

class Radiation : public Effect {
 public:
  Radiation() {
    info_ = {"radiation",
             "P = A sigma (T^4 - T_amb^4)",
             "a hot surface radiates",
             {{"A", "m^2", "black surface", 0.0, 1e3, 0.0, 1e-3}}};
  }
  std::vector<Place> Places(const Plan& plan) const override {
    if (plan.root.FindPath("plant.capacity_J_per_K") == nullptr) return {};
    return {{"surface", "block", ""}};
  }
  /// A fiftieth of the heating power.
  Points Starts(const Plan&, const Place&, const Magnitudes& magnitudes) const override {
    return {{0.02 * magnitudes.input / Radiated(1.0, 500.0, 300.0)}};
  }
  void Apply(Plan& plan, const Place&, const std::vector<double>& parameters) const override {
    plan.root["plant"]["radiating_m2"] = Value(parameters[0]);
  }
};

/// The number of the data sheet that the plant declares as a nuisance, as an effect.
class Fouling : public Effect {
 public:
  Fouling() {
    info_ = {"fouling",
             "h = nominal (1 + delta)",
             "dirt insulates the surface, or a fan cools it",
             {{"delta", "1", "relative error of the conductance", -0.9, 4.0, 0.0, 0.02}}};
  }
  std::vector<Place> Places(const Plan& plan) const override {
    if (plan.root.FindPath("plant.conductance_W_per_K") == nullptr) return {};
    return {{"surface", "block", ""}};
  }
  void Apply(Plan& plan, const Place& place, const std::vector<double>& parameters) const override {
    Value& h = *plan.root.FindPath(ScaledParameter(place));
    h = Value(h.number() * (1.0 + parameters[0]));
  }
  std::string ScaledParameter(const Place&) const override { return "plant.conductance_W_per_K"; }
};

}  // namespace

DYNOPROOF_PLUGIN(registry) {
  registry.Add<HeatedBlock>();
  registry.Add(std::make_unique<Radiation>());
  registry.Add(std::make_unique<Fouling>());
}
