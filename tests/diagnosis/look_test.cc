// Which pictures a page has of a record beside its simulation.
#include "diagnosis/look.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/estimation/made_record.h"

namespace dynoproof::diagnosis {
namespace {

bool HasSpectrum(const MappedRecord& record) {
  const Result<std::vector<Picture>> pictures =
      Look(estimation::HeldMotor(20), {record}, Diagnosis(), testing::BuiltIns());
  EXPECT_TRUE(pictures.ok() && !pictures->empty());
  return std::ranges::any_of(*pictures, [](const Picture& one) { return one.key == "spectrum:F"; });
}

TEST(Look, ShowsASpectrumOnlyOfWhatHasOne) {
  const Plan cogging =
      estimation::WithEffect(estimation::HeldMotor(20), "torque_ripple", "inertia:rotor", {0.1, 30.0, 0.5});
  MappedRecord record = estimation::RecordOf(cogging, 0.05, {"F"});
  EXPECT_TRUE(HasSpectrum(record));
  std::vector<double> time, values;  // a logger that waits ever longer
  const Series even = record.outputs.at("F");
  for (std::size_t i = 0, step = 1; i < even.time->size(); i += step, step = 1 + i / 100) {
    time.push_back((*even.time)[i]);
    values.push_back((*even.values)[i]);
  }
  record.outputs["F"] = {std::make_shared<const std::vector<double>>(time),
                         std::make_shared<const std::vector<double>>(values)};
  EXPECT_FALSE(HasSpectrum(record));
}

}  // namespace
}  // namespace dynoproof::diagnosis
