// Part `balance`: holds the books of a quantity over several parts: what they store, less what was there at the start and
// came in since, plus what left, over all that came in. A flow that one part gives and none takes shows here; the
// ledgers that parts keep of themselves cannot see it.
//
//   balance = (S(t) - S(0) - I + O)/(|S(0)| + I_abs)      I' = sum of in, O' = sum of out, I_abs' = sum of |in|
//
// Inputs are named by the scenario: first all of `stored`, then `in`, then `out`; output `balance`.
#pragma once

#include "model/registry.h"

namespace dynoproof {

class Balance : public Component {
 public:
  struct Params {
    std::vector<std::string> stored, in, out;
    void Visit(auto& v) {
      v.Required("stored", stored, Any(), "names of the inputs that say how much is stored");
      v.Required("in", in, Any(), "of those that come in, per second");
      v.Required("out", out, Any(), "of those that leave, per second");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  explicit Balance(const Params& params);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int in, int) const override { return in < static_cast<int>(stored_); }
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;

 private:
  double Stored(std::span<const double> inputs) const;

  std::size_t stored_, in_, out_;  // how many of each
};

}  // namespace dynoproof
