// What inputs do between their samples is told by the outputs of their own record.
#include "identification/between_samples.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/estimation/made_record.h"

namespace dynoproof::identification {
namespace {

/// Every n-th sample of a record, as a slower logger keeps them.
MappedRecord Slower(MappedRecord record, std::size_t n) {
  for (auto* signals : {&record.inputs, &record.outputs}) {
    for (auto& [name, series] : *signals) {
      std::vector<double> time, values;
      for (std::size_t i = 0; i < series.time->size(); i += n) {
        time.push_back((*series.time)[i]);
        values.push_back((*series.values)[i]);
      }
      series = {std::make_shared<const std::vector<double>>(std::move(time)),
                std::make_shared<const std::vector<double>>(std::move(values))};
      record.step_s[name] *= static_cast<double>(n);
    }
  }
  return record;
}

// Its inputs hold up to 900 Hz: held for 0.4 ms, they leave the true model three times the noise.
TEST(BetweenSamples, OfAScenarioWithPlayAreChosenAsOfAnyOther) {
  const Plan plan = estimation::Scenario("scenarios/diagnose/backlash.toml", {"run.duration_s=0.8"});
  MappedRecord record = Slower(estimation::RecordOf(plan, 0.005, {"omega_1", "omega_2", "omega_3", "T_m1"}), 4);
  ChooseBetween(plan, testing::BuiltIns(), record);
  EXPECT_EQ(record.between.at("T_1"), "band_limited_held");
  EXPECT_EQ(record.between.at("T_2"), "band_limited_held");
  ASSERT_EQ(record.notes.size(), 1U);
  EXPECT_NE(record.notes[0].find("band_limited_held"), std::string::npos) << record.notes[0];
}

}  // namespace
}  // namespace dynoproof::identification
