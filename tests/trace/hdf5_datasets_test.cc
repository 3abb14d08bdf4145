// Files of other layouts: every dataset is found, by its path and by its name.
#include "trace/hdf5_datasets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/support/temp_dir.h"
#include "tests/trace/hdf5_file.h"
#include "tests/trace/mat_bytes.h"
#include "trace/hdf5_record.h"

namespace dynoproof::trace {
namespace {

using test::Hdf5File;
using test::Values;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

class OtherLayout : public ::testing::Test {
 protected:
  test::TempDir dir_;
  std::filesystem::path file_ = dir_ / "log.h5";
};

TEST_F(OtherLayout, OneGroupGivesItsNamesAndItsTime) {
  {
    Hdf5File file(file_);
    file.Group("data_group_0");
    file.Numbers("data_group_0/time", {0, 0.1, 0.2});
    file.Numbers("data_group_0/T_airgap", {1, 2, 3});
    file.Text("data_group_0/T_airgap", "units", "kN m");
  }
  const Result<Record> record = ReadHdf5Record(file_);
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), UnorderedElementsAre("time", "T_airgap"));
  EXPECT_THAT(Values(*record, "/data_group_0/T_airgap"), ElementsAre(1, 2, 3)) << "the path finds it too";
  const Column& torque = record->columns[*record->Find("T_airgap")];
  EXPECT_EQ(torque.unit, "kN m");
  EXPECT_EQ(torque.time, record->Find("time"));
  const std::vector<std::string> wanted = {"T_airgap", "/data_group_0/time"};
  const Result<Record> asked = ReadHdf5Record(file_, wanted);
  ASSERT_TRUE(asked.ok()) << asked.failure().ToString();
  EXPECT_EQ(asked->Names(), wanted);
  EXPECT_EQ(asked->columns[0].time, 1u);
  EXPECT_EQ(record->time, record->Find("time"));
}

TEST_F(OtherLayout, EachGroupHasItsOwnTime) {
  {
    Hdf5File file(file_);
    for (const char* group : {"fast", "slow"}) file.Group(group);
    file.Numbers("fast/t", {0, 0.1, 0.2});
    file.Numbers("fast/x", {1, 2, 3});
    file.Numbers("fast/only", {4, 5, 6});
    file.Numbers("slow/t", {0, 1, 2});
    file.Numbers("slow/x", {7, 8, 9});
  }
  const Result<Record> record = ReadHdf5Record(file_);
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), UnorderedElementsAre("/fast/t", "/fast/x", "only", "/slow/t", "/slow/x"));
  EXPECT_EQ(record->columns[*record->Find("/fast/x")].time, record->Find("/fast/t"));
  EXPECT_EQ(record->columns[*record->Find("only")].time, record->Find("/fast/t"));
  EXPECT_EQ(record->columns[*record->Find("/slow/x")].time, record->Find("/slow/t"));
  EXPECT_EQ(record->columns[*record->Find("/slow/t")].time, std::nullopt);
}

TEST_F(OtherLayout, MatricesGiveTheirSignalsWhicheverWayTheyLie) {
  {
    Hdf5File file(file_);
    file.Numbers("high", {1, 10, 2, 20, 3, 30}, {.shape = {3, 2}});
    file.Numbers("wide", {1, 2, 3, 10, 20, 30}, {.shape = {2, 3}});
    file.Numbers("row", {7, 8, 9}, {.shape = {1, 3}});
  }
  const Result<Record> record = ReadHdf5Record(file_);
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), ElementsAre("high[0]", "high[1]", "row", "wide[0]", "wide[1]"));
  EXPECT_THAT(Values(*record, "high[1]"), ElementsAre(10, 20, 30));
  EXPECT_THAT(Values(*record, "/wide[1]"), ElementsAre(10, 20, 30));
  EXPECT_THAT(record->notes, ElementsAre(HasSubstr("\"/wide\" is 2 x 3: its rows are the columns")));
  EXPECT_EQ(record->time, std::nullopt) << "a map may give a rate";
  const std::vector<std::string> wanted = {"/wide[1]", "high[0]", "/wide[0]"};
  const Result<Record> some = ReadHdf5Record(file_, wanted);
  ASSERT_TRUE(some.ok()) << some.failure().ToString();
  EXPECT_THAT(some->Names(), ElementsAre("/wide[1]", "high[0]", "/wide[0]"));
  EXPECT_THAT(some->columns[0].values, ElementsAre(10, 20, 30));
  EXPECT_THAT(some->columns[1].values, ElementsAre(1, 2, 3));
  EXPECT_THAT(some->columns[2].values, ElementsAre(1, 2, 3));
}

TEST_F(OtherLayout, WhatIsNoColumnIsLeftOutWithTheReason) {
  {
    Hdf5File file(file_);
    file.Numbers("x", {1, 2, 3});
    file.Numbers("scalar", {1}, {.shape = {1}});
    file.Numbers("cube", {1, 2, 3, 4, 5, 6, 7, 8}, {.shape = {2, 2, 2}});
    file.Numbers("none", {}, {.shape = {0}});
    file.Numbers("image", std::vector<double>(65 * 70, 1.0), {.shape = {65, 70}});
    file.Numbers("raw", {1, 2, 3});
    file.Number("raw", "gain", {0.5});
    file.Numbers("dim", {}, {.shape = {3}, .write = false});
    file.Text("dim", "NAME", "This is a netCDF dimension but not a netCDF variable.         3");
    H5Lcreate_external("else.h5", "/y", file.id(), "y", H5P_DEFAULT, H5P_DEFAULT);
    const hid_t text = H5Tcopy(H5T_C_S1), point = H5Tcreate(H5T_COMPOUND, 8), truth = H5Tenum_create(H5T_STD_I8LE);
    H5Tinsert(point, "x", 0, H5T_IEEE_F64LE);
    const char yes = 1;
    H5Tenum_insert(truth, "TRUE", &yes);
    const hsize_t three = 3;
    const hid_t space = H5Screate_simple(1, &three, nullptr);
    const std::pair<const char*, hid_t> others[] = {{"text", text}, {"table", point}, {"flags", truth}};
    for (const auto& [name, type] : others) {
      H5Dclose(H5Dcreate2(file.id(), name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      H5Tclose(type);
    }
    H5Sclose(space);
  }
  const Result<Record> record = ReadHdf5Record(file_);
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), ElementsAre("x"));
  std::map<std::string, std::string> reasons(record->left_out.begin(), record->left_out.end());
  EXPECT_THAT(reasons["/scalar"], HasSubstr("single number"));
  EXPECT_THAT(reasons["/cube"], HasSubstr("2 x 2 x 2"));
  EXPECT_THAT(reasons["/none"], HasSubstr("empty"));
  EXPECT_THAT(reasons["/image"], HasSubstr("a matrix of 65 signals"));
  EXPECT_THAT(reasons["/raw"], HasSubstr("\"gain\" says 0.5"));
  EXPECT_THAT(reasons["/dim"], HasSubstr("dimension"));
  EXPECT_THAT(reasons["/text"], HasSubstr("text"));
  EXPECT_THAT(reasons["/table"], HasSubstr("fields"));
  EXPECT_THAT(reasons["/flags"], HasSubstr("truth values"));
  EXPECT_THAT(reasons["/y"], HasSubstr("another file, \"else.h5\""));
  const std::vector<std::string> wanted = {"/y"};
  EXPECT_THAT(ReadHdf5Record(file_, wanted).failure().message, HasSubstr("else.h5"));
}

TEST_F(OtherLayout, DamageOfOneDatasetIsAFaultOfTheFile) {
  {
    Hdf5File file(file_);
    file.Numbers("x", {1, 2, 3});
    file.Numbers("y", {1, 2, 3, 4}, {.shape = {4}, .chunk = {2}, .first = {2}});
  }
  EXPECT_THAT(ReadHdf5Record(file_).failure().message, HasSubstr("dataset \"/y\" is incomplete"));
  const std::vector<std::string> wanted = {"x"};
  EXPECT_TRUE(ReadHdf5Record(file_, wanted).ok()) << "nobody asked for it";
}

TEST_F(OtherLayout, WithoutAnyColumnEachReasonIsSaid) {
  {
    Hdf5File file(file_);
    file.Numbers("scalar", {1}, {.shape = {1}});
  }
  const Result<Record> record = ReadHdf5Record(file_);
  ASSERT_FALSE(record.ok());
  EXPECT_EQ(record.failure().exit_code, 2);
  EXPECT_THAT(record.failure().message, HasSubstr("dataset \"/scalar\" is a single number"));
}

TEST_F(OtherLayout, NoDatasetGetsTheNumbersOfItsNeighbour) {
  std::uint64_t x = 0, y = 0;
  {
    Hdf5File file(file_);
    file.Group("bench");
    file.Numbers("bench/torque_x", {1, 2, 3});
    file.Numbers("torque_y", {4, 5, 6});
    H5O_info_t info = {};
    H5Oget_info_by_name2(file.id(), "bench/torque_x", &info, H5O_INFO_BASIC, H5P_DEFAULT);
    x = info.addr;
    H5Oget_info_by_name2(file.id(), "torque_y", &info, H5O_INFO_BASIC, H5P_DEFAULT);
    y = info.addr;
  }
  std::string bytes = test::ReadBytes(file_);
  const std::string from = test::Words({static_cast<std::uint32_t>(y), 0}),
                    to = test::Words({static_cast<std::uint32_t>(x), 0});
  const std::size_t at = bytes.find(from);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, from.size(), to);
  const Result<Record> record = ReadHdf5Record(dir_.Write("damaged.h5", bytes));
  ASSERT_FALSE(record.ok());
  EXPECT_THAT(record.failure().message, HasSubstr("are one object, which has 1 name"));
}

}  // namespace
}  // namespace dynoproof::trace
