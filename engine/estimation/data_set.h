// The measured outputs of all records, channel behind channel, in one vector.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "experiment/records.h"
#include "model/plan.h"

namespace dynoproof::estimation {

/// What rounding moves a signal that stands still [of its usual size].
inline constexpr double kRounding = 1e-9;

/// One measured output of one record: rows [begin, begin + count) of the vector.
struct Channel {
  std::size_t record = 0;
  std::string name, unit;
  double spread = 0.0;  // standard deviation of the signal
  double white = 0.0;   // standard deviation of its white noise, as differences of the sixth order show it
  double noise = 0.0;   // what it counts as measured to: that, at least 1e-4 of the spread, 1e-9 of its nominal size
  bool still = false;   // no more than rounding moves it
  Eigen::Index begin = 0, count = 0;

  /// A difference over the signal's spread; of a signal that stands still, which has none, 0.
  double OfSpread(double difference) const { return still ? 0.0 : difference / spread; }
};

class DataSet {
 public:
  /// `records`: of the scenario `plan`; they are brought onto its clock. Every `every`-th row is compared, up to `most_s` of
  /// each record, and `from_s` of it at the earliest.
  struct Options {
    double from_s = 0.0, most_s = 1e300;
    double from_share = 0.0;                 // of the length of each record, at the earliest
    Eigen::Index most_rows = 1'000'000'000;  // of a channel: every other row goes until no more are left
    const DataSet* noise_of = nullptr;       // another part of the same records, of which their noise is known
  };
  DataSet(std::vector<MappedRecord> records, const Plan& plan, const Options& options);
  DataSet(std::vector<MappedRecord> records, const Plan& plan) : DataSet(std::move(records), plan, Options()) {}

  /// With all rows, up to the last one that is compared: they correct a run.
  const std::vector<MappedRecord>& records() const { return records_; }
  const std::vector<Channel>& channels() const { return channels_; }
  const Eigen::VectorXd& measured() const { return measured_; }
  /// Of each row [s].
  const std::vector<double>& time_s() const { return time_s_; }

 private:
  std::vector<MappedRecord> records_;
  std::vector<Channel> channels_;
  Eigen::VectorXd measured_;
  std::vector<double> time_s_;
};

/// Rows of all channels of one record in one stretch of time.
struct Block {
  struct Rows {
    std::size_t channel;
    Eigen::Index begin, count;
  };
  std::vector<Rows> rows;
};

/// Forty for each record: t with 39 degrees of freedom is nearly normal.
std::vector<Block> BlocksOf(const DataSet& data);

}  // namespace dynoproof::estimation
