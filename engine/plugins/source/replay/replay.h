// Source `replay`: a recorded signal. The arrays stand in the scenario or are handed over by the experiment, which
// reads `file`: no plugin opens one.
//
// Between two samples the value is held (`hold`), goes in a straight line (`linear`), or is that of the signal without
// content above half the sampling rate (`band_limited`, equal steps only): a sum of sinc functions under a Blackman
// window of 32 samples to either side. Before the first and after the last sample that sample's value is held.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

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
      v.Optional("interpolation", interpolation, std::vector<std::string>{"hold", "linear", "band_limited"},
                 "between two samples");
    }
    void Check(Faults& faults) const;
    /// The name under which the experiment hands the series over: the record, or "file#column".
    std::string RecordName() const { return record.empty() ? file + "#" + column : record; }
  };
  static PluginInfo Info();
  /// Null, with a diagnostic, when the series is not there or its times do not rise.
  static std::unique_ptr<Replay> Create(const Params& params, const ::dynoproof::Value& table, BuildContext& context);
  /// `interpolation` as in Params; for "band_limited" the times rise in equal steps.
  Replay(Series series, const std::string& interpolation);

  double Value(double time_s) const override;

 private:
  /// The weights of samples 31 before to 32 behind the last one before a value that lies `share` of a step behind it.
  struct Weights {
    std::int64_t share;  // of 2^32
    Eigen::Matrix<double, 64, 1> of_sample;
  };
  double BandLimited(double time_s) const;
  const Weights& WeightsAt(std::int64_t share) const;

  Series series_;
  enum class Between { kHold, kLine, kBandLimited } between_;
  double steps_per_s_ = 0.0;  // mean
  // A run asks at its ticks, of which a few make a step: it meets the same few shares from sample to sample.
  mutable std::vector<Weights> known_;
  mutable std::size_t next_ = 0;  // of them to be forgotten
};

/// What is wrong with a series, or nothing.
std::optional<std::string> ProblemOf(const Series& series);
/// The same for a series without equal steps: a time stamp may be off by a hundredth of a step.
std::optional<std::string> UnequalStepsOf(const Series& series);

}  // namespace dynoproof::sources
