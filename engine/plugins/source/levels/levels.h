// Sources that are levels: `constant`, `step`, `jump` (a list of levels) and `ramp`. A change counts from its time on:
// the sample at that time has the new value.
#pragma once

#include "plugins/source/source.h"

namespace dynoproof::sources {

/// value(t) = value.
class Constant : public Source {
 public:
  struct Params {
    double value = 0.0;
    void Visit(auto& v) { v.Required("value", value, Any(), "the value"); }
  };
  static PluginInfo Info();
  explicit Constant(const Params& params) : p_(params) {}
  double Value(double) const override { return p_.value; }

 private:
  Params p_;
};

/// value(t) = initial before time_s, value from then on.
class Step : public Source {
 public:
  struct Params {
    double initial = 0.0, value = 0.0, time_s = 0.0;
    void Visit(auto& v) {
      v.Optional("initial", initial, Any(), "value before the step");
      v.Required("value", value, Any(), "value from the step on");
      v.Required("time_s", time_s, Any(), "time of the step");
    }
  };
  static PluginInfo Info();
  explicit Step(const Params& params) : p_(params) {}
  double Value(double time_s) const override { return time_s < p_.time_s - kTimeSlack ? p_.initial : p_.value; }

 private:
  Params p_;
};

/// value(t) = values[i] from times_s[i] on, initial before the first.
class Jump : public Source {
 public:
  struct Params {
    double initial = 0.0;
    std::vector<double> times_s, values;
    void Visit(auto& v) {
      v.Optional("initial", initial, Any(), "value before the first jump");
      v.Required("times_s", times_s, Any(), "times of the jumps, rising");
      v.Required("values", values, Any(), "value from each jump on, as many as times");
    }
    void Check(Faults& faults) const;
  };
  static PluginInfo Info();
  explicit Jump(const Params& params) : p_(params) {}
  double Value(double time_s) const override;

 private:
  Params p_;
};

/// value(t) goes in a straight line from `from` at start_time_s to `to` after duration_s; constant before and after.
class Ramp : public Source {
 public:
  struct Params {
    double from = 0.0, to = 0.0, start_time_s = 0.0, duration_s = 0.0;
    void Visit(auto& v) {
      v.Optional("from", from, Any(), "value until the start");
      v.Required("to", to, Any(), "value from the end on");
      v.Optional("start_time_s", start_time_s, Any(), "start of the ramp");
      v.Required("duration_s", duration_s, Positive(), "length of the ramp");
    }
  };
  static PluginInfo Info();
  explicit Ramp(const Params& params) : p_(params) {}
  double Value(double time_s) const override;

 private:
  Params p_;
};

}  // namespace dynoproof::sources
