// The registry as the program has it: what Prepare() of a whole scenario asks for.
#pragma once

#include "experiment/checks.h"
#include "model/registry.h"
#ifdef DYNOPROOF_THESIS
#include "thesis/register.h"
#endif

namespace dynoproof::testing {

/// All built-in plugins and all kinds of checks.
inline const Registry& FullRegistry() {
  static const Registry* const registry = [] {
    auto* made = new Registry;  // lives as long as the process
    RegisterBuiltIns(*made);
    RegisterChecks(*made);
#ifdef DYNOPROOF_THESIS
    RegisterThesis(*made);
#endif
    return made;
  }();
  return *registry;
}

}  // namespace dynoproof::testing
