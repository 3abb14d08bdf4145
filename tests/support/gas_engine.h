// The gas engine of scenarios/pressure/hil_load_step, whole, its bank alone or with the chain of its test bed; tests run in the root of the project.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "experiment/prepare.h"
#include "plugins/plant/engine_bank/engine_bank.h"
#include "tests/support/build.h"
#include "tests/support/registry.h"

namespace dynoproof::testing {

/// A scenario of the engine without its checks and variants.
inline std::unique_ptr<Prepared> EngineScenario(const std::string& name, std::vector<std::string> overrides) {
  overrides.insert(overrides.begin(), {"check=[]", "variant={}"});
  Diagnostics diagnostics;
  auto prepared =
      Prepare("scenarios/pressure/" + name + ".toml", {std::move(overrides), "", nullptr}, FullRegistry(), diagnostics);
  EXPECT_NE(prepared, nullptr) << diagnostics.Format();
  return prepared;
}

inline std::unique_ptr<Prepared> GasEngine(std::vector<std::string> overrides = {}) {
  return EngineScenario("hil_load_step", std::move(overrides));
}
/// The same engine with the chain of its test bed closed.
inline std::unique_ptr<Prepared> ClosedChain(std::vector<std::string> overrides = {}) {
  return EngineScenario("hil_closed_chain", std::move(overrides));
}

/// The bank alone, turned at a speed [rad/s] from an angle [rad], with its other inputs held.
struct Bank {
  std::unique_ptr<Prepared> prepared;
  const Component* component;
  std::vector<double> inputs, states, rates;
  std::vector<int> modes;

  Bank(std::vector<std::string> overrides, double angle, double speed, double p_evo = 5e5, double fuel = 1.4e-3,
       double blow_off = 0.0)
      : prepared(GasEngine(std::move(overrides))),
        component(prepared->rig->FindBlock("plant")->component.get()),
        inputs{angle, speed, p_evo, fuel, blow_off},
        states(component->layout().states.size(), 0.0),
        rates(states.size(), 0.0),
        modes(static_cast<std::size_t>(component->layout().modes), 0) {
    component->Start(inputs, states, modes);
  }
  /// Runge-Kutta 4 over a step, without the event at its end.
  void Step(double h) {
    const double angle = inputs[0], weight[4] = {0.0, 0.5, 0.5, 1.0};
    std::vector<double> k[4], x = states;
    for (int stage = 0; stage < 4; ++stage) {
      k[stage].resize(states.size());
      if (stage > 0) {
        for (std::size_t i = 0; i < x.size(); ++i) x[i] = states[i] + weight[stage] * h * k[stage - 1][i];
      }
      inputs[0] = angle + weight[stage] * h * inputs[1];
      component->Derivative({0.0, inputs, x, modes}, k[stage]);
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      states[i] += h / 6.0 * (k[0][i] + 2.0 * (k[1][i] + k[2][i]) + k[3][i]);
    }
  }
  void Event() { component->OnEvent({0.0, inputs, states, modes}, -1, states, modes); }
  std::vector<double> Outputs() const {
    std::vector<double> outputs(component->layout().outputs.size());
    component->Output({0.0, inputs, states, modes}, outputs);
    return outputs;
  }
  const std::vector<double>& Rates() {
    component->Derivative({0.0, inputs, states, modes}, rates);
    return rates;
  }
  double& State(const std::string& name) { return states[Index(name)]; }
  double Rate(const std::string& name) { return Rates()[Index(name)]; }
  std::size_t Index(const std::string& name) const {
    const auto& ports = component->layout().states;
    for (std::size_t i = 0; i < ports.size(); ++i) {
      if (ports[i].name == name) return i;
    }
    ADD_FAILURE() << "no state " << name;
    return 0;
  }
};

}  // namespace dynoproof::testing
