#include "reduce/short_form.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "scenario/load.h"
#include "tests/support/plan_builder.h"

namespace dynoproof::reduce {
namespace {

/// Entries by name: the short form orders them otherwise.
Value Sorted(Value value) {
  if (value.is_array()) {
    for (Value& item : value.array()) item = Sorted(item);
  }
  if (!value.is_table()) return value;
  for (Value::Entry& entry : value.table()) entry.value = Sorted(entry.value);
  std::ranges::sort(value.table(), {}, &Value::Entry::key);
  return value;
}

TEST(ShortForm, ReadsBackAsTheSameTree) {
  for (Value root : {testing::LumpedPlan().root, testing::SoftPlan().root}) {
    root["input"]["T_airgap"]["description"] = Value(std::string(150, 'x'));
    root["check"] =
        Value(Value::Array{Value{{"kind", "a"}, {"origin", std::string(150, 'y')}, {"of", Value{{"b", 1.5}}}},
                           Value{{"kind", "b c"}, {"list", Value(Value::Array{1, 2.0, "\"quoted\""})}}});
    root["plant"]["shaft"]["a key"] = Value{{"deep", Value{{"deeper", std::string(130, 'z')}, {"beside", true}}}};
    const std::string text = ShortForm(root);
    const std::optional<Value> back = FromToml(text);
    ASSERT_TRUE(back) << text;
    EXPECT_EQ(ToToml(Sorted(*back)), ToToml(Sorted(root))) << text;
    EXPECT_LT(LinesOf(text), LinesOf(ToToml(root)));
  }
}

TEST(ShortForm, PutsOnALineWhatFits) {
  const Value root =
      Value{{"run", Value{{"duration_s", 0.5}}}, {"check", Value(Value::Array{Value{{"kind", "golden"}}})}};
  EXPECT_EQ(ShortForm(root), "run = { duration_s = 0.5 }\ncheck = [{ kind = \"golden\" }]\n");
}

TEST(ShortForm, GivesTwoEntriesNoHeading) {
  const std::string of(100, 'x'), type(60, 'y');
  const Value root = Value{{"input", Value{{"u", Value{{"to", of}, {"source", Value{{"type", type}}}}}}}};
  EXPECT_EQ(ShortForm(root), "input.u.to = \"" + of + "\"\ninput.u.source = { type = \"" + type + "\" }\n");
}

TEST(ShortForm, CountsLinesThatHoldSomethingAndValues) {
  EXPECT_EQ(LinesOf("a = 1\n\n[b]\nc = 2\n"), 3U);
  EXPECT_EQ(LinesOf(""), 0U);
  EXPECT_EQ(ValuesOf(Value{{"a", 1}, {"b", Value{{"c", Value(Value::Array{1, 2})}, {"d", "x"}}}}), 4U);
}

}  // namespace
}  // namespace dynoproof::reduce
