// Plant `fmu`: a model that another tool exported as a Functional Mock-up Unit for model exchange (FMI 2.0). The unit gives rates and
// outputs for times, states and inputs; the solvers here integrate it, so that runs are saved, rewound and compared as with every plant.
// Inputs, outputs and parameters are the unit's own, by their names; each state is an output as well.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/component.h"
#include "model/registry.h"
#include "plugins/plant/fmu/unit_file.h"

namespace dynoproof {

class FmuPlant : public Component {
 public:
  struct Params {
    std::string file;
    std::vector<std::pair<std::string, double>> parameter, start;
    void Visit(auto& v) {
      v.Required("file", file, Any(), "the unit, from the scenario's folder on");
      v.Optional("parameter", parameter, Any(),
                 "numbers of the unit's parameters by name; effects and fits change them");
      v.Optional("start", start, Any(), "states at t = 0 by name, where not the unit's own");
    }
  };

  static PluginInfo Info();
  static PlantTraits Traits();
  /// Null, with diagnostics, where the file, a name or a value is faulty.
  static std::unique_ptr<FmuPlant> Create(const Params& params, const Value& table, BuildContext& context);
  ~FmuPlant() override;

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int in, int out) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  explicit FmuPlant(std::shared_ptr<const UnitFile> file);
  /// Makes the instance and initializes it. Returns the fault; empty where there is none.
  std::string Begin(const Params& params);
  /// Tells the unit where it is; whether it took that.
  bool Look(const View& view) const;

  std::shared_ptr<const UnitFile> file_;
  fmi2CallbackFunctions callbacks_ = {};
  fmi2Component instance_ = nullptr;        // computes for whatever it is told, and keeps nothing
  std::vector<unsigned> inputs_, outputs_;  // references
  std::vector<double> starts_;
};

}  // namespace dynoproof
