// What actuator and sensor stages share: one input "in", one output "out", both in the unit of the signal that the
// stage stands in. The same law may serve as actuator and as sensor.
#pragma once

#include <utility>

#include "model/registry.h"

namespace dynoproof::stages {

class Stage : public Component {
 public:
  /// `nominal` > 0: usual magnitude of the signal.
  explicit Stage(double nominal) {
    layout_.inputs = {{"in", "1", "signal into the stage, in its own unit", nominal}};
    layout_.outputs = {{"out", "1", "signal out of the stage, in the same unit", nominal}};
  }
  bool FeedsThrough(int, int) const override { return true; }
};

/// A stage without states: out = Map(time, in).
class StaticStage : public Stage {
 public:
  using Stage::Stage;
  virtual double Map(double time_s, double in) const = 0;
  void Output(const View& view, std::span<double> outputs) const final {
    outputs[0] = Map(view.time_s, view.inputs[0]);
  }
};

/// The stage `Law` registered as actuator or as sensor; Law::Describe(kind) names it.
template <class Law>
class AsActuator : public Law {
 public:
  using Law::Law;
  static PluginInfo Info() { return Law::Describe("actuator"); }
};
template <class Law>
class AsSensor : public Law {
 public:
  using Law::Law;
  static PluginInfo Info() { return Law::Describe("sensor"); }
};

}  // namespace dynoproof::stages
