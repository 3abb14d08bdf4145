// Source `chirp`: a sine whose frequency changes linearly with time, thesis (2.7).
//
// With tau = t - start_time:  value = offset + amplitude sin(2 pi (f_0 tau + kappa tau^2 / 2) + phase),
// kappa = (f_1 - f_0) / duration. The frequency at tau is f_0 + kappa tau.
#pragma once

#include <memory>

#include "plugins/source/source.h"

namespace dynoproof::sources {

class Chirp : public Source {
 public:
  struct Params {
    double start_Hz = 0.0, end_Hz = 0.0, rate_Hz_per_s = 0.0, duration_s = 0.0;
    double amplitude = 1.0, offset = 0.0, phase_rad = 0.0, start_time_s = 0.0;
    std::string after = "silent";

    void Visit(auto& v) {
      v.Optional("start_Hz", start_Hz, NonNegative(), "first frequency f_0");
      v.Required("end_Hz", end_Hz, NonNegative(), "last frequency f_1; below f_0 for a falling chirp");
      v.Optional("rate_Hz_per_s", rate_Hz_per_s, NonNegative(), "magnitude of kappa; give this or duration_s");
      v.Optional("duration_s", duration_s, NonNegative(), "time from f_0 to f_1; give this or rate_Hz_per_s");
      v.Required("amplitude", amplitude, Any(), "amplitude of the sine");
      v.Optional("offset", offset, Any(), "added at all times");
      v.Optional("phase_rad", phase_rad, Any(), "phase at the start");
      v.Optional("start_time_s", start_time_s, Any(), "until then the value is the offset");
      v.Optional("after", after, std::vector<std::string>{"silent", "keep"},
                 "after f_1: only the offset, or on with f_1 in phase");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  explicit Chirp(const Params& params);
  static std::unique_ptr<Chirp> Create(const Params& params, const dynoproof::Value& table, BuildContext& context);

  double Value(double time_s) const override;

 private:
  Params p_;
  double duration_, kappa_;
};

}  // namespace dynoproof::sources
