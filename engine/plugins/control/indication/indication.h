// Control `indication`: evaluates the cylinder pressure of the test bed. What it saw at its last tick it gives at this one:
// a measurement is late by one to two periods. At its first tick it gives what it sees. Inputs and outputs p_evo [Pa],
// work [J].
#pragma once

#include "model/registry.h"

namespace dynoproof::controls {

class Indication : public Component {
 public:
  struct Params {
    void Visit(auto&) {}
  };
  static PluginInfo Info();
  explicit Indication(const Params& params);

  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;
};

}  // namespace dynoproof::controls
