// A text as the reader of text records sees it.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/temp_dir.h"
#include "trace/csv.h"

namespace dynoproof::test {

inline Result<trace::Record> Parse(const std::string& text) {
  const TempDir dir;
  return trace::ReadCsv(dir.Write("record.csv", text));
}

/// The record of a text that must be read; an empty one after a failure.
inline trace::Record Read(const std::string& text) {
  Result<trace::Record> record = Parse(text);
  EXPECT_TRUE(record.ok()) << text << "\n" << (record.ok() ? "" : record.failure().message);
  return record.ok() ? *std::move(record) : trace::Record{};
}

/// What is said of a text that must not be read.
inline std::string MessageOf(const std::string& text) {
  const Result<trace::Record> record = Parse(text);
  EXPECT_FALSE(record.ok()) << text;
  if (record.ok()) return "";
  EXPECT_EQ(record.failure().exit_code, 2);
  EXPECT_THAT(record.failure().signal, ::testing::HasSubstr("record.csv"));
  return record.failure().message;
}

}  // namespace dynoproof::test
