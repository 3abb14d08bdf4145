// One experiment, exact, recorded in random ways: at any rate, with stamps of any offset, unit and number of digits, with
// rows that are missing, split into rasters, in each format. Each record gives the numbers of the line that it came from.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/random.h"
#include "experiment/checks.h"
#include "identification/bring_in.h"
#include "identification/identify.h"
#include "scenario/load.h"
#include "tests/identification/three_masses.h"
#include "tests/support/temp_dir.h"
#include "trace/csv_write.h"
#include "trace/mat_write.h"
#include "trace/trace_io.h"

namespace dynoproof::identification {
namespace {

/// Random numbers of one case, each by its own name, so that a new one moves no other.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(seed) {}
  double Uniform(std::uint64_t what, double low, double high) const {
    return low + (high - low) * RandomUniform(seed_, what, 0);
  }
  std::size_t Below(std::uint64_t what, std::size_t count) const { return RandomBits(seed_, what, 0) % count; }
  bool Keeps(std::uint64_t what, std::size_t row, double share) const {
    return RandomUniform(seed_, 100 + what, row) < share;
  }

 private:
  std::uint64_t seed_;
};

enum Format { kCsv, kCsvSideBySide, kMat, kHdf5, kFormats };

/// How one experiment is written down.
struct Way {
  double step_s = 1e-3, start_s = 0.0, dropped = 0.0;
  std::string unit = "s";
  double unit_s = 1.0;
  int decimals = -1;  // of stamps in their unit; -1: all
  bool single = false, stated = true;
  std::size_t hold = 1;
  std::array<std::size_t, 3> every = {1, 1, 1}, first = {0, 0, 0};  // rows of T_airgap, T_shaft, omega_1
  Format format = kCsv;

  std::string ToString() const {
    return fmt::format(
        "step {:.9g} s, start {:.9g} s, stamps in {} with {} decimals{}, {:.0f} % dropped, held over {}, every {} {} "
        "{} "
        "from {} {} {}, {}, {}",
        step_s, start_s, unit, decimals, single ? " of single precision" : "", 100.0 * dropped, hold, every[0],
        every[1], every[2], first[0], first[1], first[2], std::array{"CSV", "CSV side by side", "MAT", "HDF5"}[format],
        stated ? "held is stated" : "nobody says held");
  }
};

Way RandomWay(std::uint64_t seed) {
  const Draw draw(seed);
  Way way;
  const std::array steps = {1e-3,         5e-4,
                            2e-3,         1e-4 * static_cast<double>(1 + draw.Below(0, 20)),
                            1.0 / 1024.0, 1.0 / 1200.0,
                            1 / 610.35,   1.6384e-3,
                            1.0 / 12e3,   std::exp(draw.Uniform(1, std::log(3e-4), std::log(2e-3)))};
  way.step_s = steps[draw.Below(2, steps.size())];
  const std::array starts = {0.0, draw.Uniform(3, -100.0, 100.0), 12.3456, 1687168800.0};
  way.start_s = starts[draw.Below(4, starts.size())];
  const std::array<std::pair<const char*, double>, 4> units = {{{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}};
  const auto& [unit, unit_s] = units[draw.Below(5, units.size())];
  way.unit = unit, way.unit_s = unit_s;
  // The last digit is a quarter of the step at most; finer than a nanosecond nobody writes.
  const int fewest = static_cast<int>(std::ceil(std::log10(4.0 * unit_s / way.step_s)));
  const int most = static_cast<int>(std::lround(std::log10(unit_s * 1e9)));
  if (draw.Below(6, 3) > 0)
    way.decimals = std::clamp(fewest + static_cast<int>(draw.Below(7, 5)), 0, std::max(0, most));
  way.single = way.decimals < 0 && way.start_s == 0.0 && draw.Below(8, 2) == 0;
  way.dropped = draw.Below(9, 2) == 0 ? 0.0 : draw.Uniform(10, 0.0, 0.4);
  way.hold = way.dropped > 0.0 ? 2 + draw.Below(11, 4) : 1 + draw.Below(11, 3);
  way.format = static_cast<Format>(draw.Below(12, kFormats));
  for (std::size_t k = 1; k < 3; ++k) {
    way.every[k] = draw.Below(13, 2) == 0 ? 1 : 1 + draw.Below(13 + k, 5);
    if (way.format != kCsv && draw.Below(20, 2) == 0) way.first[k] = draw.Below(20 + k, 40);
  }
  way.stated = draw.Below(30, 2) == 0;
  return way;
}

struct Written {
  std::string file, map;
};

/// Rows of one channel that are in the file. Of the input those at which it changes, else it is not known between.
std::vector<std::size_t> RowsOf(const Way& way, const Draw& draw, std::size_t channel, std::size_t count,
                                std::uint64_t dice) {
  std::vector<std::size_t> rows;
  for (std::size_t i = way.first[channel]; i < count; i += way.every[channel]) {
    const bool needed = i == 0 || i + 1 == count || (channel == 0 && i % way.hold == 0);
    if (needed || way.dropped == 0.0 || !draw.Keeps(dice, i, way.dropped)) rows.push_back(i);
  }
  return rows;
}

Written Write(const Way& way, std::uint64_t seed, const test::TempDir& folder) {
  const Draw draw(seed);
  const auto count = static_cast<std::size_t>(0.6 / way.step_s);
  const Rows all = RunThreeMasses(Chirp(count, way.step_s, way.hold), way.step_s);
  const auto stamp = [&](std::size_t row) {
    double t = (way.start_s + all.t[row]) / way.unit_s;
    if (way.start_s > 1e9) t = way.start_s / way.unit_s + all.t[row] / way.unit_s;
    if (way.decimals >= 0) {
      const double scale = std::pow(10.0, way.decimals);
      t = std::round(t * scale) / scale;
    }
    return way.single ? static_cast<double>(static_cast<float>(t)) : t;
  };
  const std::array names = {"T_airgap", "T_shaft", "omega_1"}, units = {"N m", "N m", "rad/s"};
  const std::array values = {&all.T_airgap, &all.T_shaft, &all.omega_1};
  const bool merged = way.format == kCsv;
  std::vector<trace::Column> columns;
  std::string map;
  std::vector<std::size_t> shared;  // rows of the only clock
  if (merged) {
    std::vector<std::size_t> wanted(count, 0);
    for (const std::size_t row : RowsOf(way, draw, 0, count, 0)) wanted[row] = 1;
    for (std::size_t row = 0; row < count; ++row) {
      if (wanted[row] != 0) shared.push_back(row);
    }
    trace::Column time{.name = "t", .unit = way.unit, .values = {}, .time = {}};
    for (const std::size_t row : shared) time.values.push_back(stamp(row));
    columns.push_back(std::move(time));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    trace::Column column{.name = names[k], .unit = units[k], .values = {}, .time = {}};
    trace::Column time{.name = fmt::format("t_{}", names[k]), .unit = way.unit, .values = {}, .time = {}};
    for (const std::size_t row : merged ? shared : RowsOf(way, draw, k, count, k)) {
      const bool here = !merged || row % way.every[k] == 0;
      column.values.push_back(here ? (*values[k])[row] : std::nan(""));
      time.values.push_back(stamp(row));
    }
    map += fmt::format("[{}.{}]\ncolumn = \"{}\"\n", k == 0 ? "input" : "output", names[k], names[k]);
    if (merged && way.every[k] > 1) map += "missing = true\n";
    if (k == 0 && way.stated) map += "between = \"held\"\n";
    if (!merged && way.format != kHdf5) {
      map += fmt::format("time = {{ column = \"{}\", unit = \"{}\" }}\n", time.name, way.unit);
      columns.push_back(time);
    } else if (way.format == kHdf5) {
      columns.push_back(time);
    }
    columns.push_back(std::move(column));
  }
  Written written;
  written.map = folder.Write("map.toml", map).string();
  if (way.format == kMat) {
    written.file = (folder / "record.mat").string();
    EXPECT_FALSE(trace::WriteMat(written.file, columns));
  } else if (way.format == kHdf5) {
    trace::Trace trace;
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<double> time = columns[2 * k].values;
      for (double& t : time) t *= way.unit_s;  // seconds, as the layout has it
      if (k == 0)
        trace.time = std::move(time);
      else
        trace.other_times.push_back(std::move(time));
      trace.signals.push_back(
          {.name = names[k], .unit = units[k], .values = columns[2 * k + 1].values, .time_base = k});
    }
    written.file = (folder / "record.h5").string();
    EXPECT_FALSE(trace::WriteTrace(written.file, trace));
  } else {
    // Cells behind the end of a shorter raster, and between the samples of a slower one, are empty.
    std::size_t rows = 0;
    std::string head, unit_row, body;
    for (const trace::Column& column : columns) {
      rows = std::max(rows, column.values.size());
      head += (head.empty() ? "" : ",") + column.name;
      unit_row += (unit_row.empty() ? "" : ",") + column.unit;
    }
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t k = 0; k < columns.size(); ++k) {
        if (k > 0) body += ',';
        if (i < columns[k].values.size() && std::isfinite(columns[k].values[i]))
          body += fmt::format("{}", columns[k].values[i]);
      }
      body += '\n';
    }
    written.file = folder.Write("record.csv", head + "\n" + unit_row + "\n" + body).string();
  }
  return written;
}

class RecordProperty : public ::testing::Test {
 protected:
  RecordProperty() {
    RegisterBuiltIns(registry_);
    RegisterChecks(registry_);
    Diagnostics diagnostics;
    plan_ = LoadPlan(folder_.Write("line.toml", kThreeMasses).string(), {}, diagnostics);
    EXPECT_TRUE(plan_ && diagnostics.error_count() == 0);
  }

  std::optional<MappedRecord> Open(const Written& written) {
    Diagnostics diagnostics;
    std::optional<MappedRecord> record = OpenRecord(written.file, written.map, {{"T_airgap", "N m"}},
                                                    {{"T_shaft", "N m"}, {"omega_1", "rad/s"}}, diagnostics);
    if (record && !BringIn(*plan_, registry_, *record, diagnostics)) record.reset();
    for (const Diagnostic& one : diagnostics.items()) ADD_FAILURE() << one.message << " " << one.hint;
    return record;
  }

  Result<Identified> Identify(const MappedRecord& record) {
    return IdentifyBetween(
        *plan_, {record}, registry_,
        {{{"plant.inertia.I3", {}}, {"plant.shaft.k1.stiffness_Nm_per_rad", {}}}, "free_run", 1, [](double) {}});
  }

  test::TempDir folder_;
  Registry registry_;
  std::optional<Plan> plan_;
};

TEST_F(RecordProperty, OneExperimentGivesTheSameNumbersHoweverItIsRecorded) {
  constexpr int kCases = 100;
  constexpr double kExact = 1e-6;
  // What stamps leave open, as a record says then, is allowed for; an interval that holds everything holds nothing. The
  // widest of 400 was 0.0054: stamps of 0.1 ms on two rasters.
  constexpr double kWidest = 0.01;
  int exact = 0, open = 0, missed = 0;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const Way way = RandomWay(seed);
    SCOPED_TRACE(fmt::format("seed {}: {}", seed, way.ToString()));
    const std::optional<MappedRecord> record = Open(Write(way, seed, folder_));
    ASSERT_TRUE(record);
    const Result<Identified> found = Identify(*record);
    ASSERT_TRUE(found.ok()) << found.failure().ToString();
    double worst = 0.0;
    bool held = true;
    const std::array truth = {kI3, kK1};
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const IdentifiedValue& one = found->values[k];
      ASSERT_TRUE(one.interval) << one.key;
      worst = std::max(worst, std::abs(one.value / truth[k] - 1.0));
      held = held && one.interval->first <= truth[k] && truth[k] <= one.interval->second;
      EXPECT_LT(one.interval->second - one.interval->first, 2.0 * kWidest * truth[k]) << one.key;
    }
    if (worst < kExact) {
      ++exact;
      continue;
    }
    ++open, missed += held ? 0 : 1;
    EXPECT_THAT(record->notes, ::testing::Contains(::testing::HasSubstr("for which intervals allow"))) << worst;
  }
  // Few steps are so odd, and stamped so roughly, that the stamps do not tell them: 94 of 100, 374 of 400.
  EXPECT_GE(exact, 85);
  EXPECT_LE(missed, open / 20);
}

// Nobody may use a column: its text, its gaps, its name and its place are no part of the answer.
TEST_F(RecordProperty, NoBitDependsOnAColumnThatIsNotUsed) {
  constexpr std::uint64_t kCases = 20;
  const Rows rows = RunThreeMasses(Chirp(600, 1e-3, 1), 1e-3);
  const auto answer = [&](const std::string& text) {
    Written written;
    written.file = folder_.Write("record.csv", text).string();
    const std::optional<MappedRecord> record = Open(written);
    if (!record) return std::string("no record");
    const Result<Identified> found = Identify(*record);
    if (!found.ok()) return found.failure().ToString();
    // Shortest decimals that read back as the same doubles: equal texts are equal bits.
    return ToJson(*found).dump();
  };
  const auto write = [&](const Draw& draw, std::size_t extra) {
    static const std::array kNames = {"gear", "", "T_shaft_raw", "omega_2", "comment", "n [rpm]", "Time_1", "T"};
    std::string text;
    std::vector<std::size_t> place;
    for (std::size_t k = 0; k < extra; ++k) place.push_back(draw.Below(300 + k, 5));
    const auto line = [&](const std::array<std::string, 4>& own, const auto& other) {
      std::vector<std::string> cells;
      for (std::size_t column = 0; column <= own.size(); ++column) {
        for (std::size_t k = 0; k < extra; ++k) {
          if (place[k] == column) cells.push_back(other(k));
        }
        if (column < own.size()) cells.push_back(own[column]);
      }
      text += fmt::format("{}\n", fmt::join(cells, ","));
    };
    line({"t", "T_airgap", "T_shaft", "omega_1"},
         [&](std::size_t k) { return std::string(kNames[draw.Below(200 + k, kNames.size())]); });
    for (std::size_t i = 0; i < rows.t.size(); ++i) {
      const auto cell = [&](std::size_t k) -> std::string {
        switch (draw.Below(400 + k, 6)) {
          case 0:
            return i % 2 == 0 ? "true" : "false";
          case 1:
            return "NaN";
          case 2:
            return i % (2 + draw.Below(500 + k, 5)) == 0 ? fmt::format("{}", RandomNormal(k, 7, i)) : "";
          case 3:
            return i % 3 == 0 ? "D" : "1.5";
          case 4:
            return i == 17 ? "-1e999" : fmt::format("{}", i);
          default:
            return fmt::format("{}", RandomNormal(k, 8, i));
        }
      };
      line({fmt::format("{:.9g}", rows.t[i]), fmt::format("{}", rows.T_airgap[i]), fmt::format("{}", rows.T_shaft[i]),
            fmt::format("{}", rows.omega_1[i])},
           cell);
    }
    return text;
  };
  const std::string plain = answer(write(Draw(0), 0));
  ASSERT_THAT(plain, ::testing::HasSubstr("plant.inertia.I3"));
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const Draw draw(seed);
    const std::string text = write(draw, 1 + draw.Below(1, 6));
    EXPECT_EQ(answer(text), plain) << "seed " << seed << ", columns " << text.substr(0, 2 * text.find('\n'));
  }
}

}  // namespace
}  // namespace dynoproof::identification
