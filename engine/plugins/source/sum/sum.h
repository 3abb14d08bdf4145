// Source `sum`: the sum of other sources, so that a chirp can ride on a ramp and noise on both.
#pragma once

#include <memory>

#include "plugins/source/source.h"

namespace dynoproof::sources {

class Sum : public Source {
 public:
  struct Params {
    std::vector<dynoproof::Value> sources;
    void Visit(auto& v) { v.Required("sources", sources, Any(), "tables of sources, each with its type"); }
  };
  static PluginInfo Info();
  /// Null when a summand is faulty; each gets a seed of its own, drawn from the block's.
  static std::unique_ptr<Sum> Create(const Params& params, const dynoproof::Value& table, BuildContext& context);

  double Value(double time_s) const override;

 private:
  std::vector<std::unique_ptr<Component>> sources_;
};

}  // namespace dynoproof::sources
