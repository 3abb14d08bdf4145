// Builds plugins for tests through the registry, as a scenario does.
#pragma once

#include <memory>
#include <string>

#include "model/registry.h"
#ifdef DYNOPROOF_THESIS
#include "thesis/register.h"
#endif

namespace dynoproof::testing {

/// The registry with all built-in plugins.
inline const Registry& BuiltIns() {
  static const Registry* const registry = [] {
    auto* made = new Registry;  // lives as long as the process
    RegisterBuiltIns(*made);
#ifdef DYNOPROOF_THESIS
    RegisterThesis(*made);
#endif
    return made;
  }();
  return *registry;
}

/// What the run and the block hand to a plugin.
struct Surroundings {
  double period_s = 1e-4;
  std::int64_t seed = 1;
  double nominal = 1.0;
};

/// A component from its table; null with the faults in `faults` when it cannot be built.
inline std::unique_ptr<Component> Build(const std::string& kind, const Value& table, const Surroundings& around = {},
                                        std::string* faults = nullptr) {
  Diagnostics diagnostics;
  BuildContext context{BuiltIns(), diagnostics, "test", {}, around.period_s, around.seed, around.nominal};
  std::unique_ptr<Component> made = BuiltIns().MakeComponent(kind, table, context);
  if (faults != nullptr) *faults = diagnostics.Format();
  return diagnostics.has_errors() ? nullptr : std::move(made);
}

/// A law from the table of a shaft or load, which names it by the key `law`.
inline std::unique_ptr<Law> BuildLaw(const Value& table, std::string* faults = nullptr) {
  Diagnostics diagnostics;
  BuildContext context{BuiltIns(), diagnostics, "test", {"law", "between", "on"}};
  const Value* law = table.Find("law");
  std::unique_ptr<Law> made = BuiltIns().MakeLaw(law != nullptr ? law->string() : "spring_damper", table, context);
  if (faults != nullptr) *faults = diagnostics.Format();
  return diagnostics.has_errors() ? nullptr : std::move(made);
}

/// The only output of a component at an instant.
inline double OutputOf(const Component& component, double time_s, std::span<const double> inputs = {},
                       std::span<const double> states = {}) {
  double out = 0.0;
  component.Output({time_s, inputs, states, {}}, {&out, 1});
  return out;
}

}  // namespace dynoproof::testing
