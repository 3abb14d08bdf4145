#include "plugins/plant/volumetric_engine/volumetric_engine.h"

#include <algorithm>
#include <numbers>

namespace dynoproof {

PluginInfo VolumetricEngine::Info() {
  return {"plant",
          "volumetric_engine",
          "the air that an engine takes, as a volumetric pump",
          "q = p/(R theta) lambda V_d omega/(2 pi N_r)",
          "thesis (6.10)",
          {}};
}

VolumetricEngine::VolumetricEngine(const Params& params)
    : per_turn_(params.volumetric_efficiency * params.displacement_m3 /
                (params.R_J_per_kg_K * params.theta_K * 2.0 * std::numbers::pi * params.revolutions_per_cycle)) {
  layout_.inputs = {{"pressure", "Pa", "pressure at the intake", 1e5},
                    {"speed", "rad/s", "speed of the engine", 100.0}};
  layout_.outputs = {{"q", "kg/s", "air that the engine takes", 1.0}};
}

void VolumetricEngine::Output(const View& view, std::span<double> outputs) const {
  outputs[0] = per_turn_ * std::max(0.0, view.inputs[0]) * view.inputs[1];
}

}  // namespace dynoproof
