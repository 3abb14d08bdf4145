// One bit turned anywhere in a file: none gives other values. DYNOPROOF_BIT_FLIPS: how many bits of each file, or "all",
// instead of the few that every build tries.
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/random.h"
#include "tests/support/temp_dir.h"
#include "tests/trace/hdf5_file.h"
#include "tests/trace/mat_bytes.h"
#include "tests/trace/sample_trace.h"
#include "trace/hdf5_record.h"
#include "trace/mat.h"
#include "trace/trace_io.h"

namespace dynoproof::trace {
namespace {

using test::Hdf5File;
using test::TempDir;

/// What a file says of its numbers: by name, with the unit and the stamps.
using Said = std::map<std::string, std::pair<std::string, std::vector<double>>>;

Result<Said> SaidBy(const Result<Record>& record) {
  if (!record.ok()) return record.failure();
  Said said;
  for (const Column& column : record->columns) {
    said[column.name] = {column.unit, column.values};
    if (column.time) said["stamps of " + column.name] = {"", record->columns[*column.time].values};
  }
  return said;
}

class BitFlips : public ::testing::Test {
 protected:
  /// Turns seeded bits of the file, one at a time, and reads each with `read`.
  /// A name may change, since neither format of others has a checksum over names: then whoever asks for it is told that
  /// it is not there. What is still found under its name must be what it was.
  void Turn(const std::string& whole, const std::string& name,
            const std::function<Result<Said>(const std::filesystem::path&)>& read, bool names_are_safe) {
    const char* const asked = std::getenv("DYNOPROOF_BIT_FLIPS");
    const bool all = asked != nullptr && std::string_view(asked) == "all";
    const int flips = all ? static_cast<int>(8 * whole.size()) : asked != nullptr ? std::atoi(asked) : 150;
    ASSERT_GT(flips, 0);
    const Result<Said> right = read(dir_.Write(name, whole));
    ASSERT_TRUE(right.ok()) << right.failure().ToString();
    ASSERT_GT(right->size(), 1U);
    std::map<std::string, int> tally;
    for (int i = 0; i < flips; ++i) {
      const auto number = static_cast<std::uint64_t>(i);
      const std::size_t bit = all ? number : RandomBits(46, 0, number) % (8 * whole.size());
      std::string damaged = whole;
      damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
      const Result<Said> said = read(dir_.Write(name, damaged));
      if (!said.ok()) {
        EXPECT_EQ(said.failure().exit_code, 2) << "bit " << bit << ": " << said.failure().ToString();
        ++tally["refused"];
        continue;
      }
      bool same = true;
      for (const auto& [column, values] : *right) {
        const auto found = said->find(column);
        if (found == said->end()) {
          same = false;
        } else {
          EXPECT_TRUE(found->second == values) << name << ", bit " << bit << ": \"" << column << "\" has other values";
          if (found->second != values) ++tally["wrong"];
        }
      }
      ++tally[same ? "unchanged" : "names"];
      EXPECT_TRUE(same || !names_are_safe) << "bit " << bit << ": a column is gone and nobody says so";
    }
    EXPECT_GT(tally["refused"], flips / 10) << "the damage was hardly ever seen: does it reach the numbers?";
    for (const auto& [what, count] : tally) RecordProperty(what, count);
    std::printf("%s, %zu bytes, %d bits: refused %d, unchanged %d, a name or a variable gone %d, other values %d\n",
                name.c_str(), whole.size(), flips, tally["refused"], tally["unchanged"], tally["names"],
                tally["wrong"]);
  }

  TempDir dir_;
};

TEST_F(BitFlips, OfACompressedMat5) {
  std::string whole = test::Header5();
  for (const char* name : {"t", "T_shaft", "omega_1"})
    whole += test::Packed5(test::Plain5(test::Doubles5(name, test::Wave(100, 0.1 * name[0]))));
  Turn(
      whole, "record.mat", [](const auto& path) { return SaidBy(ReadMat(path)); }, true);
}

TEST_F(BitFlips, OfACompressedMat73) {
  const std::filesystem::path path = dir_ / "made.mat";
  {
    Hdf5File file(path, 512);
    for (const char* name : {"t", "T_shaft", "omega_1"}) {
      // As MATLAB writes them: the old format of HDF5, chunks, deflate, no checksum over anything else.
      file.Numbers(name, test::Wave(100, 0.1 * name[0]), {.shape = {1, 100}, .chunk = {1, 40}, .deflate = true});
      file.Text(name, "MATLAB_class", "double");
    }
  }
  std::string whole = test::ReadBytes(path);
  std::string header = test::Header5();
  header.replace(124, 4, std::string("\x00\x02IM", 4));
  whole.replace(0, header.size(), header);
  Turn(
      whole, "record.mat", [](const auto& file) { return SaidBy(ReadMat(file)); }, false);
}

TEST_F(BitFlips, OfOurTraces) {
  const auto read = [](const std::filesystem::path& path) -> Result<Said> {
    const Result<Trace> trace = ReadTrace(path);
    if (!trace.ok()) return trace.failure();
    return SaidBy(ToRecord(*trace, ""));
  };
  for (const int level : {0, 1}) {
    const auto path = dir_ / "made.h5";
    ASSERT_FALSE(WriteTrace(path, SampleTrace(), {.deflate_level = level}));
    Turn(test::ReadBytes(path), "trace.h5", read, true);
  }
}

}  // namespace
}  // namespace dynoproof::trace
