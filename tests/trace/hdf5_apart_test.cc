#include "trace/hdf5_apart.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <new>
#include <thread>

#include "tests/support/temp_dir.h"
#include "tests/trace/hdf5_file.h"
#include "tests/trace/mat_bytes.h"
#include "trace/hdf5_record.h"
#include "trace/trace_io.h"

namespace dynoproof::trace {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Numbers = std::vector<double>;

TEST(Apart, AValueComesBackWhole) {
  const auto large = ReadApart<Numbers>({}, [] { return Result<Numbers>(test::Wave(3'000'000)); });
  ASSERT_TRUE(large.ok()) << large.failure().ToString();
  EXPECT_EQ(*large, test::Wave(3'000'000));
  using Mixed = std::vector<std::pair<std::string, std::optional<std::int64_t>>>;
  const Mixed mixed = {{"", {}}, {"a text", 7}, {std::string(200'000, 'x'), -1}};
  const auto back = ReadApart<Mixed>({}, [&] { return Result<Mixed>(mixed); });
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, mixed);
  const auto nothing = ReadApart<Numbers>({}, [] { return Result<Numbers>(Numbers()); });
  ASSERT_TRUE(nothing.ok());
  EXPECT_TRUE(nothing->empty());
}

TEST(Apart, AFailureComesBackAsItIs) {
  const Failure failure = {.message = "no", .signal = "file", .time_s = 1.5, .exit_code = 2};
  const auto back = ReadApart<int>({}, [&] { return Result<int>(failure); });
  ASSERT_FALSE(back.ok());
  EXPECT_EQ(back.failure().message, "no");
  EXPECT_EQ(back.failure().signal, "file");
  EXPECT_EQ(back.failure().time_s, 1.5);
  EXPECT_EQ(back.failure().exit_code, 2);
}

TEST(Apart, EveryEndIsASentence) {
  const auto end = [](const ApartLimits& limits, const std::function<void()>& act) {
    const auto result = ReadApart<int>(limits, [&] {
      act();
      return Result<int>(1);
    });
    return result.ok() ? Failure{.message = "it came back"} : result.failure();
  };
  Failure died = end({}, [] {
    signal(SIGSEGV, SIG_DFL);  // also where a sanitizer would speak first
    raise(SIGSEGV);
  });
  EXPECT_THAT(died.message, AllOf(HasSubstr("the HDF5 library died of signal 11"), HasSubstr("the file is damaged")));
  EXPECT_EQ(died.exit_code, 2);
  died = end({.reader = "it"}, [] { _exit(7); });
  EXPECT_THAT(died.message, HasSubstr("it ended with exit code 7"));
  died = end({}, [] { throw std::bad_alloc(); });
  EXPECT_THAT(died.message, HasSubstr("of memory"));
  died = end({}, [] { raise(SIGKILL); });
  EXPECT_THAT(died.message, HasSubstr("ended from outside"));
  EXPECT_EQ(died.exit_code, 3) << "no fault of the file";
}

#if !defined(__SANITIZE_ADDRESS__)
TEST(Apart, TimeAndMemoryAreLimited) {
  const auto endless = ReadApart<int>({.cpu_s = 0.2}, []() -> Result<int> {
    std::atomic<int> count = 0;
    for (;;) ++count;
  });
  ASSERT_FALSE(endless.ok());
  EXPECT_THAT(endless.failure().message, HasSubstr("still reading after 0.2 s"));
  const auto greedy = ReadApart<int>({.memory_bytes = 50'000'000}, []() -> Result<int> {
    const std::vector<double> much(100'000'000, 1.0);
    return static_cast<int>(much.size());
  });
  ASSERT_FALSE(greedy.ok());
  EXPECT_THAT(greedy.failure().message, HasSubstr("more than 47 MB"));
}

// The address sanitizer's allocator does not let go of its locks for a fork, as the C library's does.
TEST(Apart, OtherThreadsMayGoOn) {
  std::atomic<bool> stop = false;
  std::vector<std::thread> others;
  for (int k = 0; k < 3; ++k)
    others.emplace_back([&] {
      while (!stop) EXPECT_FALSE(fmt::format("{}", test::Wave(20)[3]).empty());
    });
  for (int k = 0; k < 100; ++k) {
    const auto result = ReadApart<Numbers>({}, [] { return Result<Numbers>(test::Wave(1000)); });
    EXPECT_TRUE(result.ok()) << result.failure().ToString();
  }
  stop = true;
  for (std::thread& other : others) other.join();
}
#endif

TEST(Apart, NoDamageAmongVariableTextsTouchesTheNumbers) {
  const test::TempDir dir;
  {
    test::Hdf5File file(dir / "x.h5");
    file.Numbers("time", {0, 1, 2});
    file.Group("signals");
    file.Numbers("signals/x", {4, 5, 6});
    file.Text("signals/x", "unit", "kN m", /*variable=*/true);
    file.Text("signals/x", "description", "a torque", /*variable=*/true);
  }
  const Result<Trace> right = ReadTrace(dir / "x.h5");
  ASSERT_TRUE(right.ok()) << right.failure().ToString();
  EXPECT_EQ(right->signals[0].unit, "kN m");
  const std::string whole = test::ReadBytes(dir / "x.h5");
  const std::size_t heap = whole.find("GCOL");
  ASSERT_NE(heap, std::string::npos);
  int refused = 0;
  // The size of the heap, and the heads of its first texts: which, how often used, how long.
  for (std::size_t at = heap + 8; at < heap + 44; ++at) {
    for (int bit = 0; bit < 8; bit += 3) {
      std::string bytes = whole;
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
      const Result<Trace> trace = ReadTrace(dir.Write("y.h5", bytes));
      if (!trace.ok()) {
        ++refused;
        EXPECT_EQ(trace.failure().exit_code, 2);
        continue;
      }
      EXPECT_EQ(trace->signals[0].values, right->signals[0].values) << at - heap;
      EXPECT_EQ(trace->time, right->time);
      // A letter has no checksum, but no text gets lost.
      EXPECT_EQ(trace->signals[0].unit.size(), right->signals[0].unit.size()) << at - heap;
      EXPECT_EQ(trace->signals[0].description, right->signals[0].description) << at - heap;
    }
  }
  EXPECT_GT(refused, 20);
}

TEST(Apart, ATextThatTheFileDoesNotHoldIsNamedAndAnEmptyOneIsNone) {
  const test::TempDir dir;
  {
    test::Hdf5File file(dir / "x.h5");
    file.Numbers("time", {0, 1, 2});
    file.Numbers("x", {4, 5, 6});
    file.Text("x", "comment", "", /*variable=*/true);
    file.Text("x", "unit", "N m", /*variable=*/true);
    file.Numbers("y", {4, 5, 6});
    file.Text("y", "unit", "", /*variable=*/true);
  }
  const Result<Record> right = ReadHdf5Record(dir / "x.h5");
  ASSERT_TRUE(right.ok()) << right.failure().ToString();
  EXPECT_EQ(right->columns[*right->Find("x")].unit, "N m");
  EXPECT_EQ(right->columns[*right->Find("y")].unit, "");
  std::string bytes = test::ReadBytes(dir / "x.h5");
  const std::size_t text = bytes.find("N m", bytes.find("GCOL"));
  ASSERT_NE(text, std::string::npos);
  bytes[text - 16] = static_cast<char>(bytes[text - 16] + 9);  // its number in the heap
  const Result<Record> lost = ReadHdf5Record(dir.Write("lost.h5", bytes));
  ASSERT_FALSE(lost.ok());
  EXPECT_EQ(lost.failure().exit_code, 2);
  EXPECT_THAT(lost.failure().message, AllOf(HasSubstr("dataset \"/x\": attribute \"unit\""), HasSubstr("damaged")));
}

}  // namespace
}  // namespace dynoproof::trace
