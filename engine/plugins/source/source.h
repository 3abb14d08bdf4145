// What all sources share: no input, one output "value", and a pure function of time, so that reruns, rewinds and cuts
// of a run agree. A source is unitless: its numbers are in the unit of the input that it drives.
#pragma once

#include <cstdint>
#include <utility>

#include "base/random.h"
#include "model/registry.h"

namespace dynoproof::sources {

/// Half a tick of the engine's nanosecond clock [s]. A time that was written as 0.3 and one that was counted as
/// 300 000 000 ns differ in the last bits; what is due at such a time must not come one sample late.
inline constexpr double kTimeSlack = 0.5e-9;

class Source : public Component {
 public:
  Source() { layout_.outputs = {{"value", "1", "value in the unit of the driven input", 1.0}}; }

  /// The value at `time_s` [s], any time.
  virtual double Value(double time_s) const = 0;

  void Output(const View& view, std::span<double> outputs) const final { outputs[0] = Value(view.time_s); }
};

/// The seed of a random source: its own when one is written (not 0), else that of the block.
inline std::uint64_t SeedOf(std::int64_t written, const BuildContext& context) {
  return static_cast<std::uint64_t>(written != 0 ? written : context.seed);
}

/// Warns where a source goes beyond half the rate at which its values are taken: what the plant then gets is another
/// frequency. `key` is where it was written.
void WarnAboveHalfTheRate(double highest_Hz, const char* key, const dynoproof::Value& table, BuildContext& context);

}  // namespace dynoproof::sources
