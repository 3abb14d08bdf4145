#include "plugins/plant/charge_air/charge_air.h"

#include <algorithm>
#include <functional>

#include "plugins/plant/separating_flows.h"

namespace dynoproof {
namespace {

/// Reports names of a section that are not exactly these two.
template <class T>
void CheckNames(Faults& faults, const char* section, const std::vector<std::pair<std::string, T>>& entries,
                const char* first, const char* second) {
  const auto has = [&entries](const char* name) {
    return std::any_of(entries.begin(), entries.end(), [name](const auto& entry) { return entry.first == name; });
  };
  if (entries.size() == 2 && has(first) && has(second)) return;
  faults.At(section, fmt::format("the air path has \"{}\" and \"{}\" here, and nothing else", first, second),
            fmt::format("write [plant.{0}.{1}] and [plant.{0}.{2}]", section, first, second));
}

template <class T>
const T& Named(const std::vector<std::pair<std::string, T>>& entries, const char* name) {
  return std::find_if(entries.begin(), entries.end(), [name](const auto& entry) { return entry.first == name; })
      ->second;
}

}  // namespace

void FlapParams::Check(Faults& faults) const {
  if (law == "cosine") {
    if (!(area_span_m2 > 0.0)) faults.At("area_span_m2", "a flap that does not open", "area_span_m2 > 0");
    if (!positions_percent.empty() || !areas_m2.empty()) {
      faults.At("positions_percent", "a table beside law = \"cosine\"", "law = \"table\", or no table");
    }
    return;
  }
  if (positions_percent.size() < 2 || positions_percent.size() != areas_m2.size()) {
    faults.At("areas_m2", fmt::format("{} positions and {} areas", positions_percent.size(), areas_m2.size()),
              "as many areas as positions, at least two");
    return;
  }
  for (const auto& [key, values] :
       {std::pair("positions_percent", &positions_percent), std::pair("areas_m2", &areas_m2)}) {
    if (std::adjacent_find(values->begin(), values->end(), std::greater_equal<>()) != values->end()) {
      faults.At(key, "the values do not rise", "each larger than the one before: the area has an inverse");
    }
  }
}

mechanics::FlapArea FlapParams::Area() const {
  const mechanics::FlapArea area = law == "table" ? mechanics::FlapArea::Table(positions_percent, areas_m2)
                                                  : mechanics::FlapArea::Cosine(area_offset_m2, area_span_m2);
  return area.Times(area_factor);
}

PluginInfo ChargeAir::Info() {
  return {"plant",
          "charge_air",
          "air intake of a single-cylinder engine: two volumes, two flaps",
          "dp_ch/dt = R theta/V_1 (q_1 - q_e), dp_s/dt = R theta/V_2 (q_c - q_2 - q_1), q = A(u) p/sqrt(R theta) Psi",
          "thesis (6.3)-(6.6)",
          {}};
}

PlantTraits ChargeAir::Traits() {
  PlantTraits traits;
  traits.nuisances = [](const Plan& plan) {
    std::vector<NuisanceParameter> nuisances;
    const Value* volumes = plan.root.FindPath("plant.volume");
    for (const std::string& name : volumes != nullptr ? KeysOf(*volumes) : std::vector<std::string>()) {
      const std::string path = "plant.volume." + name + ".", start = path + "start_pressure_Pa";
      nuisances.push_back({path + "volume_m3", true, 0.01, "pipes are measured on drawings"});
      const Value* pressure = plan.root.FindPath(start);
      if (pressure != nullptr && pressure->is_number() && pressure->number() != 0.0)
        nuisances.push_back({start, false, 5e4, "a sensor's gain that is to be found: a tenth of 5 bar", true});
    }
    return nuisances;
  };
  traits.measured_starts = {{"plant.volume.V_1.start_pressure_Pa", "plant.p_ch", 0.0},
                            {"plant.volume.V_2.start_pressure_Pa", "plant.p_s", 0.0}};
  traits.sections = {"volume", "flap"};
  traits.linkages = {"plant.u_1", "plant.u_2"};
  traits.separating_experiment = kSeparatingFlows;
  return traits;
}

void ChargeAir::Params::Check(Faults& faults) const {
  CheckNames(faults, "volume", volume, "V_1", "V_2");
  CheckNames(faults, "flap", flap, "1", "2");
}

ChargeAir::ChargeAir(const Params& params)
    : gas_{params.R_J_per_kg_K, params.theta_K, params.flow_function == "isentropic", params.kappa},
      ambient_(params.ambient_pressure_Pa),
      volume_{Named(params.volume, "V_1"), Named(params.volume, "V_2")},
      area_{Named(params.flap, "1").Area(), Named(params.flap, "2").Area()} {
  layout_.inputs = {{"u_1", "%", "position of the flap between the volumes", 50.0},
                    {"u_2", "%", "position of the flap to ambient", 50.0},
                    {"q_e", "kg/s", "air that the engine takes", 1.0},
                    {"q_c", "kg/s", "air that the compressor supplies", 1.0}};
  layout_.outputs = {{"p_ch", "Pa", "charge pressure", 1e5},
                     {"p_s", "Pa", "supply pressure", 1e5},
                     {"q_1", "kg/s", "flow through flap 1", 1.0},
                     {"q_2", "kg/s", "flow through flap 2", 1.0},
                     {"mass", "kg", "air in both volumes", 1.0}};
  layout_.states = {{"p_ch", "Pa", "charge pressure", 1e5}, {"p_s", "Pa", "supply pressure", 1e5}};
}

void ChargeAir::Start(std::span<const double>, std::span<double> states, std::span<int>) const {
  for (int i = 0; i < 2; ++i) states[i] = volume_[i].start_pressure_Pa;
}

void ChargeAir::Output(const View& view, std::span<double> outputs) const {
  const double p_ch = view.states[0], p_s = view.states[1];
  outputs[0] = p_ch;
  outputs[1] = p_s;
  outputs[2] = Flow(area_[0].Area(view.inputs[0]), p_s, p_ch);
  outputs[3] = Flow(area_[1].Area(view.inputs[1]), p_s, ambient_);
  outputs[4] = (p_ch * volume_[0].volume_m3 + p_s * volume_[1].volume_m3) / (gas_.R * gas_.theta);
}

void ChargeAir::Derivative(const View& view, std::span<double> rates) const {
  const double p_ch = view.states[0], p_s = view.states[1], stiffness = gas_.R * gas_.theta;
  const double q_1 = Flow(area_[0].Area(view.inputs[0]), p_s, p_ch);
  const double q_2 = Flow(area_[1].Area(view.inputs[1]), p_s, ambient_);
  const double leak_1 = Flow(volume_[0].leakage_area_m2, p_ch, ambient_);
  const double leak_2 = Flow(volume_[1].leakage_area_m2, p_s, ambient_);
  rates[0] = stiffness / volume_[0].volume_m3 * (q_1 - view.inputs[2] - leak_1);
  rates[1] = stiffness / volume_[1].volume_m3 * (view.inputs[3] - q_2 - q_1 - leak_2);
  for (int i = 0; i < 2; ++i) {
    if (view.states[i] <= 0.0) rates[i] = std::max(rates[i], 0.0);
  }
}

}  // namespace dynoproof
