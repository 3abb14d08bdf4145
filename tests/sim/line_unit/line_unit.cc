// The library of a unit for model exchange (FMI 2.0): two bodies on a shaft, as another tool would export them. Variables: 0 the input
// T; 1 ... 4 the states A, B, w_A, w_B; 5 ... 8 their derivatives; 9 the output T_shaft; 10 ... 14 the parameters I_A, I_B, k, c, b.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/fmi2.h"

namespace {

struct Line {
  double values[15] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.2, 0.3, 500.0, 0.5, 0.1};
  bool initialized = false;

  void Compute() {
    double* v = values;
    v[9] = v[12] * (v[1] - v[2]) + v[13] * (v[3] - v[4]);
    v[5] = v[3];
    v[6] = v[4];
    v[7] = (v[0] - v[9]) / v[10];
    v[8] = (v[9] - v[14] * v[4]) / v[11];
  }
};

Line& Of(fmi2Component component) { return *static_cast<Line*>(component); }

}  // namespace

extern "C" {

fmi2Component fmi2Instantiate(fmi2String, fmi2Type type, fmi2String guid, fmi2String, const fmi2CallbackFunctions*,
                              fmi2Boolean, fmi2Boolean) {
  return type == fmi2ModelExchange && std::strcmp(guid, "{line}") == 0 ? new Line() : nullptr;
}
void fmi2FreeInstance(fmi2Component component) { delete static_cast<Line*>(component); }
fmi2Status fmi2SetupExperiment(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real) { return fmi2OK; }
fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  // An inertia that is none has no motion.
  return Of(component).values[10] > 0.0 && Of(component).values[11] > 0.0 ? fmi2OK : fmi2Error;
}
fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  Of(component).initialized = true;
  return fmi2OK;
}
fmi2Status fmi2NewDiscreteStates(fmi2Component, fmi2EventInfo* info) {
  *info = {};
  return fmi2OK;
}
fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) {
  return Of(component).initialized ? fmi2OK : fmi2Error;
}
fmi2Status fmi2SetTime(fmi2Component, fmi2Real) { return fmi2OK; }
fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real states[], std::size_t count) {
  if (count != 4 || !std::all_of(states, states + 4, [](double x) { return std::isfinite(x); })) return fmi2Discard;
  std::copy(states, states + 4, Of(component).values + 1);
  return fmi2OK;
}
fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real states[], std::size_t count) {
  std::copy(Of(component).values + 1, Of(component).values + 1 + count, states);
  return fmi2OK;
}
fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real rates[], std::size_t count) {
  Of(component).Compute();
  std::copy(Of(component).values + 5, Of(component).values + 5 + count, rates);
  return fmi2OK;
}
fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       fmi2Real values[]) {
  Of(component).Compute();
  for (std::size_t i = 0; i < count; ++i) values[i] = Of(component).values[references[i]];
  return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       const fmi2Real values[]) {
  for (std::size_t i = 0; i < count; ++i) Of(component).values[references[i]] = values[i];
  return fmi2OK;
}

}  // extern "C"
