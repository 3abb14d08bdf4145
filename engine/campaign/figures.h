// Figures of a run: one number of a signal's course, or one that a check found out.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "model/params.h"
#include "score/series.h"

namespace dynoproof::campaign {

/// [figure.NAME]
struct FigureSpec {
  std::string of, take, from;
  double after_s = 0.0;
  double at_least = -std::numeric_limits<double>::infinity(), at_most = std::numeric_limits<double>::infinity();
  void Visit(auto& v) {
    v.Optional("of", of, Any(), "an input or output of the scenario");
    v.Optional("take", take, std::vector<std::string>{"peak", "max", "min", "mean", "rms", "last", "peak_s"},
               "what is taken of it; peak: largest magnitude, peak_s: when");
    v.Optional("after_s", after_s, NonNegative(), "the course before does not count");
    v.Optional("from", from, Any(), "instead of `of`: a figure of the scenario's checks");
    v.Optional("at_least", at_least, Any(), "a run with less fails");
    v.Optional("at_most", at_most, Any(), "a run with more fails");
  }
  void Check(Faults& faults) const;
  bool limited() const { return std::isfinite(at_least) || std::isfinite(at_most); }
  /// What is wrong with the value; empty: nothing.
  std::string Fault(const std::string& name, double value) const;
  /// How much of its limit a value takes, 1 at the limit: of one limit its ratio to that, between two the distance from
  /// the middle. NaN where a single limit is zero.
  double Used(double value) const;
  /// "T_peak is 590, at most 600 is allowed"
  std::string Limits(const std::string& name, double value) const;
};

/// The figure of a course; NaN where no sample counts.
double Take(const FigureSpec& figure, const score::Series& course);
/// Its unit, where the signal has this one.
std::string UnitOf(const FigureSpec& figure, const std::string& unit);

}  // namespace dynoproof::campaign
