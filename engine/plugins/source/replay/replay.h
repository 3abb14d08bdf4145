// Source `replay`: a recorded signal. The arrays stand in the scenario or are handed over by the experiment, which
// reads `file`: no plugin opens one.
//
// Between two samples the value is held (`hold`) or goes in a straight line (`linear`); before the first and after the
// last sample that sample's value is held.
#pragma once

#include <optional>

#include "plugins/source/source.h"

namespace dynoproof::sources {

class Replay : public Source {
 public:
  struct Params {
    std::vector<double> times_s, values;
    std::string interpolation = "hold", file, column, record;
    void Visit(auto& v) {
      v.Optional("times_s", times_s, Any(), "times of the samples, rising");
      v.Optional("values", values, Any(), "values of the samples, as many as times");
      v.Optional("file", file, Any(), "CSV or HDF5 file instead of the arrays, relative to the scenario");
      v.Optional("column", column, Any(), "column or signal of the file");
      v.Optional("record", record, Any(), "signal that the experiment hands over (run --data sets this)");
      v.Optional("interpolation", interpolation, std::vector<std::string>{"hold", "linear"}, "between two samples");
    }
    void Check(Faults& faults) const;
    /// The name under which the experiment hands the series over: the record, or "file#column".
    std::string RecordName() const { return record.empty() ? file + "#" + column : record; }
  };
  static PluginInfo Info();
  /// Null, with a diagnostic, when the series is not there or its times do not rise.
  static std::unique_ptr<Replay> Create(const Params& params, const ::dynoproof::Value& table, BuildContext& context);
  Replay(Series series, bool linear) : series_(std::move(series)), linear_(linear) {}

  double Value(double time_s) const override;

 private:
  Series series_;
  bool linear_;
};

/// What is wrong with a series, or nothing.
std::optional<std::string> ProblemOf(const Series& series);

}  // namespace dynoproof::sources
