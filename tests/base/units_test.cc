#include "base/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace dynoproof {
namespace {

/// What another library of units says: value in `si` = factor * value + offset.
struct Known {
  std::string ours, theirs, si;
  double factor, offset;
};

// Written by UDUNITS 2.2.28 (ut_get_converter from `theirs` to `si`, at 0 and 1; at 0 and 1e6 where there is an
// offset). It counts a plain "lb" as a mass throughout, rounds its ounce and has no U, r or PS, so `theirs` spells these out.
const std::vector<Known>& Table() {
  static const std::vector<Known> table = {
      {"kN m", "kN.m", "N m", 1000.0, 0.0},
      {"mNm", "mN.m", "N m", 0.001, 0.0},
      {"Ncm", "N.cm", "N m", 0.01, 0.0},
      {"Nmm", "N.mm", "N m", 0.001, 0.0},
      {"daNm", "10 N.m", "N m", 10.0, 0.0},
      {"kgf m", "kgf.m", "N m", 9.80665, 0.0},
      {"kp m", "kgf.m", "N m", 9.80665, 0.0},
      {"ft-lb", "foot.pound_force", "N m", 1.3558179483314003, 0.0},
      {"ft.lbf", "foot.pound_force", "N m", 1.3558179483314003, 0.0},
      {"lbf ft", "foot.pound_force", "N m", 1.3558179483314003, 0.0},
      {"in-lb", "inch.pound_force", "N m", 0.1129848290276167, 0.0},
      {"oz in", "0.0625 inch.pound_force", "N m", 0.0070615518142260435, 0.0},
      {"U/min", "turn/min", "rad/s", 0.10471975511965977, 0.0},
      {"r/min", "turn/min", "rad/s", 0.10471975511965977, 0.0},
      {"rpm", "turn/min", "rad/s", 0.10471975511965977, 0.0},
      {"rev/min", "turn/min", "rad/s", 0.10471975511965977, 0.0},
      {"1/min", "1/min", "1/s", 0.016666666666666666, 0.0},
      {"min^-1", "1/min", "1/s", 0.016666666666666666, 0.0},
      {"°/s", "degree/s", "rad/s", 0.017453292519943295, 0.0},
      {"deg/s", "degree/s", "rad/s", 0.017453292519943295, 0.0},
      {"mrad", "mrad", "rad", 0.001, 0.0},
      {"gon", "grade", "rad", 0.015707963267948967, 0.0},
      {"turns", "turn", "rad", 6.283185307179586, 0.0},
      {"µs", "us", "s", 1e-06, 0.0},
      {"msec", "ms", "s", 0.001, 0.0},
      {"min", "min", "s", 60.0, 0.0},
      {"h", "hour", "s", 3600.0, 0.0},
      {"lbf", "pound_force", "N", 4.4482216152605, 0.0},
      {"lb", "pound", "kg", 0.45359237, 0.0},
      {"oz", "0.0625 pound", "kg", 0.028349523125, 0.0},
      {"kgf", "kgf", "N", 9.80665, 0.0},
      {"psi", "psi", "Pa", 6894.757293168359, 0.0},
      {"ksi", "1000 psi", "Pa", 6894757.2931683585, 0.0},
      {"mbar", "mbar", "Pa", 100.0, 0.0},
      {"kPa", "kPa", "Pa", 1000.0, 0.0},
      {"atm", "atm", "Pa", 101325.0, 0.0},
      {"mmHg", "mmHg", "Pa", 133.322387415, 0.0},
      {"degC", "degC", "K", 1.0, 273.15},
      {"°F", "degF", "K", 0.5555555555555556, 255.37222222222223},
      {"in", "inch", "m", 0.025400000000000002, 0.0},
      {"ft", "foot", "m", 0.3048, 0.0},
      {"mm", "mm", "m", 0.001, 0.0},
      {"N/mm", "N/mm", "N/m", 1000.0, 0.0},
      {"lbf/in", "lbf/inch", "N/m", 175.12683524647633, 0.0},
      {"kg m²", "kg.m2", "kg m^2", 1.0, 0.0},
      {"g cm^2", "g.cm2", "kg m^2", 1.0000000000000001e-07, 0.0},
      {"lb ft^2", "pound.foot2", "kg m^2", 0.042140110093804806, 0.0},
      {"km/h", "km/h", "m/s", 0.2777777777777778, 0.0},
      {"mph", "mile/hour", "m/s", 0.44704, 0.0},
      {"g0", "gravity", "m/s^2", 9.80665, 0.0},
      {"hp", "550 foot.pound_force/second", "W", 745.6998715822702, 0.0},
      {"PS", "75 kgf.m/s", "W", 735.49875, 0.0},
      {"kW", "kW", "W", 1000.0, 0.0},
      {"kWh", "kW.h", "J", 3600000.0, 0.0},
      {"mAh", "mA.h", "A s", 3.6, 0.0},
      {"l/min", "l/min", "m^3/s", 1.666666666666667e-05, 0.0},
      {"kg/h", "kg/h", "kg/s", 0.0002777777777777778, 0.0},
      {"g/s", "g/s", "kg/s", 0.001, 0.0},
      {"mV", "mV", "V", 0.001, 0.0},
      {"kHz", "kHz", "Hz", 1000.0, 0.0},
      {"%", "0.01", "1", 0.01, 0.0},
      {"mPas", "mPa.s", "Pa s", 0.001, 0.0},
      {"N m s/deg", "N.m.s/degree", "N m s/rad", 57.29577951308232, 0.0},
  };
  return table;
}

Unit Of(const std::string& text) {
  const std::optional<Unit> unit = ParseUnit(text);
  EXPECT_TRUE(unit) << text;
  return unit.value_or(Unit{});
}

TEST(Units, AreThoseOfAnotherLibrary) {
  // Both sides multiply a handful of factors: some ulps.
  for (const Known& known : Table()) {
    const Unit unit = Of(known.ours), si = Of(known.si);
    EXPECT_EQ(unit.exponents, si.exponents) << known.ours;
    EXPECT_EQ(si.factor, 1.0) << known.si;
    EXPECT_NEAR(unit.factor / known.factor, 1.0, 1e-12) << known.ours;
    EXPECT_NEAR(unit.offset, known.offset, 1e-12 * std::abs(known.offset)) << known.ours;
  }
}

TEST(Units, ManySpellingsOfOne) {
  const std::vector<std::vector<std::string>> alike = {
      {"N m", "Nm", "N.m", "N*m", "N·m", "N⋅m", "N-m", "(N m)", "newton meters", "J"},
      {"rpm", "RPM", "r/min", "rev/min", "U/min", "turns/min", "rev per min"},
      {"1/min", "min-1", "min^-1", "min⁻¹", "/min", "1/(min)"},
      {"1/s", "s-1", "s^-1", "s⁻¹"},
      {"deg/s", "°/s", "degrees per second", "º/s"},
      {"us", "µs", "μs", "usec", "microseconds"},
      {"s", "sec", "Sec", "second", "Seconds", "secs"},
      {"ms", "msec", "millisecond", "Milliseconds"},
      {"min", "minutes", "Min", "mins"},
      {"h", "hr", "hours"},
      {"degC", "°C", "℃", "deg C", "Celsius"},
      {"degF", "°F", "fahrenheit"},
      {"ft-lb", "ft lb", "ft.lbf", "ft-lbf", "lbf ft", "lb-ft", "ftlb", "lbft", "FT-LB", "lbf*ft"},
      {"in-lb", "in.lbf", "lbf in", "inlbf"},
      {"psi", "psia", "PSI", "lbf/in^2"},
      {"V", "Volt", "volts"},
      {"A", "Amp", "ampere"},
      {"%", "percent"},
      {"1", "-"},
      {"kg m^2", "kg.m²", "kg*m2", "kg m²"},
      {"N m s/rad", "Nms/rad", "(N m s)/rad", "N m/(rad/s)"},
      {"in", "inch", "Inches"},
      {"m/s^2", "m/s2", "m/s²", "m s^-2", "m.s-2", "m**1/s**2"},
  };
  for (const std::vector<std::string>& spellings : alike) {
    const Unit first = Of(spellings.front());
    for (const std::string& spelling : spellings) {
      const Unit unit = Of(spelling);
      EXPECT_EQ(unit.exponents, first.exponents) << spelling;
      EXPECT_NEAR(unit.factor / first.factor, 1.0, 1e-15) << spelling;  // the order of factors may cost an ulp
      EXPECT_EQ(unit.offset, first.offset) << spelling;
    }
  }
}

TEST(Units, CaseTellsPrefixesApart) {
  EXPECT_EQ(Of("mN").factor, 1e-3);
  EXPECT_EQ(Of("MN").factor, 1e6);
  EXPECT_EQ(Of("mPa").factor, 1e-3);
  EXPECT_EQ(Of("MPa").factor, 1e6);
  for (const char* unclear : {"MBAR", "NM", "KPA", "MSEC", "hz", "HZ", "KN"})
    EXPECT_FALSE(ParseUnit(unclear)) << unclear;
  // The SI's reading: a gram, a metre, no gravity and no minute.
  EXPECT_EQ(Of("g").exponents, Of("kg").exponents);
  EXPECT_EQ(Of("m").exponents, Of("mm").exponents);
}

TEST(Units, WhatMayMeanTwoThingsIsRefused) {
  for (const char* text :
       {"",   " ",     "a/b/c",   "m/s/s", "N/m s",   "kg/(m",      "m)",    "degC/s", "2 degC", "degC^2",
        "m^", "m^0.5", "furlong", "rpms",  "pound",   "horsepower", "hertz", "psig",   "barg",   "*m",
        "m/", "T",     "C",       "dB",    "Trigger", "D",          "True",  "m^99"}) {
    EXPECT_FALSE(ParseUnit(text)) << text;
  }
}

TEST(Units, TurnsAreAnglesButOneOverMinuteIsARate) {
  EXPECT_EQ(Of("rpm").exponents, Of("rad/s").exponents);
  EXPECT_NE(Of("1/min").exponents, Of("rad/s").exponents);
  EXPECT_TRUE(SameQuantity(Of("1/min"), Of("rad/s")));
  EXPECT_FALSE(SameQuantity(Of("lb"), Of("lbf")));
}

}  // namespace
}  // namespace dynoproof
