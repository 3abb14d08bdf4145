// Instants at which a signal has several rows: its values before and after an event. A tube must meet both.
#pragma once

#include <vector>

#include "score/series.h"

namespace dynoproof::score {

/// What a tube compares at each time: the test's value, and the extremes of the reference.
struct TubePoints {
  std::vector<double> time_s, test, low, high;
};

/// Judges the instants at which either signal has several rows, a few units in the last place apart (IsJump), and keeps
/// in `points`, whose times are those of both signals, what is worst at each of them.
///
/// The first row is what comes before the instant, the last one what comes after it, and the others lie on the way: first
/// meets first, last meets last, however many there are, and one between lies within the range of the other signal's
/// rows. A signal with one sample there, or none, does not tell where it jumps. It is anything between its samples on
/// either side and what the lines through the last two before and the first two behind lead to; its own sample lies
/// within the range of the rows. Of what is before its first sample and after its last it says nothing.
/// `room` is that of TubeOptions. Where the reference may be early or late, `in_time`, its extremes in `points` count as
/// well.
void JudgeJumps(const Series& reference, const Series& test, double room, bool in_time, TubePoints& points);

}  // namespace dynoproof::score
