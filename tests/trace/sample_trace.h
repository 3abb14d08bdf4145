// Traces that the tests of this folder share.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "trace/trace.h"

namespace dynoproof::trace {

/// Two signals at 10 kHz and one at 1 kHz, with values that catch careless conversions; `n` samples at 10 kHz.
inline Trace SampleTrace(std::size_t n = 100) {
  Trace trace;
  for (std::size_t i = 0; i < n; ++i) trace.time.push_back(static_cast<double>(i) * 1e-4);
  trace.other_times.emplace_back();
  for (std::size_t i = 0; i < n; i += 10) trace.other_times[0].push_back(static_cast<double>(i) * 1e-4);
  Signal torque{.name = "T_shaft", .unit = "N m", .description = "torque of the shaft k4", .nominal = 1000.0};
  for (const double t : trace.time) torque.values.push_back(1000.0 * std::sin(314.0 * t) + 1.0 / 3.0);
  torque.values[0] = -0.0;
  torque.values[1] = std::numeric_limits<double>::denorm_min();
  torque.values[2] = -std::numeric_limits<double>::max();
  Signal command{.name = "u[0]", .unit = "percent", .description = "command, größer als 0", .nominal = 100.0};
  command.interpolation = Interpolation::kHold;
  for (const double t : trace.time) command.values.push_back(std::floor(t * 1e3));
  Signal slow{.name = "p_ch", .unit = "Pa", .description = "", .nominal = 1e5};
  for (const double t : trace.other_times[0]) slow.values.push_back(1e5 * std::exp(-t));
  slow.time_base = 1;
  trace.signals = {torque, command, slow};
  trace.scenario = "[plant]\nname = \"straight chain\"  # Größe\n";
  trace.provenance.Set("version", "0.1.0");
  trace.provenance.Set("compiler", "GNU 12.2.0");
  trace.provenance.Set("commit", "");
  trace.provenance.SetCounter("seed", -7);
  trace.provenance.SetCounter("rhs_evaluations", std::int64_t{1} << 60);
  return trace;
}

}  // namespace dynoproof::trace
