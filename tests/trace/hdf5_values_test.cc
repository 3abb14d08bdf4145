// What a file does not hold is never read as zeros, and nothing is read from another file.
#include "trace/hdf5_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/temp_dir.h"
#include "tests/trace/hdf5_file.h"
#include "tests/trace/mat_bytes.h"
#include "trace/hdf5_record.h"
#include "trace/trace_io.h"

namespace dynoproof::trace {
namespace {

using test::Hdf5File;
using test::Wave;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Hdf5Values : public ::testing::Test {
 protected:
  /// Both ways of reading refuse the file, with the same sentence.
  std::string Fault() {
    const Result<Record> record = ReadHdf5Record(file_);
    const Result<Trace> trace = ReadTrace(file_);
    EXPECT_FALSE(record.ok());
    EXPECT_FALSE(trace.ok());
    if (record.ok() || trace.ok()) return "it was read";
    EXPECT_EQ(record.failure().exit_code, 2);
    EXPECT_EQ(trace.failure().exit_code, 2);
    EXPECT_EQ(record.failure().signal, file_.string());
    EXPECT_EQ(record.failure().message, trace.failure().message);
    return record.failure().message;
  }
  /// A trace's layout with one signal x of 50 values.
  void Write(const test::Hdf5Form& form, const std::vector<double>& values = Wave(50)) {
    Hdf5File file(file_);
    Begin(file);
    file.Numbers("signals/x", values, form);
  }
  static void Begin(Hdf5File& file, std::size_t count = 50) {
    std::vector<double> time(count);
    for (std::size_t i = 0; i < count; ++i) time[i] = 0.001 * static_cast<double>(i);
    file.Numbers("time", time);
    file.Group("signals");
  }

  test::TempDir dir_;
  std::filesystem::path file_ = dir_ / "x.h5";
};

TEST_F(Hdf5Values, MissingPiecesAreAFault) {
  for (const bool deflate : {false, true}) {
    Write({.shape = {50}, .chunk = {5}, .deflate = deflate, .first = {5}});
    EXPECT_THAT(Fault(), AllOf(HasSubstr("/signals/x"), HasSubstr("1 of its 10 pieces")));
    Write({.shape = {50}, .chunk = {5}, .deflate = deflate, .first = {45}});
    EXPECT_THAT(Fault(), HasSubstr("9 of its 10 pieces"));
    Write({.shape = {50}, .chunk = {7}, .deflate = deflate});
    EXPECT_TRUE(ReadTrace(file_).ok()) << "the last piece is not full, but all are there";
  }
  Write({.shape = {50}, .chunk = {5}, .write = false});
  EXPECT_THAT(Fault(), HasSubstr("none are stored"));
}

TEST_F(Hdf5Values, APieceThatStandsElsewhereLeavesAHole) {
  Write({.shape = {50}, .chunk = {5}});
  std::string bytes = test::ReadBytes(file_);
  // The index of pieces: for each its size, its filters, and where it stands, here in elements: 10.
  const std::string key = test::Words({40, 0, 10, 0});
  const std::size_t at = bytes.find(key);
  ASSERT_NE(at, std::string::npos);
  for (const int moved : {5, 15, 20}) {
    bytes[at + 8] = static_cast<char>(moved);
    dir_.Write("x.h5", bytes);
    EXPECT_THAT(Fault(), HasSubstr("/signals/x")) << moved;
  }
}

TEST_F(Hdf5Values, NoBitOfACompressedFileGivesOtherNumbers) {
  // The older format has no checksum over its own tables, only zlib's over each piece.
  {
    Hdf5File file(file_);
    const test::Hdf5Form form = {.shape = {60}, .chunk = {20}, .deflate = true};
    file.Numbers("time", Wave(60, 3.0), form);
    file.Group("signals");
    for (const char* name : {"signals/a", "signals/b"}) file.Numbers(name, Wave(60, 0.1 * name[8]), form);
  }
  const std::string whole = test::ReadBytes(file_);
  const Result<Record> right = ReadHdf5Record(file_);
  ASSERT_TRUE(right.ok()) << right.failure().ToString();
  std::mt19937 random(7);
  int refused = 0;
  for (int k = 0; k < 400; ++k) {
    std::string bytes = whole;
    const std::size_t bit = random() % (8 * bytes.size());
    bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << bit % 8));
    const Result<Record> record = ReadHdf5Record(dir_.Write("y.h5", bytes));
    refused += record.ok() ? 0 : 1;
    for (std::size_t c = 0; record.ok() && c < record->columns.size(); ++c) {
      const auto same = right->Find(record->columns[c].name);  // or a name was hit
      if (same) {
        EXPECT_EQ(record->columns[c].values, right->columns[*same].values) << "bit " << bit;
      }
    }
  }
  EXPECT_GT(refused, 20);
  RecordProperty("refused", refused);
}

TEST_F(Hdf5Values, TwoDatasetsNeverShareBytes) {
  {
    Hdf5File file(file_);
    Begin(file);
    file.Numbers("signals/x", Wave(50));
    file.Numbers("signals/y", Wave(50, 1.0));
  }
  std::string bytes = test::ReadBytes(file_);
  const hid_t file = H5Fopen(file_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  std::vector<std::uint64_t> places;
  for (const char* name : {"signals/x", "signals/y"}) {
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    places.push_back(H5Dget_offset(set));
    H5Dclose(set);
  }
  H5Fclose(file);
  // The address of y, followed by its size, in the description of its storage.
  const std::size_t at = bytes.find(test::Raw(std::vector<std::uint64_t>{places[1], 400}));
  ASSERT_NE(at, std::string::npos);
  for (const std::uint64_t moved : {places[0], places[0] + 8, places[0] - 8}) {
    bytes.replace(at, 8, test::Raw(std::vector<std::uint64_t>{moved}));
    dir_.Write("x.h5", bytes);
    EXPECT_THAT(Fault(), HasSubstr("in the bytes of another dataset"));
  }
}

TEST_F(Hdf5Values, ValuesInOtherFilesAreNotFollowed) {
  dir_.Write("other.raw", std::string(400, 'x'));
  {
    Hdf5File file(file_);
    Begin(file);
    const hsize_t count = 50;
    const hid_t space = H5Screate_simple(1, &count, nullptr), plist = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(plist, (dir_ / "other.raw").c_str(), 0, 400);
    H5Dclose(H5Dcreate2(file.id(), "signals/x", H5T_IEEE_F64LE, space, H5P_DEFAULT, plist, H5P_DEFAULT));
    H5Pclose(plist);
    H5Sclose(space);
  }
  EXPECT_THAT(Fault(), AllOf(HasSubstr("other.raw"), HasSubstr("not followed")));

  Write({});
  const std::filesystem::path whole = dir_ / "whole.h5";
  std::filesystem::rename(file_, whole);
  {
    Hdf5File file(file_);
    Begin(file);
    H5Lcreate_external(whole.c_str(), "/signals/x", file.id(), "signals/x", H5P_DEFAULT, H5P_DEFAULT);
  }
  EXPECT_THAT(Fault(), AllOf(HasSubstr("\"/signals/x\" is a link into another file"), HasSubstr("whole.h5")));
  {
    Hdf5File file(file_);
    Begin(file);
    H5Lcreate_external(whole.c_str(), "/signals", file.id(), "others", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/others/x", file.id(), "signals/x", H5P_DEFAULT, H5P_DEFAULT);
  }
  EXPECT_FALSE(ReadTrace(file_).ok()) << "a link of this file that leads through one into another";
  {
    Hdf5File file(file_);
    Begin(file);
    file.Numbers("elsewhere", Wave(50));
    H5Lcreate_soft("/elsewhere", file.id(), "signals/x", H5P_DEFAULT, H5P_DEFAULT);
  }
  EXPECT_TRUE(ReadTrace(file_).ok()) << "a link within the file";
  {
    Hdf5File file(file_);
    Begin(file);
    const hsize_t count = 50;
    const hid_t space = H5Screate_simple(1, &count, nullptr), plist = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_virtual(plist, space, whole.c_str(), "/signals/x", space);
    H5Dclose(H5Dcreate2(file.id(), "signals/x", H5T_IEEE_F64LE, space, H5P_DEFAULT, plist, H5P_DEFAULT));
    H5Pclose(plist);
    H5Sclose(space);
  }
  EXPECT_THAT(Fault(), HasSubstr("/signals/x"));
}

TEST_F(Hdf5Values, WhatIsBeyondTheLimitIsRefusedBeforeItIsUnpacked) {
  const hsize_t most = hdf5::kMostBytes / sizeof(double);
  for (const hsize_t count : {most + 1, hsize_t{1} << 40, hsize_t{1} << 61}) {
    Write({.shape = {count}, .chunk = {5}, .first = {5}});
    EXPECT_THAT(Fault(), HasSubstr("promises")) << count;
  }
  // One piece of zeros: 1 MB in the file, more than the limit as doubles.
  {
    Hdf5File file(file_);
    Begin(file, 3);
    const hsize_t count = 300'000'000, chunk = 100'000'000;
    const hid_t space = H5Screate_simple(1, &count, nullptr), plist = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(plist, 1, &chunk);
    H5Pset_deflate(plist, 1);
    const hid_t set = H5Dcreate2(file.id(), "signals/x", H5T_STD_I8LE, space, H5P_DEFAULT, plist, H5P_DEFAULT);
    H5Dclose(set);
    H5Pclose(plist);
    H5Sclose(space);
  }
  EXPECT_THAT(Fault(), HasSubstr("promises 300000000 values"));
}

TEST_F(Hdf5Values, ExtentsThatDifferFromWhatIsStoredAreAFault) {
  Write({});
  const std::string whole = test::ReadBytes(file_);
  // The layout message of x: contiguous, its address, then its size in bytes; and its extent elsewhere.
  std::size_t found = 0;
  for (std::size_t at = whole.find(test::Words({400, 0})); at != std::string::npos;
       at = whole.find(test::Words({400, 0}), at + 1)) {
    for (const int size : {392, 408}) {
      std::string bytes = whole;
      bytes.replace(at, 4, test::Words({static_cast<std::uint32_t>(size)}));
      dir_.Write("x.h5", bytes);
      const Result<Trace> trace = ReadTrace(file_);
      if (!trace.ok() && trace.failure().message.find("bytes are stored") != std::string::npos) ++found;
    }
  }
  EXPECT_GE(found, 2u);
}

TEST_F(Hdf5Values, NoExtentPassesItsOwnMaximum) {
  Write({.shape = {50}, .chunk = {20}});
  std::string bytes = test::ReadBytes(file_);
  const std::size_t at = bytes.rfind(test::Words({50, 0, 50, 0}));  // the time has the same extents
  ASSERT_NE(at, std::string::npos);
  for (const int extent : {51, 60}) {  // what the last piece has room for
    bytes[at] = static_cast<char>(extent);
    dir_.Write("x.h5", bytes);
    EXPECT_THAT(Fault(), HasSubstr("of which at most 50 are possible")) << extent;
  }
}

TEST_F(Hdf5Values, FiltersThatWereLeftOutAreThoseThatMayBe) {
  // Values shuffled and packed; shuffled and with a checksum.
  for (const bool deflate : {false, true}) {
    {
      Hdf5File file(file_);
      Begin(file);
      const hid_t plist = H5Pcreate(H5P_DATASET_CREATE);
      const hsize_t extent = 50;
      H5Pset_chunk(plist, 1, &extent);
      H5Pset_shuffle(plist);
      if (deflate) {
        H5Pset_deflate(plist, 6);
      } else {
        H5Pset_fletcher32(plist);
      }
      const hid_t space = H5Screate_simple(1, &extent, nullptr);
      const hid_t set = H5Dcreate2(file.id(), "signals/x", H5T_IEEE_F64LE, space, H5P_DEFAULT, plist, H5P_DEFAULT);
      H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, Wave(50).data());
      H5Dclose(set);
      H5Sclose(space);
      H5Pclose(plist);
    }
    ASSERT_TRUE(ReadTrace(file_).ok());
    std::string bytes = test::ReadBytes(file_);
    const std::size_t tree = bytes.find(std::string("TREE\x01", 5));
    ASSERT_NE(tree, std::string::npos);
    bytes[tree + 28] = '\x01';
    dir_.Write("x.h5", bytes);
    EXPECT_THAT(Fault(), HasSubstr("only some of its 2 filters were applied"));
  }
}

TEST_F(Hdf5Values, TypesThatNoProgramWritesAreRefused) {
  // Of 32 bits with an exponent of IEEE 754 but another bias: a changed bit in the type's description.
  const hid_t odd = H5Tcopy(H5T_IEEE_F32LE), narrow = H5Tcopy(H5T_STD_I32LE);
  H5Tset_ebias(odd, 126);
  H5Tset_precision(narrow, 12);
  for (const hid_t type : {odd, narrow}) {
    Write({.type = type});
    EXPECT_THAT(Fault(), HasSubstr("numbers of an unusual form"));
    H5Tclose(type);
  }
  const std::vector<double> whole = {-3, 0, 7};
  const hid_t half = H5Tcopy(H5T_IEEE_F32LE);
  H5Tset_fields(half, 15, 10, 5, 0, 10);
  H5Tset_size(half, 2);
  H5Tset_ebias(half, 15);
  for (const hid_t type : {H5T_STD_I8LE, H5T_STD_I64BE, H5T_IEEE_F32BE, H5T_NATIVE_LDOUBLE, half}) {
    Hdf5File file(file_);
    Begin(file, 3);
    file.Numbers("signals/x", whole, {.type = type});
    H5Fflush(file.id(), H5F_SCOPE_GLOBAL);
    const Result<Trace> trace = ReadTrace(file_);
    ASSERT_TRUE(trace.ok()) << trace.failure().ToString();
    EXPECT_THAT(trace->signals[0].values, ElementsAre(-3, 0, 7));
  }
  H5Tclose(half);
}

}  // namespace
}  // namespace dynoproof::trace
