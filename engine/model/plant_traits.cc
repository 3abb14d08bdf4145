#include "model/plant_traits.h"

namespace dynoproof {

std::vector<NuisanceParameter> LoadSizes(const Plan& plan) {
  std::vector<NuisanceParameter> sizes;
  const Value* loads = plan.root.FindPath("plant.load");
  if (loads == nullptr || !loads->is_table()) return sizes;
  for (const Value::Entry& load : loads->table()) {
    if (!load.value.is_table()) continue;
    for (const Value::Entry& entry : load.value.table()) {
      // Not its speeds, lengths and orders: these say where a law acts, not how much.
      const bool size =
          entry.value.is_number() && entry.value.number() != 0.0 && entry.key.find("_N") != std::string::npos;
      if (!size) continue;
      NuisanceParameter one{"plant.load." + load.key + "." + entry.key, true, 1.0, "what a fit has put there"};
      one.only_released = true;
      sizes.push_back(std::move(one));
    }
  }
  return sizes;
}

}  // namespace dynoproof
