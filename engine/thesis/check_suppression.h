// Checks of chapter 5: how an oscillation of the loop grows, where notch filters were placed, and whether the loop is
// quiet afterwards.
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

/// Frequency and growth rate of one oscillation of a signal between two windows, against the loop's eigenvalue.
class GrowthCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, origin;
    double frequency_Hz = 0.0, growth_per_s = 0.0, first_s = 0.0, second_s = 0.0, window_s = 0.05;
    double tolerance_Hz = 0.0, tolerance_per_s = 0.0;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that is looked at");
      v.Required("frequency_Hz", frequency_Hz, Positive(), "frequency of the oscillation");
      v.Required("growth_per_s", growth_per_s, Any("1/s"), "its growth rate");
      v.Required("first_s", first_s, NonNegative(), "begin of the first window");
      v.Required("second_s", second_s, NonNegative(), "begin of the second window");
      v.Optional("window_s", window_s, Positive(), "length of a window");
      v.Required("tolerance_Hz", tolerance_Hz, Positive(), "limit of the frequency's deviation");
      v.Required("tolerance_per_s", tolerance_per_s, Positive("1/s"), "limit of the rate's deviation");
      v.Required("origin", origin, Any(), "why these limits");
    }
  };
  static constexpr const char* kName = "growth";
  static constexpr const char* kSummary = "frequency and growth rate of an oscillation";
  explicit GrowthCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// Frequency and amplitude of one lasting oscillation of a signal in a stretch of the run. Figures <signal>_<f>_hz and
/// <signal>_<f>_hz_amplitude.
class OscillationCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, origin;
    double frequency_Hz = 0.0, amplitude = 0.0, near_Hz = 20.0, tolerance_Hz = 0.0, tolerance = 0.0;
    std::vector<double> during_s;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that is looked at");
      v.Required("frequency_Hz", frequency_Hz, Positive(), "frequency of the oscillation");
      v.Required("amplitude", amplitude, Positive("1"), "its amplitude, in the signal's unit");
      v.Required("during_s", during_s, NonNegative("s"), "from and to: the stretch of the run");
      v.Optional("near_Hz", near_Hz, Positive(), "the strongest tone within this of the frequency is taken");
      v.Required("tolerance_Hz", tolerance_Hz, Positive(), "limit of the frequency's deviation");
      v.Required("tolerance", tolerance, Positive("1"), "limit of the amplitude's relative deviation");
      v.Required("origin", origin, Any(), "why these limits");
    }
    void Check(Faults& faults) const;
  };
  static constexpr const char* kName = "oscillation";
  static constexpr const char* kSummary = "frequency and amplitude of a lasting oscillation";
  static constexpr const char* kRelativeLimits[] = {"tolerance"};
  explicit OscillationCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// Placements of notch filters, in their order, and the loop's quiet after them. Figures notch_1_hz .., placement_1_s
/// .., placements_after_load.
class PlacementsCheck : public CheckPlan {
 public:
  struct Params {
    std::vector<std::string> notches;
    std::vector<double> expected_Hz;
    std::string signal, origin;
    double tolerance_Hz = 0.0, load_from_s = 0.0, window_s = 0.1, growth_limit = 1.1;
    void Visit(auto& v) {
      v.Required("notches", notches, Any(), "outputs with the frequencies of the filters");
      v.Required("expected_Hz", expected_Hz, Any("Hz"), "frequencies in the order of placement: no more, no fewer");
      v.Required("tolerance_Hz", tolerance_Hz, Positive(), "largest deviation of each");
      v.Required("load_from_s", load_from_s, NonNegative(),
                 "nothing may be placed from here on; the run's end: no load");
      v.Required("signal", signal, Any(), "output that must not grow after the last placement");
      v.Optional("window_s", window_s, Positive(), "its RMS is compared over windows of this length");
      v.Optional("growth_limit", growth_limit, Positive("1"), "RMS of the last window over that of the one before");
      v.Required("origin", origin, Any(), "why these limits");
    }
  };
  static constexpr const char* kName = "placements";
  static constexpr const char* kSummary = "where notch filters were placed, and that the loop is stable afterwards";
  explicit PlacementsCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override {
    std::vector<std::string> signals = p_.notches;
    signals.push_back(p_.signal);
    return signals;
  }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// Filters that follow whatever is strongest: found by a time, lost later. Figures notch_1_hz .. (when found) and
/// notch_1_wander_hz .. (how far each moved afterwards).
class WanderCheck : public CheckPlan {
 public:
  struct Params {
    std::vector<std::string> notches;
    std::vector<double> expected_Hz;
    std::string origin;
    double found_by_s = 0.0, tolerance_Hz = 0.0, wanders_Hz = 0.0;
    void Visit(auto& v) {
      v.Required("notches", notches, Any(), "outputs with the frequencies of the filters");
      v.Required("expected_Hz", expected_Hz, Any("Hz"), "frequency of each at found_by_s, in this order");
      v.Required("found_by_s", found_by_s, NonNegative(), "time at which they must be there");
      v.Required("tolerance_Hz", tolerance_Hz, Positive(), "largest deviation of each");
      v.Required("wanders_Hz", wanders_Hz, Positive(), "at least one moves this far from there afterwards");
      v.Required("origin", origin, Any(), "why these limits");
    }
  };
  static constexpr const char* kName = "wander";
  static constexpr const char* kSummary = "adaptive filters that find their frequencies and lose them again";
  explicit WanderCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return p_.notches; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

}  // namespace dynoproof
