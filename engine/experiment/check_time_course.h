// Checks of the course of a run: its dominant oscillation, whether an output follows an input.
#pragma once

#include <string>
#include <vector>

#include "experiment/checks.h"

namespace dynoproof {

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

}  // namespace dynoproof
