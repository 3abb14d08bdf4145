#include "plugins/plant/moved_body/moved_body.h"

#include <fmt/format.h>

#include <cmath>

namespace dynoproof {

PluginInfo MovedBody::Info() {
  return {"plant",
          "moved_body",
          "a body whose motion is measured: the force that spring, damper and other laws to the ground need",
          "F = k x + c v + A p + sum of the laws' forces at (x, v)",
          "linear spring and damper; pressure on a piston; laws as in a drive line, read as force, speed and stretch",
          {}};
}

PlantTraits MovedBody::Traits() {
  PlantTraits traits;
  traits.nuisances = [](const Plan& plan) {
    // assumed: any size is as good as another beside an effect that takes its share.
    const char* reason = "stands for whatever carries the body: a fitted value, no data sheet's";
    std::vector<NuisanceParameter> nuisances = {{"plant.stiffness_N_per_m", true, 1.0, reason},
                                                {"plant.damping_Ns_per_m", true, 1.0, reason},
                                                // assumed: bores are machined to some tenths of a millimetre.
                                                {"plant.area_m2", true, 0.02, "a bore of some centimetres"}};
    const std::vector<NuisanceParameter> loads = LoadSizes(plan);
    nuisances.insert(nuisances.end(), loads.begin(), loads.end());
    return nuisances;
  };
  traits.bodies = [](const Plan& plan) {
    const Value* body = plan.root.FindPath("plant.body");
    return std::vector<Place>{{"inertia", body != nullptr && body->is_string() ? body->string() : "body", ""}};
  };
  traits.prescribed_motion = true;
  traits.slides = true;
  return traits;
}

std::unique_ptr<MovedBody> MovedBody::Create(const Params& params, const Value&, BuildContext& context) {
  std::unique_ptr<MovedBody> plant(new MovedBody);
  plant->stiffness_ = params.stiffness_N_per_m;
  plant->damping_ = params.damping_Ns_per_m;
  plant->transition_ = params.transition_speed_m_per_s;
  plant->area_ = params.area_m2;
  Layout& layout = plant->layout_;
  layout.inputs = {{"x", "m", "position of the body", 0.01}, {"v", "m/s", "its speed", 0.1}};
  if (params.area_m2 > 0.0)
    layout.inputs.push_back({"p", "Pa", "gauge pressure on the piston", params.nominal_force_N / params.area_m2});
  layout.outputs = {{"force", "N", "force that moves the body", params.nominal_force_N}};
  const int before = context.diagnostics.error_count();
  const auto fault = [&](const Value& at, const std::string& message, const std::string& hint) {
    context.diagnostics.Error(at.where(), message, hint, "dynoproof describe moved_body");
  };
  for (const auto& [name, table] : params.load) {
    if (!table.is_table()) {
      fault(table, fmt::format("load.{} is {}", name, table.KindName()), "write a table");
      continue;
    }
    const Value *on = table.Find("on"), *law = table.Find("law");
    if (on == nullptr || !on->is_string() || on->string() != params.body)
      fault(on != nullptr ? *on : table, fmt::format("load \"{}\" does not act on the body", name),
            fmt::format("write on = \"{}\"", params.body));
    if (law == nullptr || !law->is_string()) {
      fault(law != nullptr ? *law : table, fmt::format("\"{}\" names no law", name),
            "add law = \"viscous\", \"coulomb\", ...");
      continue;
    }
    BuildContext own{context.registry, context.diagnostics,    name,    {"on", "law"},       context.period_s,
                     context.seed,     params.nominal_force_N, nullptr, Motion::kTranslation};
    std::unique_ptr<Law> made = context.registry.MakeLaw(law->string(), table, own);
    if (made == nullptr) continue;
    if (made->layout().modes > 0 && !made->sticks()) {
      fault(*law, fmt::format("law \"{}\" has contact to follow, which a moved body does not", law->string()),
            "put it on a shaft of a drive_line");
      continue;
    }
    for (Port state : made->layout().states) {
      state.name = name + "." + NameIn(Motion::kTranslation, state.name);
      state.unit = UnitIn(Motion::kTranslation, state.unit);
      layout.states.push_back(std::move(state));
    }
    plant->loads_.push_back({std::move(made), layout.states.size()});
    plant->loads_.back().state -= plant->loads_.back().law->layout().states.size();
  }
  return context.diagnostics.error_count() == before ? std::move(plant) : nullptr;
}

LawView MovedBody::ViewOf(const View& view, const Load& load) const {
  return {view.time_s,
          view.inputs[0],
          view.inputs[1],
          0.0,
          view.states.subspan(load.state, load.law->layout().states.size()),
          {}};
}

void MovedBody::Start(std::span<const double> inputs, std::span<double> states, std::span<int>) const {
  const double x = inputs.empty() ? 0.0 : inputs[0], v = inputs.empty() ? 0.0 : inputs[1];
  for (const Load& load : loads_) {
    if (!load.law->sticks()) load.law->Start(x, v, states.subspan(load.state, load.law->layout().states.size()), {});
  }
}

void MovedBody::Output(const View& view, std::span<double> outputs) const {
  const double v = view.inputs[1];
  const double slips = transition_ > 0.0 ? std::tanh(std::abs(v) / transition_) : 1.0;
  outputs[0] = stiffness_ * view.inputs[0] + damping_ * v;
  if (area_ > 0.0) outputs[0] += area_ * view.inputs[2];
  for (const Load& load : loads_) {
    const LawView at = ViewOf(view, load);
    if (!load.law->sticks()) {
      outputs[0] += load.law->Torque(at);
    } else if (v != 0.0) {
      outputs[0] += slips * load.law->SlipTorque(at, v > 0.0 ? 1 : -1);
    }
  }
}

void MovedBody::Derivative(const View& view, std::span<double> rates) const {
  for (const Load& load : loads_)
    load.law->Derivative(ViewOf(view, load), rates.subspan(load.state, load.law->layout().states.size()));
}

}  // namespace dynoproof
