// Records longer than a diagnosis looks at.
#include <gtest/gtest.h>

#include "diagnosis/diagnose.h"
#include "tests/identification/made_record.h"

namespace dynoproof::diagnosis {
namespace {

MappedRecord Silent(std::size_t rows) {
  MappedRecord record;
  const auto time = Shared(Times(rows)), values = Shared(std::vector<double>(rows, 1.0));
  record.inputs["u"] = {time, values};
  record.outputs["a"] = {time, values};
  record.outputs["b"] = {time, values};
  record.end_s = time->back();
  return record;
}

TEST(KeepTo, CutsAllRecordsToTheSameShareAndSaysSo) {
  std::vector<MappedRecord> records = {Silent(3001), Silent(1001)};
  const std::string note = KeepTo(4002, records);
  EXPECT_EQ(note, "only the first 50 % of the records are looked at: of 8004 samples no more than 4002");
  EXPECT_DOUBLE_EQ(records[0].end_s, 0.15);
  EXPECT_EQ(records[0].outputs.at("a").values->size(), 1501u);
  EXPECT_EQ(records[0].inputs.at("u").time->size(), 1501u);
  EXPECT_EQ(records[1].outputs.at("b").time->size(), 501u);
}

TEST(KeepTo, LeavesWhatIsShortEnough) {
  std::vector<MappedRecord> records = {Silent(1001)};
  EXPECT_EQ(KeepTo(2002, records), "");
  EXPECT_EQ(records[0].outputs.at("a").values->size(), 1001u);
}

}  // namespace
}  // namespace dynoproof::diagnosis
