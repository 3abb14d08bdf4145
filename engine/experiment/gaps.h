// Where a record does not tell what drove the machine.
#pragma once

#include <vector>

#include "experiment/records.h"

namespace dynoproof {

/// Rows that a uniform base may miss on end: a course over so many steps is still guessed, over more nobody knows it.
inline constexpr int kMostLost = 10;

/// The record without the stretches in which more than kMostLost rows of an input are missing: what lies before, between and
/// behind them, each from 0 s on, with its notes. Parts with too few samples of an output (TooFew()) are left out. The record
/// itself where there is no such gap, or no part with enough samples.
std::vector<MappedRecord> PartsBetweenGaps(MappedRecord record);

}  // namespace dynoproof
