// The larger kinds of checks; the small ones stand in checks.cc.
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

/// The resonances that a chirp run shows, against those of the frequency response: position and height.
class ResonancesCheck : public CheckPlan {
 public:
  struct Params {
    std::vector<double> band_Hz;
    double tolerance_Hz = 0.0, tolerance_gain = 0.0, prominence_db = 6.0, narrowest_Hz = 0.0;
    std::string origin;
    void Visit(auto& v) {
      v.Required("band_Hz", band_Hz, Positive("Hz"), "from and to: where resonances are looked for");
      v.Required("tolerance_Hz", tolerance_Hz, Positive(), "largest shift of a resonance");
      v.Required("tolerance_gain", tolerance_gain, Positive("1"), "largest relative error of its height");
      v.Optional("prominence_db", prominence_db, Positive("dB"), "a peak stands out by this much on both sides");
      v.Optional("narrowest_Hz", narrowest_Hz, NonNegative(),
                 "heights count for resonances at least this wide (-3 dB)");
      v.Required("origin", origin, Any(), "why these limits");
    }
    void Check(Faults& faults) const;
  };
  static constexpr bool kNeedsAnalysis = true;
  static constexpr const char* kName = "resonances";
  static constexpr const char* kRelativeLimits[] = {"tolerance_gain"};
  static constexpr const char* kSummary = "peaks of the chirp run against the frequency response of [analysis]";
  explicit ResonancesCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// The dominant oscillation of an output: the largest tone of its spectrum (Hann window) in a band and a stretch of
/// time. Figures <figure>_hz and <figure>_UNIT; the tone must lie between two frequencies.
class PeakCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, figure, origin;
    std::vector<double> band_Hz, between_Hz, during_s;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that oscillates");
      v.Required("figure", figure, Any(), "name of the two figures, without _hz");
      v.Required("band_Hz", band_Hz, Positive("Hz"), "from and to: where the largest tone is looked for");
      v.Required("between_Hz", between_Hz, Positive("Hz"), "from and to: where it must lie");
      v.Optional("during_s", during_s, NonNegative("s"), "from and to: the stretch of the run; all when left out");
      v.Required("origin", origin, Any(), "why these limits");
    }
    void Check(Faults& faults) const;
  };
  static constexpr const char* kName = "peak";
  static constexpr const char* kSummary = "the largest tone of an output lies between two frequencies";
  explicit PeakCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// An output follows an input: the largest distance during a stretch of time.
class FollowsCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, reference, origin;
    std::vector<double> during_s;
    double largest = 0.0;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that follows");
      v.Required("reference", reference, Any(), "name of the [input.NAME] it follows, in the same unit");
      v.Optional("during_s", during_s, NonNegative("s"), "from and to: the stretch of the run; all when left out");
      v.Required("largest", largest, Positive("1"), "largest distance, in the signal's unit");
      v.Required("origin", origin, Any(), "why this limit");
    }
    void Check(Faults& faults) const;
  };
  static constexpr const char* kName = "follows";
  static constexpr const char* kSummary = "an output stays close to an input";
  explicit FollowsCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<std::string> Inputs() const override { return {p_.reference}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// `realtime` against `reference`, started anew from its state every window.
class WindowsCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, origin;
    double nrmse = 0.0, window_s = 0.0;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that is compared");
      v.Required("nrmse", nrmse, Positive("1"), "largest distance over all windows");
      v.Optional("window_s", window_s, NonNegative(), "length of a window; 0: prediction_window_s of the scenario");
      v.Required("origin", origin, Any(), "why this limit");
    }
  };
  static constexpr const char* kName = "windows";
  static constexpr const char* kRelativeLimits[] = {"nrmse"};
  static constexpr bool kComparesSolvers = true;
  static constexpr const char* kSummary = "`realtime` against `reference` in windows that restart from its state";
  explicit WindowsCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// The run against the golden trace of the scenario, with its tolerances (golden_place.h).
class GoldenCheck : public CheckPlan {
 public:
  struct Params {
    void Visit(auto&) {}
  };
  static constexpr const char* kName = "golden";
  static constexpr const char* kSummary =
      "the trace against the golden one that `bless` keeps, within the tolerances beside that";
  explicit GoldenCheck(Params) {}
  std::vector<std::string> Signals() const override { return {}; }
  std::vector<score::Check> Run(CheckContext& context) const override;
};

}  // namespace dynoproof
