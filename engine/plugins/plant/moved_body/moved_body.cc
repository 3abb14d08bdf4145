#include "plugins/plant/moved_body/moved_body.h"

#include <optional>

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
  plant->area_ = params.area_m2;
  Layout& layout = plant->layout_;
  layout.inputs = {{"x", "m", "position of the body", 0.01}, {"v", "m/s", "its speed", 0.1}};
  if (params.area_m2 > 0.0)
    layout.inputs.push_back({"p", "Pa", "gauge pressure on the piston", params.nominal_force_N / params.area_m2});
  layout.outputs = {{"force", "N", "force that moves the body", params.nominal_force_N}};
  std::optional<SlidingLoads> loads =
      SlidingLoads::Of(params.load, {{params.body, params.transition_speed_m_per_s, params.nominal_force_N}},
                       "moved_body", Motion::kTranslation, context, layout);
  if (!loads) return nullptr;
  plant->loads_ = *std::move(loads);
  return plant;
}

void MovedBody::Start(std::span<const double> inputs, std::span<double> states, std::span<int>) const {
  loads_.Start(0, inputs.empty() ? 0.0 : inputs[0], inputs.empty() ? 0.0 : inputs[1], states);
}

void MovedBody::Output(const View& view, std::span<double> outputs) const {
  const double x = view.inputs[0], v = view.inputs[1];
  outputs[0] = stiffness_ * x + damping_ * v;
  if (area_ > 0.0) outputs[0] += area_ * view.inputs[2];
  outputs[0] += loads_.Torque(0, x, v, view);
}

void MovedBody::Derivative(const View& view, std::span<double> rates) const {
  loads_.Derivative(0, view.inputs[0], view.inputs[1], view, rates);
}

}  // namespace dynoproof
