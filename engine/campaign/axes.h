// What a campaign varies: axes that are gone through value by value (the grid) and axes that are drawn. A point is
// found from its number alone, so any part of a campaign can be run anywhere, in any order.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "model/params.h"
#include "model/value.h"

namespace dynoproof::campaign {

/// One [[axis]]: exactly one of the ways to give values.
struct AxisSpec {
  std::string key;
  std::vector<Value> list;                   // grid
  std::vector<double> grid;                  // grid: from, to
  int count = 0;                             // of the grid's values
  std::string spacing = "linear";            // of the grid
  std::vector<Value> choice;                 // drawn: one of these, all alike
  std::vector<double> uniform, log_uniform;  // drawn: from, to
  std::vector<double> normal, log_normal;    // drawn: mean (median), deviation (of the logarithm)
  bool relative = false;                     // the numbers multiply the nominal value
  void Visit(auto& v) {
    v.Required("key", key, Any(), "dotted path of what is varied: plant.inertia.I5");
    v.Optional("list", list, Any(), "grid: these values, one after the other");
    v.Optional("grid", grid, Any(), "grid: [from, to] in `count` steps");
    v.Optional("count", count, Between(2, 1e6), "grid: how many values");
    v.Optional("spacing", spacing, std::vector<std::string>{"linear", "log"}, "grid: equal steps or equal ratios");
    v.Optional("choice", choice, Any(), "drawn: one of these values, each as likely");
    v.Optional("uniform", uniform, Any(), "drawn: [from, to]");
    v.Optional("log_uniform", log_uniform, Positive(), "drawn: [from, to], the logarithm uniform");
    v.Optional("normal", normal, Any(), "drawn: [mean, standard deviation]");
    v.Optional("log_normal", log_normal, Positive(), "drawn: [median, standard deviation of the natural logarithm]");
    v.Optional("relative", relative, Any(), "the numbers multiply the scenario's own value");
  }
  void Check(Faults& faults) const;

  bool drawn() const { return list.empty() && grid.empty(); }
};

/// A value as --set takes it; numbers by the shortest text that reads back the same.
std::string TextOf(const Value& value);

enum class Sampling { kRandom, kLatinHypercube };

/// All axes, and which point has which number: the samples of one point of the grid follow each other, the last grid
/// axis moves next. Sample s draws the same values (and the same seed) at every point of the grid, so that points are
/// compared under equal conditions.
class Axes {
 public:
  Axes() = default;
  /// `samples` > 0 at each point of the grid.
  Axes(std::vector<AxisSpec> specs, std::int64_t samples, Sampling sampling, std::uint64_t seed);

  std::int64_t runs() const { return runs_; }
  std::size_t size() const { return axes_.size(); }
  const AxisSpec& spec(std::size_t axis) const { return axes_[axis].spec; }
  /// What `relative` multiplies.
  void SetNominal(std::size_t axis, double nominal) { axes_[axis].nominal = nominal; }

  /// The value of an axis in a run.
  Value At(std::size_t axis, std::int64_t run) const;
  /// The same as a number: of values that are none the place in their list, from 0.
  double Number(std::size_t axis, std::int64_t run) const;
  /// The texts behind those places; empty for an axis of numbers.
  std::vector<std::string> Labels(std::size_t axis) const;
  /// The seed of a run, 1 ... 2^31.
  std::int64_t Seed(std::int64_t run) const;
  /// The runs in which an axis takes its least and its largest number; of a list one run for each value.
  std::vector<std::int64_t> Extremes(std::size_t axis) const;

 private:
  struct Axis {
    AxisSpec spec;
    std::uint64_t stream = 0;          // of its random numbers, from its key
    std::int64_t stride = 1;           // grid: runs between two values
    std::vector<std::int32_t> strata;  // Latin hypercube: the stratum of each sample
    double nominal = 1.0;
  };
  std::int64_t Steps(const AxisSpec& spec) const;
  double Uniform(const Axis& axis, std::int64_t sample) const;
  double Drawn(const Axis& axis, std::int64_t sample) const;
  const Value* Listed(const Axis& axis, std::int64_t run, std::size_t* place) const;

  std::vector<Axis> axes_;
  std::int64_t samples_ = 1, runs_ = 0;
  std::uint64_t seed_ = 1;
};

}  // namespace dynoproof::campaign
