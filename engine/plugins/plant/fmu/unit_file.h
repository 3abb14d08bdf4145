// A Functional Mock-up Unit for model exchange (FMI 2.0) as a file: what it says of itself, and its library.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/fmi2.h"
#include "base/status.h"

namespace dynoproof {

struct UnitVariable {
  std::string name, unit, description;
  unsigned reference = 0;
  double start = 0.0, nominal = 1.0;
};

/// The functions of its library that a plant calls.
struct UnitFunctions {
  fmi2Component (*instantiate)(fmi2String, fmi2Type, fmi2String guid, fmi2String resources,
                               const fmi2CallbackFunctions*, fmi2Boolean visible, fmi2Boolean logging);
  void (*free_instance)(fmi2Component);
  fmi2Status (*setup_experiment)(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean, fmi2Real);
  fmi2Status (*enter_initialization)(fmi2Component);
  fmi2Status (*exit_initialization)(fmi2Component);
  fmi2Status (*new_discrete_states)(fmi2Component, fmi2EventInfo*);
  fmi2Status (*enter_continuous_time)(fmi2Component);
  fmi2Status (*get_real)(fmi2Component, const fmi2ValueReference[], std::size_t, fmi2Real[]);
  fmi2Status (*set_real)(fmi2Component, const fmi2ValueReference[], std::size_t, const fmi2Real[]);
  fmi2Status (*set_time)(fmi2Component, fmi2Real);
  fmi2Status (*set_states)(fmi2Component, const fmi2Real[], std::size_t);
  fmi2Status (*get_states)(fmi2Component, fmi2Real[], std::size_t);
  fmi2Status (*get_derivatives)(fmi2Component, fmi2Real[], std::size_t);
};

/// Unpacked once in a process; the folder goes when the process ends.
class UnitFile {
 public:
  /// Fails where there is no such file, or a unit that is none for model exchange, has events, or no library for this machine.
  static Result<std::shared_ptr<const UnitFile>> Of(const std::string& path);
  UnitFile(const UnitFile&) = delete;
  UnitFile& operator=(const UnitFile&) = delete;
  ~UnitFile();

  std::string guid, identifier, resources;  // resources: as a URI
  bool once_in_a_process = false;
  std::vector<UnitVariable> inputs, outputs, parameters, states;  // outputs: without those that are states
  std::vector<std::vector<bool>> feeds;                           // [output][input]: follows it at once
  UnitFunctions functions = {};

 private:
  UnitFile() = default;
  std::string folder_;
  void* library_ = nullptr;
};

}  // namespace dynoproof
