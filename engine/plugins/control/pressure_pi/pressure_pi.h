// Control `pressure_pi`: one pressure by one command, thesis (6.33) with (6.18) and k_F; the fuel gas controller, and
// with k_F = 0 its plain predecessor. Inputs reference, pressure [Pa], output command [Pa], limited to a range.
#pragma once

#include "plugins/control/pressure_pi/conditioned_pi.h"

namespace dynoproof::controls {

class PressurePi : public Component {
 public:
  struct Params {
    double k_P = 0.0, k_I_per_s = 0.0, k_F = 0.0, least_Pa = 0.0, largest_Pa = 0.0, initial_Pa = 0.0;
    std::string anti_windup = "conditioned";
    void Visit(auto& v) {
      v.Optional("k_P", k_P, NonNegative("1"), "proportional gain");
      v.Required("k_I_per_s", k_I_per_s, NonNegative(), "integral gain");
      v.Optional("k_F", k_F, NonNegative("1"), "feed-forward of the reference");
      v.Optional("least_Pa", least_Pa, Any(), "lower limit of the command");
      v.Required("largest_Pa", largest_Pa, Any(), "upper limit of the command");
      v.Required("initial_Pa", initial_Pa, Any(), "command at t = 0");
      v.Optional("anti_windup", anti_windup, AntiWindupNames(),
                 "(6.18) as it unwinds, without its second term, or with the printed sign");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  static std::unique_ptr<PressurePi> Create(const Params& params, const Value& table, BuildContext& context);

  bool FeedsThrough(int, int) const override { return true; }
  void Output(const View& view, std::span<double> outputs) const override;
  void Tick(const View& view, std::span<double> states, std::span<double> outputs) const override;

 private:
  PressurePi(const Params& params, double period_s);
  double Integral(const View& view) const;

  Params p_;
  ConditionedPi pi_;
};

}  // namespace dynoproof::controls
