// Rows on their way to the table: each piece of a campaign is one file, whole or not there, named after its runs. The
// same piece made twice gives the same bytes under the same name; what a run cost is no property of it and stands
// beside, in a file of its own. Whoever has the folder can make any piece; nothing else is shared.
//
//   rows/BEGIN-END.jsonl   a header, then a line a run: [run, verdict, [figures], why, used, nearest]
//   costs/BEGIN-END.csv    run, wall seconds, CPU seconds, largest memory of its process so far in MB
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/subject.h"

namespace dynoproof::campaign {

struct Cost {
  double wall_s = 0.0, cpu_s = 0.0, peak_MB = 0.0;
};

/// One line, without its end; and back (nothing when it is none).
std::string ToLine(const Row& row);
std::optional<Row> ParseRow(std::string_view line);

/// All rows of a campaign, in order.
struct Rows {
  std::vector<Row> rows;
  std::string cpu;  // feature class of the machines that made them; several with a comma between
};

class RowStore {
 public:
  /// `folder` of the campaign's results; rows of another fingerprint are refused.
  RowStore(std::string folder, std::string fingerprint, std::int64_t runs)
      : folder_(std::move(folder)), fingerprint_(std::move(fingerprint)), runs_(runs) {}

  const std::string& folder() const { return folder_; }
  std::int64_t runs() const { return runs_; }

  /// Writes consecutive rows, whole or not at all. Fails with exit code 3.
  Status Write(std::span<const Row> rows, std::span<const Cost> costs) const;
  /// The ranges that have files; by their names alone.
  std::vector<Range> Stored() const;
  /// What Stored() leaves out.
  std::vector<Range> Missing() const;
  /// A failure (exit code 2) when the folder's first file is of another campaign or build: found out before hours of
  /// work. Merge() looks at all of them.
  Status BelongsElsewhere() const;
  /// Reads and checks everything: each run exactly once, where it was made twice both times with the same outcome, all
  /// of this campaign and this build. Fails with exit code 2 or 3.
  Result<Rows> Merge() const;
  /// The costs of the runs, in their order; zeros where a file is missing.
  std::vector<Cost> Costs() const;

 private:
  std::string FileOf(const char* kind, Range range, const char* ending) const;

  std::string folder_, fingerprint_;
  std::int64_t runs_;
};

/// The runs of `ranges`, cut into pieces of at most `most`.
std::vector<Range> Cut(const std::vector<Range>& ranges, std::int64_t most);
std::int64_t CountRuns(const std::vector<Range>& ranges);

}  // namespace dynoproof::campaign
