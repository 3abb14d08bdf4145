// What the attributes of a dataset say about its numbers. Loggers and netCDF store small integers and say in attributes
// what they stand for: whoever passes over these reads wrong numbers.
//
//   unit, units                            the unit of the values
//   scale_factor, add_offset               value = scale_factor * stored + add_offset
//   _FillValue, missing_value              stored numbers that stand for no value: they become NaN
//   valid_min, valid_max, valid_range      stored numbers beyond them become NaN; the limits are of the values where they
//                                          are fractions and the stored numbers are whole (the rule of netCDF)
//   _Unsigned = "true"                     the stored integers have no sign
//
// Capitals and underscores make no difference (ScaleFactor). An attribute that other programs use for a scaling, but
// each in its own way (scale, gain, offset, slope, calibration, conversion, ...), is not guessed at: unless it changes
// nothing, the dataset is refused by the attribute's name; so it is where a name is one letter off one of those above.
// All other attributes are for people.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "trace/hdf5.h"

namespace dynoproof::trace::hdf5 {

struct Meaning {
  std::string unit = {};
  double scale = 1.0, offset = 0.0;
  std::vector<double> missing = {};  // stored numbers
  std::optional<double> least = {}, greatest = {};
  bool limits_of_values = false;  // else of stored numbers
  double turn = 0.0;              // 2^bits where the sign of integers is other than their type says
  bool is_signed = true;          // what their type says
  bool holds = false;             // each sample until the next, as a trace says it

  /// Turns stored numbers into values.
  void Apply(std::vector<double>& values) const;
};

/// The `signal` of a failure that refuses an attribute; of others (damage) it is empty.
inline constexpr const char* kRefused = "attribute";

/// Reads it. `scaled_later`: the caller knows what the numbers stand for and applies it, so that no attribute is refused
/// for a scaling that nobody can know. Failure: an attribute that changes the values is refused, or cannot be read.
Result<Meaning> ReadMeaning(hid_t dataset, const std::string& name, bool scaled_later = false);

/// The numbers of a dataset by their meaning.
Result<std::vector<double>> ReadMeasured(hid_t dataset, const std::string& name, const Meaning& meaning);

}  // namespace dynoproof::trace::hdf5
