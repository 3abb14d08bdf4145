// The time stamps of a record as instants. Stamps are known to their last digit, or to what their number can hold: what
// is a uniform grid within that is taken as the grid, whatever rows are missing in it; all else keeps its own instants.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace dynoproof::trace {

struct TimeBase {
  /// Instants [s] from the first one, rising. Of a uniform base whole multiples of its step.
  std::vector<double> time_s;
  /// The first and the last row of each instant. They differ at an event: simulators write the values before and after it.
  std::vector<std::size_t> first_row, last_row;
  double start_s = 0.0;       // the first stamp, as the file has it
  double step_s = 0.0;        // of a uniform base; 0: instants of their own
  double resolution_s = 0.0;  // to which a stamp is known
  double step_range = 0.0;    // of a uniform base: any step within this share of step_s goes through all stamps
  bool plain = false;         // step or rate has so few digits that it is the one that was meant
  bool exact = false;         // its stamps lie on the grid to round-off: no digit was rounded away

  std::size_t events = 0;   // instants of several rows
  std::size_t dropped = 0;  // of a uniform base: rows that are missing in it
  std::size_t gaps = 0;     // places at which they are missing, or where instants of their own lie far apart
  double longest_gap_s = 0.0, longest_gap_at_s = 0.0;
  std::size_t longest_gap_row = 0;  // behind it
  double jitter_s = 0.0;            // of instants of their own: the largest distance from the grid of their usual step
  double usual_step_s = 0.0;        // the median step, or step_s

  bool uniform() const { return step_s > 0.0; }
  /// What a reader should know of it, one sentence each: rows that are missing, gaps, jitter, events.
  std::vector<std::string> Notes(const std::string& name) const;
};

/// Row in which a stamp is not finite or falls below the one before it; `stamps.size()` where none does.
std::size_t FirstFaultOf(std::span<const double> stamps);

/// `stamps` without such a row; `unit_s`: seconds in their unit.
TimeBase TimeBaseOf(std::span<const double> stamps, double unit_s = 1.0);

}  // namespace dynoproof::trace
