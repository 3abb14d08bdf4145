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
  std::vector<std::string> Signals() const { return {}; }
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
  std::vector<std::string> Signals() const { return {p_.signal}; }
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
  std::vector<std::string> Signals() const { return {p_.signal}; }
  std::vector<std::string> Inputs() const { return {p_.reference}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// The steady stiffness and damping, (4.1), of a shaft's coupling at one frequency. Figures coupling_k_Nm_per_rad and
/// coupling_c_Nms_per_rad.
class CouplingCheck : public CheckPlan {
 public:
  struct Params {
    std::string shaft, origin;
    double nu_rad_per_s = 0.0, stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0, relative = 0.0;
    void Visit(auto& v) {
      v.Required("shaft", shaft, Any(), "name of the coupling's shaft");
      v.Required("nu_rad_per_s", nu_rad_per_s, NonNegative(), "frequency of the steady sine");
      v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, Positive(), "k that it should have there");
      v.Required("damping_Nms_per_rad", damping_Nms_per_rad, Positive(), "c that it should have there");
      v.Required("relative", relative, Positive("1"), "largest relative deviation of either");
      v.Required("origin", origin, Any(), "why this limit");
    }
  };
  static constexpr const char* kName = "coupling";
  static constexpr const char* kRelativeLimits[] = {"relative"};
  static constexpr const char* kSummary = "steady stiffness and damping of a hydrodynamic coupling at a frequency";
  explicit CouplingCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const { return {}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// Contacts in a shaft with play, of every [variant.NAME] or of the scenario itself: both solvers up to the second
/// impact, order of the impacts, halved steps. Figures NAME.impact_1_ms, NAME.impact_1_rad_per_s, ...
class ContactsCheck : public CheckPlan {
 public:
  struct Params {
    std::string shaft, signal, origin;
    std::vector<std::string> alike, unlike;
    double from_s = 0.0, impact_ms = 0.0, nrmse = 0.0, alike_nrmse = 0.0, unlike_nrmse = 0.0;
    int order_of = 2;
    void Visit(auto& v) {
      v.Required("shaft", shaft, Any(), "the shaft with play");
      v.Required("signal", signal, Any(), "output that is compared");
      v.Required("from_s", from_s, NonNegative(), "time from which impacts are counted and timed");
      v.Required("impact_ms", impact_ms, Positive("ms"), "largest distance of an impact's time between the solvers");
      v.Required("nrmse", nrmse, Positive("1"), "largest distance of the solvers from from_s to the second impact");
      v.Optional("order_of", order_of, Between(1, 100), "impacts whose order is compared");
      v.Optional("alike", alike, Any(), "variants that agree up to the second impact of the first of them");
      v.Optional("alike_nrmse", alike_nrmse, NonNegative("1"), "how closely");
      v.Optional("unlike", unlike, Any(), "variants that do not, from from_s to the first impact");
      v.Optional("unlike_nrmse", unlike_nrmse, NonNegative("1"), "by how much at least");
      v.Required("origin", origin, Any(), "why these limits");
    }
  };
  static constexpr const char* kName = "contacts";
  static constexpr const char* kRelativeLimits[] = {"nrmse", "alike_nrmse"};
  static constexpr bool kComparesSolvers = true;
  static constexpr const char* kSummary = "impacts in a shaft with play: solvers, halved steps, laws";
  explicit ContactsCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const { return {p_.signal}; }
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
  std::vector<std::string> Signals() const { return {p_.signal}; }
  std::vector<score::Check> Run(CheckContext& context) const override;

 private:
  Params p_;
};

/// How fast two runs part that differ by a tiny change of one number: the rate is a figure, its size no fault.
class DivergenceCheck : public CheckPlan {
 public:
  struct Params {
    std::string signal, path, origin;
    double delta = 1e-6, from_s = 0.0, to_s = 0.0, at_most_per_s = 0.0;
    void Visit(auto& v) {
      v.Required("signal", signal, Any(), "output that is compared");
      v.Required("path", path, Any(), "number that is changed, as in --set");
      v.Optional("delta", delta, Between(1e-13, 1e-2, "1"), "its relative change");
      v.Required("from_s", from_s, NonNegative(), "the rate is fitted from here");
      v.Required("to_s", to_s, Positive(), "to here");
      v.Required("at_most_per_s", at_most_per_s, Positive("1/s"), "largest rate, natural logarithm");
      v.Required("origin", origin, Any(), "why this limit");
    }
  };
  static constexpr const char* kName = "divergence";
  static constexpr const char* kSummary = "rate at which runs part after a tiny change";
  explicit DivergenceCheck(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const { return {p_.signal}; }
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
  std::vector<std::string> Signals() const { return {}; }
  std::vector<score::Check> Run(CheckContext& context) const override;
};

}  // namespace dynoproof
