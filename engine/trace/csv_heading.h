// What stands above a column of a text record: its name, its unit, or both in one cell.
#pragma once

#include <string>
#include <string_view>

namespace dynoproof::trace::csv {

struct Heading {
  std::string name;
  std::string unit;     // "" where there is none
  std::string heading;  // the whole cell, where name and unit were told apart
};

/// Tells the unit of "time [ms]", "time (ms)" and "T_shaft/Nm" from the name, if it is a unit that base/units.h knows;
/// else the whole is the name.
Heading SplitHeading(std::string_view cell);

/// A cell of a row of units as a unit: without brackets, "-" as "1".
std::string UnitOfCell(std::string_view cell);

/// Whether a cell speaks for a row of units: a unit with a letter or sign of its own, with or without brackets, or
/// anything in square brackets. "-" and "N/A" stand for values that are missing as well, so they do not.
bool SpeaksForUnits(std::string_view cell);

}  // namespace dynoproof::trace::csv
