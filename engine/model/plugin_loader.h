// Shared libraries with plugins, loaded at run time. A library exports one C function, made by the macro below, which
// registers its plugins by the same call as the built-in ones:
//
//   #include <model/plugin_loader.h>
//   DYNOPROOF_PLUGIN(registry) { registry.Add<MyLaw>(); }
//
// Its stamp says what it was built against: public headers, compiler ABI, C++ library, sanitizer. Another stamp than
// the program's own is refused, because the two would disagree about memory.
#pragma once

#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "base/status.h"
#include "model/abi_stamp.h"
#include "model/registry.h"

namespace dynoproof {

/// What a plugin library exports under the name "dynoproof_plugin".
struct PluginEntry {
  const char* stamp;
  void (*register_all)(Registry& registry);
};

#define DYNOPROOF_PLUGIN(registry)                                                            \
  static void DynoproofRegister(::dynoproof::Registry& registry);                             \
  extern "C" __attribute__((visibility("default")))                                           \
  const ::dynoproof::PluginEntry dynoproof_plugin = {DYNOPROOF_ABI_STAMP, DynoproofRegister}; \
  static void DynoproofRegister(::dynoproof::Registry& registry)

/// Loads a library and registers its plugins. The library stays loaded until the program ends. Failure (exit code 2):
/// cannot be loaded, exports no dynoproof_plugin, has another stamp, or wants a name that is taken. A library that is loaded
/// already is not loaded again.
Status LoadPlugin(const std::string& file, Registry& registry);

/// The files to load: those given, then every .so in the folders (or each file) of $DYNOPROOF_PLUGIN_PATH, separated by
/// colons, sorted within a folder. What does not exist becomes a diagnostic.
std::vector<std::string> PluginFiles(const std::vector<std::string>& given, Diagnostics& diagnostics);

}  // namespace dynoproof
