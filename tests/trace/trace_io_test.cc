#include "trace/trace_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <malloc.h>

#include <bit>
#include <chrono>
#include <cstring>
#include <thread>

#include "tests/support/temp_dir.h"
#include "tests/trace/sample_trace.h"
#include "trace/hdf5.h"

namespace dynoproof::trace {
namespace {

using test::ReadBytes;
using test::TempDir;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

bool SameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(TraceIo, RoundTripIsBitExactAtEveryLevel) {
  const TempDir dir;
  for (const int level : {-1, 0, 1, 9}) {
    // More than one chunk of 65536 values, the last one not full.
    for (const std::size_t n : {std::size_t{100}, std::size_t{70001}}) {
      const Trace trace = SampleTrace(n);
      ASSERT_EQ(WriteTrace(dir / "a.h5", trace, {level}), std::nullopt);
      const Result<Trace> back = ReadTrace(dir / "a.h5");
      ASSERT_TRUE(back.ok()) << back.failure().ToString();
      EXPECT_TRUE(*back == trace);
      EXPECT_TRUE(SameBits(back->time, trace.time));
      for (std::size_t i = 0; i < trace.signals.size(); ++i) {
        EXPECT_TRUE(SameBits(back->signals[i].values, trace.signals[i].values)) << trace.signals[i].name;
      }
    }
  }
}

TEST(TraceIo, OrderOfSignalsAndProvenanceSurvives) {
  const TempDir dir;
  Trace trace = SampleTrace();
  const Signal model = trace.signals[0];
  trace.provenance = {};
  for (int i = 0; i < 100; ++i) {  // more than HDF5 keeps in one header, in an order that is not that of the names
    trace.signals.push_back(model);
    trace.signals.back().name = "s" + std::to_string((i * 37) % 100);
    trace.provenance.Set("key" + std::to_string((i * 37) % 100), std::string(static_cast<std::size_t>(i * 40), 'x'));
  }
  ASSERT_EQ(WriteTrace(dir / "a.h5", trace), std::nullopt);
  const Result<Trace> back = ReadTrace(dir / "a.h5");
  ASSERT_TRUE(back.ok()) << back.failure().ToString();
  EXPECT_TRUE(*back == trace);
}

TEST(TraceIo, ScenarioMayBeLongOrEmpty) {
  const TempDir dir;
  for (const std::size_t length : {std::size_t{0}, std::size_t{300000}}) {
    Trace trace = SampleTrace();
    trace.scenario = std::string(length, '#');
    ASSERT_EQ(WriteTrace(dir / "a.h5", trace), std::nullopt);
    const Result<Trace> back = ReadTrace(dir / "a.h5");
    ASSERT_TRUE(back.ok()) << back.failure().ToString();
    EXPECT_EQ(back->scenario, trace.scenario);
  }
}

TEST(TraceIo, EqualTracesGiveEqualBytes) {
  Trace trace = SampleTrace(70001);
  for (int i = 0; i < 60; ++i) {
    trace.signals.push_back(trace.signals[2]);
    trace.signals.back().name = "s" + std::to_string(i);
    trace.provenance.SetCounter("counter" + std::to_string(i), i);
  }
  for (const int level : {0, 1}) {
    const Result<std::vector<std::byte>> first = ToImage(trace, {level});
    ASSERT_TRUE(first.ok()) << first.failure().ToString();
    // Fresh memory full of other rubbish shows bytes that nobody has set.
    mallopt(M_PERTURB, 0x5A);
    const Result<std::vector<std::byte>> second = ToImage(trace, {level});
    mallopt(M_PERTURB, 0);
    ASSERT_TRUE(second.ok());
    EXPECT_TRUE(*first == *second);
    // HDF5 keeps times in whole seconds: let one pass.
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    const Result<std::vector<std::byte>> third = ToImage(trace, {level});
    ASSERT_TRUE(third.ok());
    EXPECT_TRUE(*first == *third);
  }
}

TEST(TraceIo, WrittenFileHoldsTheImageAndNothingElseIsLeft) {
  const TempDir dir;
  ASSERT_EQ(WriteTrace(dir / "backlash/deep/a.h5", SampleTrace()), std::nullopt);
  const Result<std::vector<std::byte>> image = ToImage(SampleTrace());
  ASSERT_TRUE(image.ok());
  const std::string bytes = ReadBytes(dir / "backlash/deep/a.h5");
  ASSERT_EQ(bytes.size(), image->size());
  EXPECT_EQ(std::memcmp(bytes.data(), image->data(), bytes.size()), 0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir / "backlash/deep"), {}), 1);
}

// The layout as others will read it: with the C library alone.
TEST(TraceIo, LayoutIsTheDocumentedOne) {
  const TempDir dir;
  ASSERT_EQ(WriteTrace(dir / "a.h5", SampleTrace()), std::nullopt);
  const hid_t file = H5Fopen((dir / "a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const auto text_attribute = [&](const char* object, const char* name) {
    const hid_t attribute = H5Aopen_by_name(file, object, name, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute < 0) return std::string("missing");
    const hid_t type = H5Aget_type(attribute);
    EXPECT_EQ(H5Tget_class(type), H5T_STRING);
    EXPECT_EQ(H5Tget_cset(type), H5T_CSET_UTF8);
    std::string text(H5Tget_size(type), '\0');
    H5Aread(attribute, type, text.data());
    H5Tclose(type);
    H5Aclose(attribute);
    return text;
  };
  const auto length = [&](const char* name) {
    const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    const hid_t type = H5Dget_type(dataset);
    EXPECT_GT(H5Tequal(type, H5T_IEEE_F64LE), 0) << name;
    const hid_t space = H5Dget_space(dataset);
    EXPECT_EQ(H5Sget_simple_extent_ndims(space), 1) << name;
    const hssize_t points = H5Sget_simple_extent_npoints(space);
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(dataset);
    return points;
  };
  EXPECT_EQ(length("/time"), 100);
  EXPECT_EQ(length("/time_1"), 10);
  EXPECT_EQ(length("/signals/T_shaft"), 100);
  EXPECT_EQ(length("/signals/p_ch"), 10);
  EXPECT_EQ(text_attribute("/signals/T_shaft", "unit"), "N m");
  EXPECT_EQ(text_attribute("/signals/u[0]", "description"), "command, größer als 0");
  EXPECT_EQ(text_attribute("/signals/u[0]", "interpolation"), "hold");
  EXPECT_EQ(text_attribute("/signals/T_shaft", "interpolation"), "linear");
  EXPECT_EQ(text_attribute("/signals/p_ch", "time"), "/time_1");
  EXPECT_EQ(H5Aexists_by_name(file, "/signals/T_shaft", "time", H5P_DEFAULT), 0);
  EXPECT_EQ(text_attribute("/provenance", "version"), "0.1.0");
  double nominal = 0.0;
  hid_t attribute = H5Aopen_by_name(file, "/signals/T_shaft", "nominal", H5P_DEFAULT, H5P_DEFAULT);
  H5Aread(attribute, H5T_NATIVE_DOUBLE, &nominal);
  EXPECT_EQ(nominal, 1000.0);
  H5Aclose(attribute);
  std::int64_t seed = 0;
  attribute = H5Aopen_by_name(file, "/provenance", "seed", H5P_DEFAULT, H5P_DEFAULT);
  H5Aread(attribute, H5T_NATIVE_INT64, &seed);
  EXPECT_EQ(seed, -7);
  H5Aclose(attribute);
  // Nothing besides what was given, and no object knows when it was made.
  H5G_info_t info;
  H5Gget_info_by_name(file, "/provenance", &info, H5P_DEFAULT);
  EXPECT_EQ(info.nlinks, 0u);
  H5O_info_t object;
  for (const char* name : {"/", "/time", "/time_1", "/signals", "/signals/T_shaft", "/scenario", "/provenance"}) {
    ASSERT_GE(H5Oget_info_by_name2(file, name, &object, H5O_INFO_ALL, H5P_DEFAULT), 0) << name;
    EXPECT_EQ(object.atime | object.mtime | object.ctime | object.btime, 0) << name;
    if (std::string_view(name) == "/provenance") {
      EXPECT_EQ(object.num_attrs, 5u);
    }
  }
  H5Fclose(file);
}

TEST(TraceIo, RefusesToWriteWhatIsNotFinite) {
  const TempDir dir;
  Trace trace = SampleTrace();
  trace.signals[2].values[3] = std::nan("");
  trace.provenance.Set("date", "today");
  const Status status = WriteTrace(dir / "a.h5", trace);
  ASSERT_TRUE(status);
  EXPECT_EQ(status->exit_code, 3);
  EXPECT_THAT(status->signal, HasSubstr("a.h5"));
  EXPECT_THAT(status->message, AllOf(HasSubstr("\"p_ch\""), HasSubstr("row 3"), HasSubstr("no date")));
  EXPECT_THAT(dir.Names(), ElementsAre());
}

TEST(TraceIo, LongAttributesAreNotCut) {
  const TempDir dir;
  Trace trace = SampleTrace();
  trace.signals[0].description = std::string(1 << 17, 'x');  // beyond the 64 kB of one header message
  trace.provenance.Set("libraries", std::string(1 << 17, 'y'));
  ASSERT_EQ(WriteTrace(dir / "a.h5", trace), std::nullopt);
  const Result<Trace> back = ReadTrace(dir / "a.h5");
  ASSERT_TRUE(back.ok()) << back.failure().ToString();
  EXPECT_TRUE(*back == trace);
}

TEST(TraceIo, ErrorsOfTheLibraryAreNotPrinted) {
  const TempDir dir;
  testing::internal::CaptureStderr();
  EXPECT_FALSE(ReadTrace(dir.Write("a.h5", "\x89HDF\r\n\x1a\n and then nothing")).ok());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace dynoproof::trace
