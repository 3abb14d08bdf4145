// Attributes that change what numbers mean are applied, or the dataset is refused by their name.
#include "trace/hdf5_meaning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/temp_dir.h"
#include "tests/trace/hdf5_file.h"
#include "trace/hdf5_record.h"
#include "trace/trace_io.h"

namespace dynoproof::trace {
namespace {

using test::Hdf5File;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsNan;

constexpr const char* kX = "signals/x";

class Meaning : public ::testing::Test {
 protected:
  /// Four stored numbers with the attributes that `add` gives them; in the layout of a trace, or in another.
  Result<Record> Read(const std::vector<double>& stored, hid_t type, const std::function<void(Hdf5File&)>& add,
                      bool as_trace = true, std::vector<std::string> scaled_later = {}) {
    {
      Hdf5File file(dir_ / "x.h5");
      if (as_trace) file.Numbers("time", {0, 1, 2, 3});
      file.Group("signals");
      file.Numbers(kX, stored, {.type = type});
      add(file);
    }
    return ReadHdf5Record(dir_ / "x.h5", {}, scaled_later);
  }
  std::vector<double> Values(const std::vector<double>& stored, hid_t type, const std::function<void(Hdf5File&)>& add) {
    for (const bool as_trace : {true, false}) {
      const Result<Record> record = Read(stored, type, add, as_trace);
      EXPECT_TRUE(record.ok()) << record.failure().ToString();
      if (!record.ok() || !record->Find("x")) return {};
      values_ = record->columns[*record->Find("x")].values;
    }
    return values_;
  }

  test::TempDir dir_;
  std::vector<double> values_;
};

TEST_F(Meaning, ScaleAndOffsetOfWholeNumbersAndFractions) {
  const std::pair<const char*, const char*> spellings[] = {
      {"scale_factor", "add_offset"}, {"ScaleFactor", "AddOffset"}, {"SCALE_FACTOR", "ADD_OFFSET"}};
  for (const auto& [scale, offset] : spellings) {
    for (const hid_t type : {H5T_STD_I16LE, H5T_IEEE_F32BE}) {
      const auto add = [scale = scale, offset = offset](Hdf5File& f) {
        f.Number(kX, scale, {0.5}), f.Number(kX, offset, {-10});
      };
      EXPECT_THAT(Values({0, 1, -4, 100}, type, add), ElementsAre(-10, -9.5, -12, 40)) << scale;
    }
  }
  EXPECT_THAT(Values({0, 1, -4, 100}, H5T_STD_I16LE, [](Hdf5File& f) { f.Text(kX, "scale_factor", "0.25"); }),
              ElementsAre(0, 0.25, -1, 25));
}

TEST_F(Meaning, TheTimeIsScaledTooAndItsUnitIsHeard) {
  {
    Hdf5File file(dir_ / "x.h5");
    file.Numbers("time", {0, 1, 2, 3}, {.type = H5T_STD_I32LE});
    file.Number("time", "scale_factor", {0.5});
    file.Text("time", "units", "ms");
    file.Group("signals");
    file.Numbers(kX, {1, 2, 3, 4});
  }
  const Result<Trace> trace = ReadTrace(dir_ / "x.h5");
  ASSERT_TRUE(trace.ok()) << trace.failure().ToString();
  EXPECT_THAT(trace->time, ElementsAre(0, 0.5e-3, 1e-3, 1.5e-3));
  const auto wrong = [](Hdf5File& f) { f.Text("time", "unit", "kg"); };
  EXPECT_THAT(Read({1, 2, 3, 4}, H5T_IEEE_F64LE, wrong).failure().message, HasSubstr("\"kg\", which is none of time"));
}

TEST_F(Meaning, NumbersThatStandForNoValueBecomeNaN) {
  for (const char* name : {"_FillValue", "missing_value", "FillValue", "MissingValue"}) {
    const auto add = [&](Hdf5File& f) {
      f.Number(kX, name, {-999}, H5T_STD_I16LE), f.Number(kX, "scale_factor", {0.1});
    };
    EXPECT_THAT(Values({10, -999, 20, -99}, H5T_STD_I16LE, add),
                ElementsAre(1.0, IsNan(), 2.0, ::testing::DoubleEq(-9.9)))
        << name << ": compared before it is scaled";
  }
  // 1e20 in single precision is not 1e20: compared as it is stored.
  EXPECT_THAT(Values({1, 1e20, 2, 3}, H5T_IEEE_F32LE, [](Hdf5File& f) { f.Number(kX, "_FillValue", {1e20}); }),
              ElementsAre(1, IsNan(), 2, 3));
  EXPECT_THAT(Values({1, -1, -2, 3}, H5T_STD_I16LE,
                     [](Hdf5File& f) {
                       f.Number(kX, "missing_value", {-1, -2});
                     }),
              ElementsAre(1, IsNan(), IsNan(), 3));
}

TEST_F(Meaning, LimitsAreOfStoredNumbersUnlessTheyAreFractionsOfScaledWholes) {
  const auto scaled = [](Hdf5File& f) { f.Number(kX, "scale_factor", {0.5}); };
  EXPECT_THAT(Values({1, 5, 9, -7}, H5T_STD_I16LE,
                     [&](Hdf5File& f) {
                       scaled(f), f.Number(kX, "valid_range", {0, 6}, H5T_STD_I16LE);
                     }),
              ElementsAre(0.5, 2.5, IsNan(), IsNan()));
  EXPECT_THAT(Values({1, 5, 9, -7}, H5T_STD_I16LE, [&](Hdf5File& f) { scaled(f), f.Number(kX, "valid_max", {2.5}); }),
              ElementsAre(0.5, 2.5, IsNan(), -3.5));
  EXPECT_THAT(Values({1, 5, 9, -7}, H5T_IEEE_F64LE, [&](Hdf5File& f) { f.Number(kX, "valid_min", {0}); }),
              ElementsAre(1, 5, 9, IsNan()));
}

TEST_F(Meaning, IntegersWithoutTheirSign) {
  const auto add = [](Hdf5File& f) {
    f.Text(kX, "_Unsigned", "true"), f.Number(kX, "_FillValue", {-1}, H5T_STD_I8LE), f.Number(kX, "scale_factor", {2});
  };
  EXPECT_THAT(Values({0, -1, -2, 127}, H5T_STD_I8LE, add), ElementsAre(0, IsNan(), 508, 254));
  EXPECT_THAT(Values({0, 255, 128, 127}, H5T_STD_U8LE, [](Hdf5File& f) { f.Text(kX, "_Unsigned", "false"); }),
              ElementsAre(0, -1, -128, 127));
}

TEST_F(Meaning, BothSpellingsOfTheUnit) {
  for (const char* name : {"unit", "units", "Units", "UNIT"}) {
    for (const bool variable : {false, true}) {
      const auto add = [&](Hdf5File& f) { f.Text(kX, name, "kN m", variable); };
      const Result<Record> record = Read({1, 2, 3, 4}, H5T_IEEE_F64LE, add);
      ASSERT_TRUE(record.ok());
      EXPECT_EQ(record->columns[*record->Find("x")].unit, "kN m") << name;
    }
  }
}

// One of several units, or a number for one, was passed over: kN m were read as N m.
TEST_F(Meaning, AUnitThatIsNotOneTextIsRefusedUnlessTheCallerKnows) {
  const std::vector<std::function<void(Hdf5File&)>> faults = {[](Hdf5File& f) {
                                                                f.Texts(kX, "unit", {"kN m", "rad/s"});
                                                              },
                                                              [](Hdf5File& f) { f.Number(kX, "Units", {3}); },
                                                              [](Hdf5File& f) {
                                                                f.Number(kX, "units", {3, 4}, H5T_STD_I32LE);
                                                              }};
  for (const auto& add : faults) {
    for (const bool as_trace : {true, false}) {
      const Result<Record> record = Read({1, 2, 3, 4}, H5T_IEEE_F64LE, add, as_trace);
      ASSERT_FALSE(record.ok());
      EXPECT_EQ(record.failure().exit_code, 2);
      EXPECT_THAT(record.failure().message, AllOf(HasSubstr("/signals/x"), HasSubstr("is not one text")));
    }
    EXPECT_TRUE(Read({1, 2, 3, 4}, H5T_IEEE_F64LE, add, false, {"/signals/x"}).ok());
  }
  for (const std::vector<std::string>& texts : {std::vector<std::string>{}, {"kN m"}}) {
    const Result<Record> record = Read({1, 2, 3, 4}, H5T_IEEE_F64LE, [&](Hdf5File& f) { f.Texts(kX, "unit", texts); });
    ASSERT_TRUE(record.ok()) << record.failure().message;
    EXPECT_EQ(record->columns[*record->Find("x")].unit, texts.empty() ? "" : "kN m");
  }
}

TEST_F(Meaning, AScalingThatIsNotTheSameEverywhereIsRefusedByName) {
  for (const char* name :
       {"scale", "Scale", "offset", "gain", "Gain", "calibration", "calibration_factor", "conversion", "slope",
        "Intercept", "factor", "scaling_factor", "sensitivity", "lsb", "polynomial"}) {
    const auto add = [&](Hdf5File& f) { f.Number(kX, name, {0.02}); };
    const Result<Record> trace = Read({1, 2, 3, 4}, H5T_STD_I16LE, add);
    ASSERT_FALSE(trace.ok()) << name;
    EXPECT_EQ(trace.failure().exit_code, 2);
    EXPECT_THAT(trace.failure().message,
                AllOf(HasSubstr("/signals/x"), HasSubstr("\"" + std::string(name) + "\""), HasSubstr("gain, offset")));
    EXPECT_FALSE(Read({1, 2, 3, 4}, H5T_STD_I16LE, add, false).ok()) << name << ": the only dataset is left out";
    const Result<Record> known = Read({1, 2, 3, 4}, H5T_STD_I16LE, add, false, {"/signals/x"});
    ASSERT_TRUE(known.ok()) << known.failure().message;
    EXPECT_THAT(known->columns[0].values, ElementsAre(1, 2, 3, 4)) << "the caller scales them";
  }
  const auto both = [](Hdf5File& f) { f.Number(kX, "gain", {7}), f.Number(kX, "scale_factor", {0.5}); };
  const Result<Record> known = Read({1, 2, 3, 4}, H5T_STD_I16LE, both, false, {"x"});
  ASSERT_TRUE(known.ok()) << known.failure().message;
  EXPECT_THAT(known->columns[0].values, ElementsAre(0.5, 1, 1.5, 2)) << "what everybody knows is applied all the same";
  EXPECT_FALSE(Read({1, 2, 3, 4}, H5T_STD_I16LE, [](Hdf5File& f) { f.Text(kX, "gain", "0.5 N m / bit"); }).ok());
  EXPECT_FALSE(Read({1, 2, 3, 4}, H5T_STD_I16LE, [](Hdf5File& f) { f.Text(kX, "formula", "0.5*x"); }).ok());
}

TEST_F(Meaning, ANameWithOneBitTurnedIsNotPassedOver) {
  for (const std::string right : {"scale_factor", "add_offset"}) {
    for (std::size_t bit = 0; bit < 8 * right.size(); ++bit) {
      std::string name = right;
      name[bit / 8] = static_cast<char>(name[bit / 8] ^ (1 << bit % 8));
      if (name[bit / 8] == '\0') continue;  // its end, for the library
      const Result<Record> record =
          Read({1, 2, 3, 4}, H5T_STD_I16LE, [&](Hdf5File& f) { f.Number(kX, name.c_str(), {0.5}); });
      if (record.ok()) {  // another case, another mark between the words: understood
        EXPECT_NE(record->columns[*record->Find("x")].values, (std::vector<double>{1, 2, 3, 4})) << name;
      } else {
        EXPECT_THAT(record.failure().message, HasSubstr("is nearly \"" + right + "\"")) << name;
      }
    }
  }
  EXPECT_TRUE(Read({1, 2, 3, 4}, H5T_STD_I16LE, [](Hdf5File& f) { f.Number(kX, "factory", {7}); }).ok());
}

TEST_F(Meaning, AScalingThatCannotBeReadIsRefused) {
  const std::vector<std::pair<const char*, std::function<void(Hdf5File&)>>> faults = {
      {"scale_factor", [](Hdf5File& f) { f.Text(kX, "scale_factor", "see manual"); }},
      {"scale_factor",
       [](Hdf5File& f) {
         f.Number(kX, "scale_factor", {1, 2, 3, 4});
       }},
      {"scale_factor", [](Hdf5File& f) { f.Number(kX, "scale_factor", {0}); }},
      {"scale_factor", [](Hdf5File& f) { f.Number(kX, "scale_factor", {std::nan("")}); }},
      {"add_offset", [](Hdf5File& f) { f.Number(kX, "add_offset", {INFINITY}); }},
      {"_FillValue", [](Hdf5File& f) { f.Text(kX, "_FillValue", "none"); }},
      {"valid_range", [](Hdf5File& f) { f.Number(kX, "valid_range", {1}); }},
      {"_Unsigned", [](Hdf5File& f) { f.Text(kX, "_Unsigned", "perhaps"); }}};
  for (const auto& [name, add] : faults) {
    const Result<Record> record = Read({1, 2, 3, 4}, H5T_STD_I16LE, add);
    ASSERT_FALSE(record.ok()) << name;
    EXPECT_THAT(record.failure().message, AllOf(HasSubstr("/signals/x"), HasSubstr(name)));
  }
}

TEST_F(Meaning, WhatChangesNothingIsIgnored) {
  const auto add = [](Hdf5File& f) {
    f.Number(kX, "gain", {1});
    f.Number(kX, "offset", {0});
    f.Number(kX, "polynomial", {0, 1});
    f.Text(kX, "calibration", "2024-03-01, certificate A/12b");
    f.Text(kX, "long_name", "torque 2 of 3");
    f.Text(kX, "standard_name", "x");
    f.Number(kX, "sample_rate", {1000});
    f.Text(kX, "CLASS", "DIMENSION_SCALE");
  };
  EXPECT_THAT(Values({1, 2, 3, 4}, H5T_STD_I16LE, add), ElementsAre(1, 2, 3, 4));
}

}  // namespace
}  // namespace dynoproof::trace
