#include "trace/hdf5_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>

#include "tests/support/temp_dir.h"
#include "tests/trace/sample_trace.h"
#include "trace/record.h"
#include "trace/trace_io.h"

namespace dynoproof::trace {
namespace {

using test::TempDir;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A file as a logger might leave it: /raw/M [3], /raw/x_F [3][2], /raw/row [1][3], /cube [2][2][2], /label.
std::filesystem::path LoggerFile(const TempDir& dir) {
  const hid_t file = H5Fcreate((dir / "log.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(H5Gcreate2(file, "raw", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  const auto numbers = [&](const char* name, const std::vector<float>& values, const std::vector<hsize_t>& shape) {
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t set = H5Dcreate2(file, name, H5T_IEEE_F32LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Sclose(space);
    return set;
  };
  const hid_t torque = numbers("/raw/M", {1, NAN, 3}, {3});
  const hid_t scalar = H5Screate(H5S_SCALAR), type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, 4);
  const hid_t unit = H5Acreate2(torque, "units", type, scalar, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(unit, type, "kN m");
  H5Aclose(unit);
  H5Dclose(torque);
  H5Dclose(numbers("/raw/x_F", {1, 10, 2, 20, 3, 30}, {3, 2}));
  H5Dclose(numbers("/raw/row", {7, 8, 9}, {1, 3}));
  H5Dclose(numbers("/cube", {1, 2, 3, 4, 5, 6, 7, 8}, {2, 2, 2}));
  H5Dclose(H5Dcreate2(file, "/label", type, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Tclose(type);
  H5Sclose(scalar);
  H5Fclose(file);
  return dir / "log.h5";
}

TEST(Hdf5Record, TraceLayoutKeepsEveryTimeBase) {
  const TempDir dir;
  const Trace trace = SampleTrace();
  ASSERT_EQ(WriteTrace(dir / "a.h5", trace), std::nullopt);
  const Result<Record> record = ReadHdf5Record(dir / "a.h5");
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), ElementsAre("time", "time_1", "T_shaft", "u[0]", "p_ch"));
  EXPECT_EQ(record->time, 0u);
  EXPECT_EQ(record->columns[*record->Find("p_ch")].time, 1u);
  EXPECT_EQ(record->columns[*record->Find("p_ch")].values, trace.signals[2].values);
  EXPECT_EQ(record->columns[*record->Find("T_shaft")].time, 0u);
  EXPECT_EQ(record->columns[*record->Find("T_shaft")].unit, "N m");
  EXPECT_EQ(record->columns[1].time, std::nullopt);
  EXPECT_THAT(record->non_finite, IsEmpty());
}

TEST(Hdf5Record, ATraceSaysWhichSignalsAreHeld) {
  const TempDir dir;
  ASSERT_EQ(WriteTrace(dir / "a.h5", SampleTrace()), std::nullopt);
  const std::vector<std::string> wanted = {"/time", "/signals/u[0]", "/signals/T_shaft"};
  for (const Result<Record>& record : {ReadHdf5Record(dir / "a.h5"), ReadHdf5Record(dir / "a.h5", wanted)}) {
    ASSERT_TRUE(record.ok()) << record.failure().ToString();
    for (const Column& column : record->columns) EXPECT_EQ(column.held, column.name.ends_with("u[0]")) << column.name;
  }
}

TEST(Hdf5Record, TimeBasesOfEqualLengthStayApart) {
  Trace trace = SampleTrace(20);
  trace.other_times[0] = trace.time;
  trace.signals[2].values.resize(20, 1.0);
  const Record record = ToRecord(trace, "memory");
  EXPECT_EQ(record.columns[1].time, std::nullopt);
  EXPECT_EQ(record.columns[*record.Find("p_ch")].time, 1u);
}

TEST(Hdf5Record, DatasetsByPath) {
  const TempDir dir;
  const std::vector<std::string> wanted = {"/raw/M", "/raw/x_F", "/raw/row", "/raw/x_F[1]"};
  const Result<Record> record = ReadHdf5Record(LoggerFile(dir), wanted);
  ASSERT_TRUE(record.ok()) << record.failure().ToString();
  EXPECT_THAT(record->Names(), ElementsAre("/raw/M", "/raw/x_F[0]", "/raw/x_F[1]", "/raw/row", "/raw/x_F[1]"));
  EXPECT_EQ(record->columns[0].unit, "kN m");
  EXPECT_THAT(record->columns[1].values, ElementsAre(1, 2, 3));
  EXPECT_THAT(record->columns[2].values, ElementsAre(10, 20, 30));
  EXPECT_THAT(record->columns[3].values, ElementsAre(7, 8, 9));
  EXPECT_THAT(record->DescribeNonFinite(),
              ElementsAre(AllOf(HasSubstr("/raw/M"), HasSubstr("1 of 3"), HasSubstr("row 1"))));
}

TEST(Hdf5Record, FaultsSayWhatTheFileHas) {
  const TempDir dir;
  const std::filesystem::path path = LoggerFile(dir);
  const auto message = [&](std::vector<std::string> wanted) {
    const Result<Record> record = ReadHdf5Record(path, wanted);
    EXPECT_FALSE(record.ok());
    if (record.ok()) return std::string();
    EXPECT_EQ(record.failure().exit_code, 2);
    EXPECT_THAT(record.failure().signal, HasSubstr("log.h5"));
    return record.failure().message;
  };
  EXPECT_THAT(message({"/raw/N"}), AllOf(HasSubstr("\"/raw/N\""), HasSubstr("/cube, /raw/M, /raw/row, /raw/x_F")));
  EXPECT_THAT(message({"/raw/x_F[2]"}), HasSubstr("has 2 columns"));
  EXPECT_THAT(message({"/cube"}), HasSubstr("2 x 2 x 2"));
  EXPECT_THAT(message({"/label"}), HasSubstr("is text"));
  EXPECT_THAT(message({"/raw"}), HasSubstr("no dataset \"/raw\""));
}

TEST(Hdf5Record, ListsDatasetsOfNumbers) {
  const TempDir dir;
  const Result<std::vector<std::string>> paths = ListHdf5Datasets(LoggerFile(dir));
  ASSERT_TRUE(paths.ok());
  EXPECT_THAT(*paths, ElementsAre("/cube", "/raw/M", "/raw/row", "/raw/x_F"));
}

}  // namespace
}  // namespace dynoproof::trace
