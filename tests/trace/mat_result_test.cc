// Results of Modelica simulators, written here byte by byte.
#include "trace/mat_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/support/temp_dir.h"
#include "tests/trace/mat_bytes.h"
#include "trace/mat.h"

namespace dynoproof::trace {
namespace {

using test::Matrix4;
using test::Raw;
using test::Text4;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Variable {
  std::string name, description;
  int table, place;
};

struct Simulation {
  bool transposed = true;
  std::string time = "Time";
  std::vector<Variable> variables = {{"J", "Inertia [kg.m2]", 1, 2},
                                     {"inertia1.w", "Speed [rad/s|rev/min]", 2, 2},
                                     {"spring.w_rel", "Alias", 2, -2},
                                     {"tau", "Torque [N.m]", 2, 3}};
  std::vector<std::vector<double>> samples = {{0, 0.1, 0.1, 0.2}, {1, 2, 3, 4}, {-5, -6, -7, -8}};
  bool single = false;

  std::string Numbers(const char* name, const std::vector<std::vector<double>>& signals) const {
    const std::size_t n = signals[0].size();
    std::vector<double> values(signals.size() * n);
    for (std::size_t s = 0; s < signals.size(); ++s) {
      for (std::size_t i = 0; i < n; ++i) values[transposed ? i * signals.size() + s : s * n + i] = signals[s][i];
    }
    const auto high = static_cast<std::uint32_t>(transposed ? signals.size() : n);
    const auto wide = static_cast<std::uint32_t>(transposed ? n : signals.size());
    if (!single) return Matrix4(0, high, wide, name, Raw(values));
    return Matrix4(10, high, wide, name, Raw(std::vector<float>(values.begin(), values.end())));
  }

  std::string Bytes(const char* order = nullptr) const {
    std::vector<std::string> names = {time}, descriptions = {"Time in [s]"};
    std::vector<std::int32_t> info = {0, 1, 0, -1};
    for (const Variable& v : variables) {
      names.push_back(v.name), descriptions.push_back(v.description);
      for (const int number : {v.table, v.place, 0, 0}) info.push_back(number);
    }
    const std::size_t n = names.size();
    if (!transposed) {
      std::vector<std::int32_t> turned(info.size());
      for (std::size_t i = 0; i < info.size(); ++i) turned[i % 4 * n + i / 4] = info[i];
      info = turned;
    }
    const auto count = static_cast<std::uint32_t>(n);
    return Text4("Aclass",
                 {"Atrajectory", "1.1", "",
                  order        ? order
                  : transposed ? "binTrans"
                               : "binNormal"},
                 false) +
           Text4("name", names, transposed) + Text4("description", descriptions, transposed, ' ') +
           Matrix4(20, transposed ? 4 : count, transposed ? count : 4, "dataInfo", Raw(info)) +
           Numbers("data_1", {{0, 0.2}, {2.5, 2.5}}) + Numbers("data_2", samples);
  }
};

Result<Record> Read(const std::string& bytes) {
  static const test::TempDir dir;
  return ReadMat(dir.Write("result.mat", bytes));
}

class Results : public ::testing::TestWithParam<bool> {};

TEST_P(Results, VariablesAreReadByName) {
  Simulation simulation{.transposed = GetParam()};
  const Result<Record> record = Read(simulation.Bytes());
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), ElementsAre("time", "inertia1.w", "spring.w_rel", "tau"));
  EXPECT_THAT(record->columns[0].values, ElementsAre(0, 0.1, 0.1, 0.2)) << "two rows at one instant are an event";
  EXPECT_THAT(record->columns[1].values, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(record->columns[2].values, ElementsAre(-1, -2, -3, -4));
  EXPECT_THAT(record->columns[3].values, ElementsAre(-5, -6, -7, -8));
  EXPECT_EQ(record->time, 0u);
  EXPECT_EQ(record->columns[3].time, 0u);
  EXPECT_EQ(record->columns[0].unit, "s");
  EXPECT_EQ(record->columns[1].unit, "rad/s");
  EXPECT_EQ(record->columns[3].unit, "N.m");
  const std::map<std::string, std::string> left_out(record->left_out.begin(), record->left_out.end());
  EXPECT_THAT(left_out.at("J"), HasSubstr("parameter"));
}

TEST_P(Results, SinglePrecisionAndALowerCaseTime) {
  Simulation simulation{.transposed = GetParam(), .time = "time", .single = true};
  const Result<Record> record = Read(simulation.Bytes());
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->columns[0].values, ElementsAre(0, 0.1F, 0.1F, 0.2F));
}

INSTANTIATE_TEST_SUITE_P(Mat, Results, ::testing::Values(true, false),
                         [](const auto& order) { return order.param ? "binTrans" : "binNormal"; });

TEST(DamagedResult, IsRefusedForWhatIsMissing) {
  const auto fault = [](const std::string& bytes) {
    const Result<Record> record = Read(bytes);
    return record.ok() ? "it was read" : record.failure().message;
  };
  const std::string whole = Simulation().Bytes();
  EXPECT_THAT(fault(whole.substr(0, whole.find("data_2") - 20)), HasSubstr("no matrix \"data_2\""));
  EXPECT_THAT(fault(whole.substr(0, whole.find("dataInfo") - 20)), HasSubstr("no matrix \"dataInfo\""));
  EXPECT_THAT(fault(whole.substr(0, whole.size() - 8)), HasSubstr("of which the file can hold"));
  EXPECT_THAT(fault(Simulation().Bytes("binWrong")), HasSubstr("neither binTrans nor binNormal"));
  EXPECT_THAT(fault(Simulation().Bytes("binNormal")), HasSubstr("dataInfo"));
  Simulation far;
  far.variables[3].place = 4;
  EXPECT_THAT(fault(far.Bytes()), HasSubstr("\"tau\" is signal 4 of the 3 in data_2"));
  far.variables[3] = {"tau", "", 3, 1};
  EXPECT_THAT(fault(far.Bytes()), HasSubstr("no matrix \"data_3\""));
  far.variables[3] = {"tau", "", -1, 1};
  EXPECT_THAT(fault(far.Bytes()), HasSubstr("in data_-1"));
}

}  // namespace
}  // namespace dynoproof::trace
