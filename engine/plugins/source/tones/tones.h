// Sources that are sums of sines: `sine_sum` (given tones) and `multisine` (a band of tones with seeded random phases).
#pragma once

#include <memory>

#include "plugins/source/source.h"

namespace dynoproof::sources {

/// One tone: amplitude sin(2 pi frequency tau + phase), tau = t - start_time.
struct Tone {
  double amplitude, frequency_Hz, phase_rad;
};

/// value(t) = offset + sum of the tones from start_time_s on, 0 before.
class SineSum : public Source {
 public:
  struct Params {
    std::vector<double> amplitudes, frequencies_Hz, phases_rad;
    double offset = 0.0, start_time_s = 0.0;
    void Visit(auto& v) {
      v.Required("amplitudes", amplitudes, Any(), "amplitude of each tone");
      v.Required("frequencies_Hz", frequencies_Hz, NonNegative("Hz"), "frequency of each tone");
      v.Optional("phases_rad", phases_rad, Any(), "phase of each tone at the start; all 0 when left out");
      v.Optional("offset", offset, Any(), "added from the start on");
      v.Optional("start_time_s", start_time_s, Any(), "until then the value is 0");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  explicit SineSum(const Params& params);
  static std::unique_ptr<SineSum> Create(const Params& params, const dynoproof::Value& table, BuildContext& context);
  double Value(double time_s) const override;

 private:
  std::vector<Tone> tones_;
  double offset_, start_time_;
};

/// Equal tones at `lines` evenly spaced frequencies from low_Hz to high_Hz, both included; amplitude rms sqrt(2/lines)
/// each, so that the sum has this RMS over its period 1/spacing.
class Multisine : public Source {
 public:
  struct Params {
    double low_Hz = 0.0, high_Hz = 0.0, rms = 0.0, offset = 0.0, start_time_s = 0.0;
    int lines = 1;
    std::int64_t seed = 0;
    void Visit(auto& v) {
      v.Required("low_Hz", low_Hz, Positive(), "first line");
      v.Required("high_Hz", high_Hz, Positive(), "last line");
      v.Required("lines", lines, Between(1, 10000), "number of lines");
      v.Required("rms", rms, NonNegative(), "RMS of the sum");
      v.Optional("offset", offset, Any(), "added from the start on");
      v.Optional("start_time_s", start_time_s, Any(), "until then the value is 0");
      v.Optional("seed", seed, Any(), "seed of the phases; 0: that of the run");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  Multisine(const Params& params, const BuildContext& context);
  static std::unique_ptr<Multisine> Create(const Params& params, const dynoproof::Value& table, BuildContext& context);
  double Value(double time_s) const override;

 private:
  std::vector<Tone> tones_;
  double offset_, start_time_;
};

}  // namespace dynoproof::sources
