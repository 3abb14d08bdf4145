#include "control10k/core.h"

#include <type_traits>

namespace control10k {

// What `only doubles` promises: the state is an array.
static_assert(std::is_trivially_copyable_v<CoreState> && std::is_standard_layout_v<CoreState>);
static_assert(sizeof(CoreState) % sizeof(double) == 0 && alignof(CoreState) == alignof(double));

bool IsUsable(const CoreConfig& config) {
  return config.speed.k_P_Nms_per_rad >= 0.0 && config.speed.k_I_Nm_per_rad >= 0.0 && config.speed.T_limit_Nm > 0.0 &&
         IsUsable(config.suppression);
}

double Core::Step(CoreState& state, const CoreInputs& in) const {
  state.T_filtered_Nm = suppression_.Step(state.suppression, in.T_shaft_Nm, in.adapt);
  state.T_ref_Nm = SpeedStep(config_.speed, state.speed, config_.suppression.period_s, in.omega_ref_rad_per_s,
                             in.omega_rad_per_s, in.k_V, state.T_filtered_Nm);
  return state.T_ref_Nm;
}

}  // namespace control10k
