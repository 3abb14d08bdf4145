// MAT v7.3 as programs in Python write it, and as MATLAB does.
#include "trace/mat73.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "tests/support/temp_dir.h"
#include "tests/trace/hdf5_file.h"
#include "tests/trace/mat_bytes.h"
#include "trace/mat.h"

namespace dynoproof::trace {
namespace {

using test::Hdf5File;
using test::Values;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

class Mat73 : public ::testing::Test {
 protected:
  static constexpr hsize_t kUserBlock = 512;
  Result<Record> Read() {
    std::fstream file(file_, std::ios::binary | std::ios::in | std::ios::out);
    file << "MATLAB 7.3 MAT-file, Platform: a test";
    file.seekp(124);
    file << std::string("\x00\x02IM", 4);
    file.close();
    return ReadMat(file_);
  }
  test::TempDir dir_;
  std::filesystem::path file_ = dir_ / "record.mat";
};

TEST_F(Mat73, TheTypeOfTheDatasetSaysThatItHoldsNumbers) {
  {
    Hdf5File file(file_, kUserBlock);
    for (const char* name : {"padded", "absent", "variable"}) file.Numbers(name, {1, 2, 3}, {.shape = {1, 3}});
    file.Text("padded", "MATLAB_class", "double");
    file.Text("variable", "MATLAB_class", "double", /*variable=*/true);
    file.Numbers("t", {0, 1, 2}, {.shape = {3}, .type = H5T_IEEE_F32LE});
    file.Numbers("flag", {0, 1, 1}, {.shape = {3, 1}, .type = H5T_STD_U8LE});
    file.Text("flag", "MATLAB_class", "logical");
  }
  const Result<Record> record = Read();
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), UnorderedElementsAre("padded", "absent", "variable", "t", "flag"));
  for (const char* name : {"padded", "absent", "variable"}) EXPECT_THAT(Values(*record, name), ElementsAre(1, 2, 3));
  EXPECT_THAT(Values(*record, "flag"), ElementsAre(0, 1, 1));
  EXPECT_EQ(record->time, record->Find("t"));
}

TEST_F(Mat73, ExtentsAreTurnedRound) {
  {
    Hdf5File file(file_, kUserBlock);
    // MATLAB's 4 x 2 is [2][4] here: its columns lie one behind the other.
    file.Numbers("X", {1, 2, 3, 4, 10, 20, 30, 40}, {.shape = {2, 4}});
    file.Text("X", "MATLAB_class", "double");
  }
  const Result<Record> record = Read();
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(Values(*record, "X[0]"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(Values(*record, "X[1]"), ElementsAre(10, 20, 30, 40));
}

TEST_F(Mat73, WhatIsNoColumnIsLeftOut) {
  {
    Hdf5File file(file_, kUserBlock);
    file.Numbers("x", {1, 2, 3});
    file.Numbers("words", {104, 105}, {.type = H5T_STD_U16LE});
    file.Text("words", "MATLAB_class", "char");
    file.Numbers("table", {1, 2, 3}, {.type = H5T_STD_U32LE});
    file.Text("table", "MATLAB_class", "timetable");
    file.Number("table", "MATLAB_object_decode", {3}, H5T_STD_I32LE);
    file.Numbers("empty", {0, 0}, {.type = H5T_STD_U64LE});
    file.Text("empty", "MATLAB_class", "double");
    file.Number("empty", "MATLAB_empty", {1}, H5T_STD_U8LE);
    file.Group("s");
    file.Group("#refs#");
    file.Numbers("#refs#/a", {1, 2});
    const hid_t pair = H5Tcreate(H5T_COMPOUND, 16);
    H5Tinsert(pair, "real", 0, H5T_IEEE_F64LE);
    H5Tinsert(pair, "imag", 8, H5T_IEEE_F64LE);
    const hsize_t three = 3;
    const hid_t space = H5Screate_simple(1, &three, nullptr);
    H5Dclose(H5Dcreate2(file.id(), "z", pair, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
    H5Tclose(pair);
  }
  const Result<Record> record = Read();
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), ElementsAre("x"));
  std::map<std::string, std::string> reasons(record->left_out.begin(), record->left_out.end());
  EXPECT_THAT(reasons["words"], HasSubstr("text"));
  EXPECT_THAT(reasons["table"], HasSubstr("writetimetable"));
  EXPECT_THAT(reasons["empty"], HasSubstr("empty"));
  EXPECT_THAT(reasons["s"], HasSubstr("struct"));
  EXPECT_THAT(reasons["z"], HasSubstr("complex"));
  EXPECT_EQ(reasons.size(), 5u);
}

TEST_F(Mat73, WhatTheFileDoesNotHoldIsRefused) {
  {
    Hdf5File file(file_, kUserBlock);
    file.Numbers("x", test::Wave(50), {.shape = {50}, .chunk = {5}, .first = {15}});
  }
  const Result<Record> record = Read();
  ASSERT_FALSE(record.ok());
  EXPECT_EQ(record.failure().exit_code, 2);
  EXPECT_EQ(record.failure().signal, file_.string());
  EXPECT_THAT(record.failure().message, HasSubstr("\"x\" is incomplete: 3 of its 10 pieces"));
}

}  // namespace
}  // namespace dynoproof::trace
