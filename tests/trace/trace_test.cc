#include "trace/trace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/trace/sample_trace.h"

namespace dynoproof::trace {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Trace, GoodTraceHasNoProblems) {
  EXPECT_THAT(Validate(SampleTrace()), IsEmpty());
  EXPECT_THAT(ValidateProvenance(SampleTrace().provenance), IsEmpty());
}

TEST(Trace, FindsSignalsAndTheirTime) {
  const Trace trace = SampleTrace(100);
  ASSERT_NE(trace.Find("p_ch"), nullptr);
  EXPECT_EQ(trace.TimeOf(*trace.Find("p_ch")).size(), 10u);
  EXPECT_EQ(trace.TimeOf(*trace.Find("T_shaft")).data(), trace.time.data());
  EXPECT_EQ(trace.Find("t_shaft"), nullptr);
}

TEST(Trace, ValidateNamesCountAndPlaceOfWhatIsNotFinite) {
  Trace trace = SampleTrace();
  trace.signals[0].values[7] = kNan;
  trace.signals[0].values[9] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(Validate(trace), ElementsAre(AllOf(HasSubstr("\"T_shaft\""), HasSubstr("2 of 100"), HasSubstr("row 7"),
                                                 HasSubstr("t = 0.0007 s"))));
}

TEST(Trace, ValidateWantsStrictlyRisingFiniteTime) {
  Trace repeated = SampleTrace();
  repeated.time[5] = repeated.time[4];
  EXPECT_THAT(Validate(repeated), ElementsAre(AllOf(HasSubstr("/time:"), HasSubstr("1 of 99"), HasSubstr("row 5"))));
  Trace falling = SampleTrace();
  falling.other_times[0][3] = 0.0;
  EXPECT_THAT(Validate(falling), ElementsAre(AllOf(HasSubstr("/time_1:"), HasSubstr("row 3"))));
  Trace broken = SampleTrace();
  broken.time[5] = kNan;
  EXPECT_THAT(Validate(broken), ElementsAre(AllOf(HasSubstr("/time"), HasSubstr("row 5"))));
  EXPECT_THAT(Validate(Trace{}), ElementsAre("/time: no samples"));
}

TEST(Trace, ValidateReportsAllFaultsAtOnce) {
  Trace trace = SampleTrace();
  trace.signals[0].values.pop_back();
  trace.signals[1].name = "T_shaft";
  trace.signals[1].nominal = 0.0;
  trace.signals[2].time_base = 2;
  EXPECT_THAT(Validate(trace), ElementsAre(HasSubstr("99 values for 100"), HasSubstr("two of this name"),
                                           HasSubstr("nominal is 0"), HasSubstr("time base 2 does not exist")));
}

TEST(Trace, ValidateRefusesNamesThatAFileCannotHold) {
  for (const char* name : {"", "a/b", ".", ".."}) {
    Trace trace = SampleTrace();
    trace.signals[0].name = name;
    EXPECT_THAT(Validate(trace), ElementsAre(HasSubstr("not a name"))) << name;
  }
}

TEST(Provenance, KeepsTheOrderAndReplaces) {
  Provenance provenance;
  provenance.Set("version", "1");
  provenance.Set("commit", "abc");
  provenance.Set("version", "2");
  provenance.SetCounter("steps", 3);
  provenance.SetCounter("steps", 4);
  EXPECT_THAT(provenance.texts, ElementsAre(std::pair("version", "2"), std::pair("commit", "abc")));
  EXPECT_EQ(provenance.Counter("steps"), 4);
  EXPECT_EQ(provenance.Text("commit"), "abc");
  EXPECT_EQ(provenance.Text("steps"), std::nullopt);
}

TEST(Provenance, RefusesClocksAndAbsolutePaths) {
  Provenance provenance;
  provenance.Set("compiler", "g++ -I/usr/include -o /opt/x");  // the first is an option, the second a path
  provenance.Set("source", "C:\\records\\a.csv");
  provenance.Set("unit", "km/h and a / b");
  provenance.Set("wall_time", "3 s");
  provenance.SetCounter("duration_ns", 5);
  provenance.SetCounter("unit", 5);
  EXPECT_THAT(ValidateProvenance(provenance),
              ElementsAre(HasSubstr("\"/opt/x\""), HasSubstr("C:\\records"), HasSubstr("no wall"),
                          HasSubstr("no duration"), HasSubstr("two of this name")));
}

}  // namespace
}  // namespace dynoproof::trace
