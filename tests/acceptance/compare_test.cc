// `dynoproof compare` from outside: what differs fails, whatever it is that differs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/acceptance/spoil.h"
#include "tests/support/program.h"

namespace dynoproof::test {
namespace {

using ::testing::HasSubstr;

/// A trace `a.h5` and its copy `b.h5`, which each test spoils in its way.
class Compare : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(bench_.Call({"run", "line.toml"}).exit, 0);
    for (const char* name : {"a.h5", "b.h5"}) std::filesystem::copy_file(bench_ / "out/line.h5", bench_ / name);
  }
  Outcome Run(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"compare", "a.h5", "b.h5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return bench_.Call(arguments);
  }
  std::filesystem::path b() const { return bench_ / "b.h5"; }

  Bench bench_;
};

TEST_F(Compare, PassesEqualTraces) {
  const Outcome outcome = Run({"--json", "-"});
  EXPECT_EQ(outcome.exit, 0) << outcome.Both();
  const nlohmann::json document = nlohmann::json::parse(outcome.out);
  // Command, two outputs, two hull curves.
  EXPECT_EQ(document["scenarios"][0]["checks"].size(), 5u);
}

TEST_F(Compare, SeesOneChangedValue) {
  // Ten thousand times the default tolerance of 1e-7 of the nominal, 100 N m.
  Spoil(b(), [](hid_t file) {
    std::vector<double> values = Numbers(file, "/signals/T_shaft");
    values[200] += 0.1;
    Overwrite(file, "/signals/T_shaft", values);
  });
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit, 1) << outcome.Both();
  EXPECT_THAT(outcome.out, HasSubstr("T_shaft"));
  EXPECT_THAT(outcome.out, HasSubstr("0.02")) << "says when";
}

TEST_F(Compare, ObeysATolerance) {
  Spoil(b(), [](hid_t file) {
    std::vector<double> values = Numbers(file, "/signals/T_shaft");
    values[200] += 0.1;
    Overwrite(file, "/signals/T_shaft", values);
  });
  bench_.Write("wide.toml", "[signal.T_shaft]\nrelative_width = 0.01\norigin = \"test\"\n");
  EXPECT_EQ(Run({"--tolerance", "wide.toml"}).exit, 0);
  bench_.Write("wrong.toml", "[signal.T_shaft]\nrelative_widht = 0.01\norigin = \"test\"\n");
  const Outcome outcome = Run({"--tolerance", "wrong.toml"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("did you mean \"relative_width\"?"));
}

TEST_F(Compare, NeverPassesNaNOrInfinity) {
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (const std::size_t index : {std::size_t{0}, std::size_t{250}, std::size_t{500}}) {
      std::filesystem::copy_file(bench_ / "a.h5", b(), std::filesystem::copy_options::overwrite_existing);
      SetValue(b(), "/signals/T_shaft", index, value);
      const Outcome outcome = Run();
      EXPECT_THAT(outcome.exit, ::testing::AnyOf(1, 2)) << outcome.Both();
      EXPECT_THAT(outcome.out + outcome.err, HasSubstr("T_shaft"));
    }
  }
}

TEST_F(Compare, NeverPassesNaNInBoth) {
  for (const char* name : {"a.h5", "b.h5"}) SetValue(bench_ / name, "/signals/T_shaft", 100, std::nan(""));
  EXPECT_THAT(Run().exit, ::testing::AnyOf(1, 2)) << "NaN equals NaN only by accident";
}

TEST_F(Compare, MissesADeletedSignal) {
  Delete(b(), "/signals/omega_1");
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit, 1) << outcome.Both();
  EXPECT_THAT(outcome.out, HasSubstr("no signal \"omega_1\""));
}

TEST_F(Compare, SeesAnExtraSignal) {
  Spoil(b(), [](hid_t file) { Put(file, "/signals/more", Numbers(file, "/signals/omega_1"), "/signals/omega_1"); });
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit, 1) << outcome.Both();
  EXPECT_THAT(outcome.out, HasSubstr("no signal \"more\""));
}

TEST_F(Compare, SeesAShortSignal) {
  Spoil(b(), [](hid_t file) {
    std::vector<double> values = Numbers(file, "/signals/omega_1");
    values.resize(values.size() / 2);
    Put(file, "/signals/omega_1", values, "/signals/omega_1");
  });
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit, 2) << outcome.Both();
  EXPECT_THAT(outcome.err, HasSubstr("omega_1"));
}

TEST_F(Compare, SeesAShortAndALongTrace) {
  ASSERT_EQ(bench_.Call({"run", "line.toml", "--set", "run.duration_s=0.04", "--out", "short"}).exit, 0);
  EXPECT_EQ(bench_.Call({"compare", "a.h5", "short/line.h5"}).exit, 1) << "the second one ends early";
  EXPECT_EQ(bench_.Call({"compare", "short/line.h5", "a.h5"}).exit, 1) << "the second one goes on";
}

TEST_F(Compare, SeesTimeThatFalls) {
  Spoil(b(), [](hid_t file) {
    std::vector<double> time = Numbers(file, "/time");
    std::swap(time[10], time[11]);
    Overwrite(file, "/time", time);
  });
  EXPECT_EQ(Run().exit, 2);
}

TEST_F(Compare, SeesAShiftedTimeBase) {
  Spoil(b(), [](hid_t file) {
    std::vector<double> time = Numbers(file, "/time");
    for (double& t : time) t += 0.5e-4;
    Overwrite(file, "/time", time);
  });
  EXPECT_EQ(Run().exit, 1);
}

TEST_F(Compare, SeesAnotherUnit) {
  Spoil(b(), [](hid_t file) { Put(file, "/signals/omega_1", Numbers(file, "/signals/omega_1"), "/signals/T_shaft"); });
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.out, HasSubstr("unit \"N m\" instead of \"rad/s\""));
}

TEST_F(Compare, RefusesWhatIsNoTrace) {
  bench_.Write("b.h5", "this is no HDF5");
  EXPECT_EQ(Run().exit, 2);
  bench_.Write("b.h5", ReadBytes(bench_ / "a.h5").substr(0, 4000));
  EXPECT_EQ(Run().exit, 2) << "half a file";
  std::filesystem::remove(b());
  const Outcome outcome = Run();
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("b.h5"));
  Spoil(bench_ / "a.h5", [](hid_t file) {
    H5Ldelete(file, "/signals", H5P_DEFAULT);
    H5Gclose(H5Gcreate2(file, "/signals", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  });
  const Outcome nothing = bench_.Call({"compare", "a.h5", "a.h5"});
  EXPECT_NE(nothing.exit, 0) << "two traces without a signal: nothing compared is no pass\n" << nothing.Both();
}

}  // namespace
}  // namespace dynoproof::test
