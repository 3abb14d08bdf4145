// Actuator stage `play`: backlash between a command and what it moves. The output follows its input only beyond half
// the width and else stands still: out = y limited to in -+ width/2, y the position so far, in the middle at the start.
// Width 0 passes the input through and has no state. Exact for held inputs, and for continuous ones that do not turn
// within an interval: y moves at its end.
#pragma once

#include "plugins/stage.h"

namespace dynoproof::stages {

class Play : public Stage {
 public:
  struct Params {
    double width = 0.0;
    void Visit(auto& v) { v.Required("width", width, NonNegative(), "total width, in the signal's unit"); }
  };
  static PluginInfo Info();
  Play(const Params& params, const BuildContext& context);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;
  void OnEvent(const View& view, int guard, std::span<double> states, std::span<int> modes) const override;

 private:
  double half_;
};

}  // namespace dynoproof::stages
