#include "plugins/source/source.h"

#include <fmt/format.h>

namespace dynoproof::sources {

void WarnAboveHalfTheRate(double highest_Hz, const char* key, const dynoproof::Value& table, BuildContext& context) {
  const double half_Hz = 0.5 / context.period_s;
  constexpr double kRoundOff = 1e-9;
  if (highest_Hz <= half_Hz * (1.0 + kRoundOff)) return;
  const dynoproof::Value* written = table.Find(key);
  context.diagnostics.Warning(
      written != nullptr ? written->where() : table.where(),
      fmt::format("{}: {:g} Hz is above half the sampling rate ({:g} Hz): sampled every {:g} s it is another frequency",
                  context.context, highest_Hz, half_Hz, context.period_s),
      "stay below, or a shorter run.period_s");
}

}  // namespace dynoproof::sources
