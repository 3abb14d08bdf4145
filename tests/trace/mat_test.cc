// MAT files in all three versions, written here by libmatio, and what is no record.
#include "trace/mat.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/support/temp_dir.h"
#include "trace/hdf5.h"

namespace dynoproof::trace {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

struct Version {
  mat_ft type;
  const char* name;
};

class MatFile : public ::testing::Test {
 protected:
  void SetUp() override { file_ = dir_ / "record.mat"; }

  /// Writes one more variable.
  void Write(const char* name, matio_classes kind, matio_types type, std::vector<std::size_t> extents, void* data,
             int options = 0, mat_ft version = MAT_FT_MAT5) {
    const hdf5::Session session;
    mat_t* file = fs::exists(file_) ? Mat_Open(file_.string().c_str(), MAT_ACC_RDWR)
                                    : Mat_CreateVer(file_.string().c_str(), nullptr, version);
    ASSERT_NE(file, nullptr);
    matvar_t* variable =
        Mat_VarCreate(name, kind, type, static_cast<int>(extents.size()), extents.data(), data, options);
    ASSERT_NE(variable, nullptr);
    EXPECT_EQ(Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
    Mat_Close(file);
  }
  void WriteNumbers(const char* name, std::vector<std::size_t> extents, std::vector<double> values,
                    mat_ft version = MAT_FT_MAT5) {
    Write(name, MAT_C_DOUBLE, MAT_T_DOUBLE, std::move(extents), values.data(), 0, version);
  }
  std::vector<double> Values(const Record& record, const char* name) const {
    const auto column = record.Find(name);
    return column ? record.columns[*column].values : std::vector<double>{-999.0};
  }

  test::TempDir dir_;
  fs::path file_;
};

class MatVersions : public MatFile, public ::testing::WithParamInterface<Version> {};

TEST_P(MatVersions, VectorsAndColumnsOfMatricesAreRead) {
  const mat_ft version = GetParam().type;
  WriteNumbers("t", {1, 3}, {0.0, 0.1, 0.2}, version);
  WriteNumbers("x_F", {3, 2}, {1.0, 2.0, 3.0, -4.0, std::nan(""), -6.0}, version);  // by columns
  std::vector<float> single = {0.5F, 1.5F, 2.5F};
  Write("s", MAT_C_SINGLE, MAT_T_SINGLE, {3, 1}, single.data());
  std::vector<std::int16_t> whole = {-7, 8, 32000};
  Write("n", MAT_C_INT16, MAT_T_INT16, {3, 1}, whole.data());
  const Result<Record> record = ReadMat(file_);
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), ::testing::IsSupersetOf({"t", "x_F[0]", "x_F[1]", "s"}));
  EXPECT_THAT(Values(*record, "x_F[0]"), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(Values(*record, "s"), ElementsAre(0.5, 1.5, 2.5));
  EXPECT_THAT(Values(*record, "n"), ElementsAre(-7.0, 8.0, 32000.0));
  EXPECT_EQ(record->time, record->Find("t"));
  ASSERT_EQ(record->non_finite.size(), 1U);
  EXPECT_EQ(record->non_finite[0].first_row, 1U);
}

TEST_P(MatVersions, AMatrixThatIsWiderThanHighHasASignalInEachRow) {
  const mat_ft version = GetParam().type;
  WriteNumbers("t", {1, 4}, {0.0, 0.1, 0.2, 0.3}, version);
  WriteNumbers("X", {3, 4}, {1.0, 5.0, 9.0, 2.0, 6.0, 10.0, 3.0, 7.0, 11.0, 4.0, 8.0, 12.0}, version);  // by columns
  WriteNumbers("square", {2, 2}, {1.0, 2.0, 3.0, 4.0}, version);
  const Result<Record> record = ReadMat(file_);
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), ::testing::UnorderedElementsAre("t", "X[0]", "X[1]", "X[2]", "square[0]", "square[1]"));
  EXPECT_THAT(Values(*record, "X[0]"), ElementsAre(1.0, 2.0, 3.0, 4.0));
  EXPECT_THAT(Values(*record, "X[2]"), ElementsAre(9.0, 10.0, 11.0, 12.0));
  EXPECT_EQ(record->columns[*record->Find("X[1]")].time, record->Find("t"));
  EXPECT_THAT(Values(*record, "square[0]"), ElementsAre(1.0, 2.0)) << "which side is longer cannot be said";
  ASSERT_EQ(record->notes.size(), 1U);
  EXPECT_THAT(record->notes[0], HasSubstr("\"X\" is 3 x 4: its rows are the columns \"X[0]\" to \"X[2]\""));
}

TEST_P(MatVersions, AFileThatWasCutIsRefused) {
  std::vector<double> values(400);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(0.1 * static_cast<double>(i));
  WriteNumbers("a", {400, 1}, values, GetParam().type);
  WriteNumbers("b", {200, 2}, values, GetParam().type);
  ASSERT_TRUE(ReadMat(file_).ok());
  const auto size = fs::file_size(file_);
  for (const double share : {0.97, 0.6, 0.4, 0.1, 0.01}) {
    fs::resize_file(file_, static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    const Result<Record> record = ReadMat(file_);
    ASSERT_FALSE(record.ok()) << share;
    EXPECT_EQ(record.failure().exit_code, 2);
    EXPECT_FALSE(record.failure().message.empty());
  }
  fs::resize_file(file_, 0);
  EXPECT_THAT(ReadMat(file_).failure().message, HasSubstr("empty"));
}

INSTANTIATE_TEST_SUITE_P(Mat, MatVersions,
                         ::testing::Values(Version{MAT_FT_MAT4, "v4"}, Version{MAT_FT_MAT5, "v5"},
                                           Version{MAT_FT_MAT73, "v73"}),
                         [](const auto& version) { return std::string(version.param.name); });

TEST_F(MatFile, WhatIsNoColumnIsLeftOutWithTheReason) {
  std::vector<double> numbers = {1.0, 2.0, 3.0}, imaginary = {0.0, 1.0, 0.0};
  WriteNumbers("x", {3, 1}, numbers);
  mat_complex_split_t both = {numbers.data(), imaginary.data()};
  Write("z", MAT_C_DOUBLE, MAT_T_DOUBLE, {3, 1}, &both, MAT_F_COMPLEX);
  std::string text = "hello";
  Write("name", MAT_C_CHAR, MAT_T_UTF8, {1, 5}, text.data());
  Write("nothing", MAT_C_DOUBLE, MAT_T_DOUBLE, {0, 0}, nullptr);
  WriteNumbers("cube", {2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, 8});
  Write("c", MAT_C_CELL, MAT_T_CELL, {0, 1}, nullptr);
  matvar_t* empty = nullptr;
  Write("s", MAT_C_STRUCT, MAT_T_STRUCT, {1, 1}, &empty);
  const Result<Record> record = ReadMat(file_);
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), ElementsAre("x"));
  std::map<std::string, std::string> reasons(record->left_out.begin(), record->left_out.end());
  EXPECT_THAT(reasons["z"], HasSubstr("complex"));
  EXPECT_THAT(reasons["name"], HasSubstr("text"));
  EXPECT_THAT(reasons["nothing"], HasSubstr("empty"));
  EXPECT_THAT(reasons["cube"], HasSubstr("dimensions"));
  EXPECT_THAT(reasons["c"], HasSubstr("cell"));
  EXPECT_THAT(reasons["s"], HasSubstr("struct"));
}

TEST_F(MatFile, AnObjectSaysHowToExportIt) {
  WriteNumbers("x", {3, 1}, {1.0, 2.0, 3.0});
  // The class in the array flags of the only matrix: 17 is what MATLAB writes for a timetable.
  std::fstream file(file_, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(128 + 16);
  file.put(17);
  file.close();
  const Result<Record> record = ReadMat(file_);
  ASSERT_FALSE(record.ok());
  EXPECT_EQ(record.failure().exit_code, 2);
  EXPECT_THAT(record.failure().message, HasSubstr("writetimetable"));
}

TEST_F(MatFile, AnythingElseIsNoMatFile) {
  std::ofstream(file_) << "t,x\n0,1\n1,2\n2,3\n" << std::string(500, 'x');
  EXPECT_EQ(ReadMat(file_).failure().exit_code, 2);
  EXPECT_THAT(ReadMat(dir_ / "none.mat").failure().message, HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace dynoproof::trace
