// What stands between a signal of the plant and its sample: gain, lag, delay, offset. A record corrects states, so that the
// error of a sample has to be carried back through the chain of the hypothesis: a wrong gain or lag would otherwise be
// paid for by states, and buy a better observer.
#pragma once

#include <cstddef>
#include <vector>

#include "model/plan.h"
#include "sim/rig.h"

namespace dynoproof::estimation {

class SensorChain {
 public:
  /// Of an output of the rig, which outlives it.
  SensorChain(const Rig& rig, std::size_t output);

  /// Slot at its end, not delayed; behind a tick, too, what it was before.
  int end() const { return end_; }
  double delay_s() const { return delay_s_; }
  /// Mean delay of its linear stages (the time constant of a lag) [s].
  double lag_s() const { return lag_s_; }
  /// Change of the end, once it has settled, by that of the signal, where the frame stands: the gain, or +-1 of a
  /// magnitude.
  double SlopeAt(const Frame& frame, double time_s) const;

 private:
  std::vector<const dynoproof::Block*> curved_;  // the stages without a linear part
  int end_ = -1;
  double gain_ = 1.0, delay_s_ = 0.0, lag_s_ = 0.0;
};

/// The inverse of a first-order lag, sample by sample.
class LagInverse {
 public:
  explicit LagInverse(double lag_s) : lag_s_(lag_s) {}
  /// The value before the lag, of the sample that is `since_s` after the one before. It starts in a steady state.
  double operator()(double sample, double since_s);

 private:
  double lag_s_, last_ = 0.0;
  bool begun_ = false;
};

/// Whether any output of the plan has a sensor; and the plan as if each output were the signal itself.
bool HasSensors(const Plan& plan);
Plan WithoutSensors(Plan plan);

/// exp(-T / lag) of a period T: the share of itself that a lag keeps; 0 without a lag.
double KeptOver(double period_s, double lag_s);

}  // namespace dynoproof::estimation
