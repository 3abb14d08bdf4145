#include "base/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>

#include "tests/support/temp_dir.h"
#include "tests/trace/sample_trace.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

using test::ReadBytes;
using test::TempDir;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Files end at this many bytes while it lives, as on a disk that has no more.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limited = before_;
    limited.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_ = {};
  void (*handler_)(int);
};

TEST(AtomicFile, WritesReplacesAndMakesFolders) {
  const TempDir dir;
  EXPECT_EQ(WriteFileAtomically(dir / "x/y/a.txt", "one"), std::nullopt);
  EXPECT_EQ(ReadBytes(dir / "x/y/a.txt"), "one");
  EXPECT_EQ(WriteFileAtomically(dir / "x/y/a.txt", "two"), std::nullopt);
  EXPECT_EQ(ReadBytes(dir / "x/y/a.txt"), "two");
  EXPECT_EQ(WriteFileAtomically(dir / "empty", ""), std::nullopt);
  EXPECT_TRUE(std::filesystem::exists(dir / "empty"));
  EXPECT_THAT(dir.Names(), testing::UnorderedElementsAre("x", "empty"));
}

TEST(AtomicFile, FullDiskLeavesTheOldFileAndNoOther) {
  const TempDir dir;
  ASSERT_EQ(WriteFileAtomically(dir / "a.h5", "old"), std::nullopt);
  Status status, trace_status;
  {
    const FileSizeLimit limit(20000);
    status = WriteFileAtomically(dir / "a.h5", std::string(50000, 'x'));
    trace_status = trace::WriteTrace(dir / "b.h5", trace::SampleTrace(100000));
  }
  ASSERT_TRUE(status);
  EXPECT_EQ(status->exit_code, 3);
  EXPECT_THAT(status->ToString(), AllOf(HasSubstr("a.h5"), HasSubstr("cannot write 50000 bytes"), HasSubstr("large")));
  ASSERT_TRUE(trace_status);
  EXPECT_EQ(trace_status->exit_code, 3);
  EXPECT_THAT(dir.Names(), ElementsAre("a.h5"));
  EXPECT_EQ(ReadBytes(dir / "a.h5"), "old");
}

TEST(AtomicFile, DevicesAreWrittenToNotReplaced) {
  ASSERT_TRUE(std::filesystem::is_character_file("/dev/full"));
  const Status status = WriteFileAtomically("/dev/full", "text");
  ASSERT_TRUE(status);
  EXPECT_THAT(status->message, AllOf(HasSubstr("No space left"), HasSubstr("free some space")));
  EXPECT_EQ(WriteFileAtomically("/dev/null", "text"), std::nullopt);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(AtomicFile, PlacesThatCannotBeWrittenAreNamed) {
  const TempDir dir;
  dir.Write("file", "x");
  Status status = WriteFileAtomically(dir / "file/a.txt", "text");
  ASSERT_TRUE(status);
  EXPECT_EQ(status->exit_code, 3);
  EXPECT_THAT(status->message, AllOf(HasSubstr("cannot create the folder"), HasSubstr("is a file")));
  status = WriteFileAtomically("/proc/nowhere/a.txt", "text");
  ASSERT_TRUE(status);
  EXPECT_THAT(status->message, HasSubstr("cannot create the folder \"/proc/nowhere\""));
  status = WriteFileAtomically(dir.path(), "text");
  ASSERT_TRUE(status);
  EXPECT_THAT(status->message, HasSubstr("directory"));
  status = WriteFileAtomically(dir / std::string(300, 'n'), "text");
  ASSERT_TRUE(status);
  EXPECT_THAT(dir.Names(), ElementsAre("file"));
}

TEST(AtomicFile, FolderWithoutRights) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere; PlacesThatCannotBeWrittenAreNamed covers the path";
  const TempDir dir;
  std::filesystem::create_directory(dir / "locked");
  std::filesystem::permissions(dir / "locked", std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const Status status = WriteFileAtomically(dir / "locked/a.txt", "text");
  ASSERT_TRUE(status);
  EXPECT_THAT(status->message, AllOf(HasSubstr("Permission denied"), HasSubstr("may be written")));
}

TEST(AtomicFile, LinkKeepsPointing) {
  const TempDir dir;
  dir.Write("real", "old");
  std::filesystem::create_symlink("real", dir / "link");
  EXPECT_EQ(WriteFileAtomically(dir / "link", "new"), std::nullopt);
  EXPECT_TRUE(std::filesystem::is_symlink(dir / "link"));
  EXPECT_EQ(ReadBytes(dir / "real"), "new");
}

/// Parts of unfinished files in `dir`.
std::size_t CountParts(const TempDir& dir) {
  std::size_t count = 0;
  for (const std::string& name : dir.Names()) count += name.ends_with(".part") ? 1 : 0;
  return count;
}

TEST(AtomicFile, KilledWriterLeavesTheOldOrTheNewTrace) {
  const TempDir dir;
  trace::Trace a = trace::SampleTrace(40000), b = trace::SampleTrace(60000);
  const auto image_a = trace::ToImage(a), image_b = trace::ToImage(b);
  ASSERT_TRUE(image_a.ok() && image_b.ok());
  ASSERT_EQ(WriteFileAtomically(dir / "t.h5", *image_a), std::nullopt);
  std::mt19937 random(1);
  std::uniform_int_distribution<useconds_t> delay_us(500, 20000);
  for (int kill_number = 0; kill_number < 40; ++kill_number) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (;;) {
        if (WriteFileAtomically(dir / "t.h5", *image_b) || WriteFileAtomically(dir / "t.h5", *image_a)) ::_exit(1);
      }
    }
    ::usleep(delay_us(random));
    ::kill(child, SIGKILL);
    int state = 0;
    ::waitpid(child, &state, 0);
    ASSERT_TRUE(WIFSIGNALED(state)) << "the writer failed by itself";
    const Result<trace::Trace> found = trace::ReadTrace(dir / "t.h5");
    ASSERT_TRUE(found.ok()) << found.failure().ToString();
    ASSERT_TRUE(*found == a || *found == b);
  }
  // Else no kill came in the middle of a write and nothing was shown. Writing takes most of the child's time.
  EXPECT_GT(CountParts(dir), 0u);
}

std::vector<trace::Trace> TracesOfFourLengths() {
  std::vector<trace::Trace> traces;
  for (std::size_t i = 0; i < 4; ++i) traces.push_back(trace::SampleTrace(1000 + 500 * i));
  return traces;
}

bool IsOneOf(const trace::Trace& trace, const std::vector<trace::Trace>& traces) {
  return std::find(traces.begin(), traces.end(), trace) != traces.end();
}

TEST(AtomicFile, ThreadsThatWriteAtTheSameTimeDoNotMix) {
  const TempDir dir;
  const std::vector<trace::Trace> traces = TracesOfFourLengths();
  std::atomic<int> failures{0};
  for (int round = 0; round < 5; ++round) {
    std::vector<std::thread> writers;
    for (const trace::Trace& mine : traces) {
      writers.emplace_back([&] {
        for (int i = 0; i < 3; ++i) failures += trace::WriteTrace(dir / "t.h5", mine) ? 1 : 0;
      });
    }
    for (std::thread& writer : writers) writer.join();
    const Result<trace::Trace> found = trace::ReadTrace(dir / "t.h5");
    ASSERT_TRUE(found.ok()) << found.failure().ToString();
    EXPECT_TRUE(IsOneOf(*found, traces));
  }
  EXPECT_EQ(failures, 0);
  EXPECT_THAT(dir.Names(), ElementsAre("t.h5"));
}

// Who reads while others write is a process beside theirs, as two runs into one folder are. Threads would not do under the
// address sanitizer: a reader is a fork (trace/hdf5_apart.h), and that allocator's locks are copied as they are held.
TEST(AtomicFile, ReadersSeeOneOfWhatProcessesWriteAtTheSameTime) {
  const TempDir dir;
  const std::vector<trace::Trace> traces = TracesOfFourLengths();
  ASSERT_EQ(trace::WriteTrace(dir / "t.h5", traces[0]), std::nullopt);
  std::vector<pid_t> writers;
  for (const trace::Trace& mine : traces) {
    const pid_t writer = ::fork();
    ASSERT_GE(writer, 0);
    if (writer == 0) {
      int failures = 0;
      for (int i = 0; i < 15; ++i) failures += trace::WriteTrace(dir / "t.h5", mine) ? 1 : 0;
      ::_exit(failures);
    }
    writers.push_back(writer);
  }
  for (std::size_t ended = 0; ended < writers.size();) {
    const Result<trace::Trace> found = trace::ReadTrace(dir / "t.h5");
    EXPECT_TRUE(found.ok()) << found.failure().ToString();
    if (found.ok()) {
      EXPECT_TRUE(IsOneOf(*found, traces));
    }
    int state = 0;
    while (ended < writers.size() && ::waitpid(writers[ended], &state, found.ok() ? WNOHANG : 0) == writers[ended]) {
      EXPECT_TRUE(WIFEXITED(state) && WEXITSTATUS(state) == 0);
      ++ended;
    }
  }
  EXPECT_THAT(dir.Names(), ElementsAre("t.h5"));
}

}  // namespace
}  // namespace dynoproof
