// The hardware-in-the-loop engine from outside: grid operation, and a measured cylinder pressure in
// place of the synthetic one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/program.h"
#include "trace/csv_write.h"
#include "trace/trace_io.h"

namespace dynoproof::test {
namespace {

TEST(EngineFromOutside, GridHoldsTheSpeed) {
  const Bench bench;
  const Outcome run = bench.Call({"run", "pressure/hil_load_step", "--set", "part.train.operation=\"grid\"", "--set",
                                  "run.duration_s=0.3", "--set", "check=[]"});
  EXPECT_EQ(run.exit, 1) << run.Both() << "no checks: nothing was compared";
  const auto trace = trace::ReadTrace(bench / "out/pressure/hil_load_step.h5");
  ASSERT_TRUE(trace.ok());
  for (const double speed : trace->Find("speed")->values) ASSERT_EQ(speed, trace->Find("speed")->values.front());
}

TEST(EngineFromOutside, AMeasuredPressureTakesThePlaceOfTheSyntheticOne) {
  const Bench bench;
  std::vector<double> time, pressure, work;
  for (int k = 0; k <= 30; ++k) {
    time.push_back(0.01 * k);
    pressure.push_back(5.3e5 + 1e3 * k);
    work.push_back(2.8e4);
  }
  const std::vector<trace::Column> columns = {{.name = "t", .unit = "s", .values = time},
                                              {.name = "p_evo", .unit = "Pa", .values = pressure},
                                              {.name = "work", .unit = "J", .values = work}};
  ASSERT_FALSE(trace::WriteCsv(bench / "record.csv", columns));
  const Outcome run = bench.Call({"run", "pressure/hil_load_step", "--data", "record.csv"});
  EXPECT_EQ(run.exit, 4) << run.Both() << "inputs alone: nothing to compare";
  const auto trace = trace::ReadTrace(bench / "out/pressure/hil_load_step.h5");
  ASSERT_TRUE(trace.ok());
  const std::vector<double>& driven = trace->Find("p_evo")->values;
  for (std::size_t k = 0; k < driven.size(); ++k) ASSERT_EQ(driven[k], pressure[std::min<std::size_t>(k / 100, 30)]);
}

}  // namespace
}  // namespace dynoproof::test
