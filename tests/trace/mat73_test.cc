// MAT v7.3 as programs in Python write it, and as MATLAB does.
#include "trace/mat73.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <map>
#include <vector>

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

/// The place of what stands in the file as "n, m, n, m": the extents of a dataset and the most that they may become.
std::size_t ExtentsIn(const std::string& bytes, std::uint64_t n, std::uint64_t m) {
  return bytes.find(test::Raw(std::vector<std::uint64_t>{n, m, n, m}));
}

TEST_F(Mat73, ExtentsAreThoseThatTheVariableWasGiven) {
  for (const std::vector<hsize_t>& chunk : {std::vector<hsize_t>{}, std::vector<hsize_t>{1, 40}}) {
    {
      Hdf5File file(file_, kUserBlock);
      file.Numbers("x", test::Wave(101), {.shape = {1, 101}, .chunk = chunk, .deflate = !chunk.empty()});
      file.Text("x", "MATLAB_class", "double");
    }
    ASSERT_TRUE(Read().ok());
    const std::string whole = test::ReadBytes(file_);
    const std::size_t at = ExtentsIn(whole, 1, 101);
    ASSERT_NE(at, std::string::npos);
    // Within the last piece, so that the count of pieces does not tell; and fewer than there are, down to none.
    for (const int extent : {117, 103, 100, 97, 0}) {
      std::string bytes = whole;
      bytes[at + 8] = static_cast<char>(extent);
      const Result<Record> record = ReadMat(dir_.Write("damaged.mat", bytes));
      ASSERT_FALSE(record.ok()) << extent;
      EXPECT_EQ(record.failure().exit_code, 2);
      EXPECT_THAT(record.failure().message, HasSubstr("variable \"x\" has extents")) << extent;
    }
  }
}

TEST_F(Mat73, AnUnlimitedExtentIsNoFault) {
  {
    Hdf5File file(file_, kUserBlock);
    const hid_t plist = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t now = 3, most = H5S_UNLIMITED, chunk = 2;
    H5Pset_chunk(plist, 1, &chunk);
    const hid_t space = H5Screate_simple(1, &now, &most);
    const hid_t set = H5Dcreate2(file.id(), "x", H5T_IEEE_F64LE, space, H5P_DEFAULT, plist, H5P_DEFAULT);
    const double values[] = {1, 2, 3};
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(plist);
  }
  const Result<Record> record = Read();
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(Values(*record, "x"), ElementsAre(1, 2, 3));
}

TEST_F(Mat73, NoVariableGetsTheNumbersOfItsNeighbour) {
  std::uint64_t a = 0, b = 0;
  {
    Hdf5File file(file_, kUserBlock);
    file.Numbers("torque_a", {1, 2, 3});
    file.Numbers("torque_b", {4, 5, 6});
    H5O_info_t info = {};
    H5Oget_info_by_name2(file.id(), "torque_a", &info, H5O_INFO_BASIC, H5P_DEFAULT);
    a = info.addr;
    H5Oget_info_by_name2(file.id(), "torque_b", &info, H5O_INFO_BASIC, H5P_DEFAULT);
    b = info.addr;
  }
  ASSERT_TRUE(Read().ok());
  const std::string whole = test::ReadBytes(file_);
  const auto damaged = [&](const std::string& from, const std::string& to) {
    std::string bytes = whole;
    const std::size_t at = bytes.find(from);
    EXPECT_NE(at, std::string::npos);
    bytes.replace(at, from.size(), to);
    const Result<Record> record = ReadMat(dir_.Write("damaged.mat", bytes));
    EXPECT_FALSE(record.ok());
    return record.ok() ? "" : record.failure().message;
  };
  EXPECT_THAT(damaged("torque_b", "torque_a"), HasSubstr("the name \"torque_a\" stands there twice"));
  // A name leads to an object by its address.
  EXPECT_THAT(damaged(test::Raw(std::vector{b}), test::Raw(std::vector{a})),
              HasSubstr("\"torque_a\", \"torque_b\" are one object, which has 1 name"));
}

TEST_F(Mat73, ANameMoreForAnObjectIsNoFault) {
  {
    Hdf5File file(file_, kUserBlock);
    file.Numbers("x", {1, 2, 3});
    H5Lcreate_hard(file.id(), "x", file.id(), "y", H5P_DEFAULT, H5P_DEFAULT);
  }
  const Result<Record> record = Read();
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_EQ(Values(*record, "x"), Values(*record, "y"));
}

TEST_F(Mat73, WhatIsSaidInAnotherFormIsNotTakenAsUnsaid) {
  for (const char* name : {"MATLAB_class", "MATLAB_empty"}) {
    {
      Hdf5File file(file_, kUserBlock);
      file.Numbers("x", {1, 2, 3});
      if (name == std::string("MATLAB_class")) {
        file.Texts("x", name, {"double", "double"});
      } else {
        file.Number("x", name, {1, 1}, H5T_STD_U8LE);
      }
    }
    const Result<Record> record = Read();
    ASSERT_FALSE(record.ok());
    EXPECT_THAT(record.failure().message, HasSubstr(name));
  }
}

TEST_F(Mat73, BytesAreInTheOrderOfTheFile) {
  {
    Hdf5File file(file_, kUserBlock);
    file.Numbers("x", {1, 2, 3});
    file.Text("x", "MATLAB_class", "double");
  }
  ASSERT_TRUE(Read().ok());
  std::string bytes = test::ReadBytes(file_);
  const std::size_t at = bytes.find(std::string("\x11\x20\x3f\x00\x08\x00\x00\x00", 8));  // a float of 8 bytes
  ASSERT_NE(at, std::string::npos);
  bytes[at + 1] = '\x21';
  Result<Record> record = ReadMat(dir_.Write("damaged.mat", bytes));
  ASSERT_FALSE(record.ok());
  EXPECT_THAT(record.failure().message, HasSubstr("variable \"x\": its numbers are not in the order of bytes"));
  bytes.replace(124, 4, std::string("\x02\x00MI", 4));  // whole, from a machine of the other kind
  record = ReadMat(dir_.Write("other.mat", bytes));
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_NE(Values(*record, "x"), (std::vector<double>{1, 2, 3}));
}

TEST_F(Mat73, APieceDoesNotSayThatItIsStoredAsItIs) {
  {
    Hdf5File file(file_, kUserBlock);
    // So few numbers that deflate makes more bytes of them: enough to be taken for the numbers.
    file.Numbers("x", test::Wave(40), {.shape = {1, 40}, .chunk = {1, 40}, .deflate = true});
    file.Text("x", "MATLAB_class", "double");
  }
  ASSERT_TRUE(Read().ok());
  std::string bytes = test::ReadBytes(file_);
  const std::size_t tree =
      bytes.find(std::string("TREE\x01", 5));  // the index of pieces: 24 bytes of head, size, filters
  ASSERT_NE(tree, std::string::npos);
  ASSERT_GT(static_cast<unsigned char>(bytes[tree + 24]) + 256 * bytes[tree + 25], 320);
  bytes[tree + 28] = '\x01';
  const Result<Record> record = ReadMat(dir_.Write("damaged.mat", bytes));
  ASSERT_FALSE(record.ok());
  EXPECT_THAT(record.failure().message, HasSubstr("nothing says that they are packed"));
}

}  // namespace
}  // namespace dynoproof::trace
