#include "trace/csv.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <optional>
#include <system_error>
#include <utility>

#include "base/text_safety.h"
#include "trace/csv_cells.h"
#include "trace/csv_cut.h"
#include "trace/csv_layout.h"
#include "trace/csv_table.h"
#include "trace/csv_text.h"
#include "trace/lvm.h"

namespace dynoproof::trace {
namespace {

/// Reads one file. Each step returns false after having set the failure.
class Reader {
 public:
  Reader(csv::Lines lines, std::string source, std::size_t file_bytes)
      : lines_(std::move(lines)), file_bytes_(file_bytes) {
    record_.source = std::move(source);
  }

  Result<Record> Read() {
    if (ReadHead()) ReadRows();
    if (!lines_.fault().empty()) return Fail(lines_.fault());
    if (!failure_.empty()) return Fail(failure_);
    if (bad_count_ > 0) return Fail(BadRows());
    DropEmptyRows();
    DropCutRow();
    if (cells_->rows() == 0) return Fail("has a row of names, but no data");
    cells_->MoveTo(record_);
    if (record_.columns.empty()) return Fail(NoColumn());
    FinishRecord(record_);
    return std::move(record_);
  }

 private:
  Failure Fail(std::string message) const {
    return {.message = std::move(message), .signal = record_.source, .time_s = {}, .exit_code = 2};
  }

  bool SetFailure(std::string text) {
    failure_ = std::move(text);
    return false;
  }

  std::string BadRows() const {
    if (bad_count_ == 1) return bad_[0];
    std::string text = fmt::format("{} bad rows", bad_count_);
    for (const std::string& sentence : bad_) text += "\n" + sentence;
    if (bad_count_ > bad_.size()) text += fmt::format("\nand {} more", bad_count_ - bad_.size());
    return text;
  }

  void Report(std::string sentence) {
    ++bad_count_;
    if (bad_.size() < kMostBadRows) bad_.push_back(std::move(sentence));
  }

  /// The first lines that hold something, and how they are laid out.
  bool ReadHead() {
    std::size_t bytes = 0, changed = 0;
    while (head_.size() < csv::kMostHeadLines && (bytes < csv::kHeadBytes || head_.size() < csv::kFewestHeadLines)) {
      const std::optional<std::string_view> line = lines_.Next();
      if (!line) break;
      bytes += line->size();
      if (csv::Trim(*line).empty() && line->find('\t') == std::string_view::npos) continue;
      if (changed == 0 && !IsUtf8(*line)) changed = lines_.number();
      head_.push_back({lines_.number(), ToUtf8(*line)});
    }
    if (!lines_.fault().empty()) return false;
    layout_ = !head_.empty() && csv::IsLvm(head_.front().text) ? csv::FindLvmLayout(head_) : csv::FindLayout(head_);
    if (!layout_.fault.empty()) return SetFailure(layout_.fault);
    record_.notes = layout_.notes;
    if (changed > 0) {
      record_.notes.push_back(fmt::format("line {} is not UTF-8: such text is taken as Windows-1252", changed));
    }
    cells_.emplace(layout_);
    return cells_->FaultOfNames().empty() || SetFailure(cells_->FaultOfNames());
  }

  /// The next line with data, or nothing: the rest of the head, then the rest of the file.
  std::optional<std::string_view> NextRow() {
    for (;;) {
      std::string_view line;
      if (at_ < head_.size()) {
        line = head_[at_].text;
        line_number_ = head_[at_++].number;
      } else if (const std::optional<std::string_view> next = lines_.Next()) {
        line = *next;
        line_number_ = lines_.number();
      } else {
        return {};
      }
      const std::string_view text = csv::Trim(line);
      // With tabs, a line of blanks is a row of empty cells only if it has a separator; with none it is an empty line.
      if (text.empty() && (layout_.separator != '\t' || line.find('\t') == std::string_view::npos)) continue;
      if (text.starts_with('#') || text == "\x1A") continue;  // the end of a file as DOS wrote it
      return layout_.separator == '\t' ? line : text;
    }
  }

  void ReadRows() {
    at_ = layout_.first_row;
    std::optional<std::string_view> line = NextRow();
    // Room for the rows to come, judged by the length of the first; later ones may be longer, so take a little more.
    if (line) cells_->Reserve(file_bytes_ / (line->size() + 1) * 9 / 8);
    for (; line; line = NextRow()) {
      if (layout_.spare_cells && csv::BeginsLvmBlock(*line)) {
        SetFailure(fmt::format("line {}: a second block begins; a record is one block: split the file", line_number_));
        return;
      }
      ReadRow(*line);
    }
    if (tail_.empty()) return;
    record_.notes.push_back(fmt::format("{} line{} behind the rows {} skipped, line {} first: {}", tail_.size(),
                                        tail_.size() == 1 ? "" : "s", tail_.size() == 1 ? "is" : "are", tail_[0].number,
                                        tail_[0].text));
  }

  void ReadRow(const std::string_view line) {
    const std::size_t width = cells_->width();
    std::string_view rest = line;
    std::size_t count = 0;
    bool any = false, closed = false;
    for (bool more = true; more; ++count) {
      const std::optional<std::string_view> cell = csv::TakeCell(rest, layout_.separator, storage_, more);
      if (!cell) {
        Report(fmt::format("line {}, column {}: a quote is not closed, or text follows it", line_number_, count + 1));
        return;
      }
      if (count >= width) {
        closed = true;
        if (count == width && cell->empty() && !more) break;  // a separator ends the line
        continue;
      }
      any = any || !cell->empty();
      cells_->Store(count, *cell, line_number_);
      if (count + 1 == width) last_cell_ = *cell;
    }
    if (count < width || (count > width && !layout_.spare_cells)) {
      cells_->DropRow(line_number_);
      TakeOddRow(line, count);
    } else if (!any && width > 1 && cells_->has_time()) {
      cells_->DropRow(line_number_);
      if (empty_rows_++ == 0) first_empty_line_ = line_number_;
    } else {
      KeepRow(any, closed);
    }
  }

  void KeepRow(bool any, bool closed) {
    for (const Odd& odd : tail_) Report(odd.fault);
    tail_.clear();
    if (cells_->rows() > 0) all_closed_ = all_closed_ && last_closed_;
    cells_->KeepRow();
    cut_.Take(last_cell_);
    last_closed_ = closed;
    last_line_ = line_number_;
    if (!any && empty_at_end_ == 0) empty_end_line_ = line_number_;
    empty_at_end_ = any ? 0 : empty_at_end_ + 1;
  }

  /// A row with another number of cells: a fault, unless it is all words, and nothing but such lines follow.
  void TakeOddRow(std::string_view line, std::size_t count) {
    const bool cut = count < cells_->width() && at_ >= head_.size() && lines_.open_end();
    std::string fault =
        fmt::format("line {}: {} cell{}, the row of names has {}{}", line_number_, count, count == 1 ? "" : "s",
                    cells_->width(), cut ? "; the file ends there without a line end, as if it were cut" : "");
    const csv::Row row({line_number_, std::string(line)}, layout_.separator);
    if (row.any_word && !row.any_number && tail_.size() < kMostBadRows) {
      tail_.push_back({line_number_, Shown(line), std::move(fault)});
    } else {
      Report(std::move(fault));
    }
  }

  /// Spreadsheets write rows of separators only, between the others and at the end.
  void DropEmptyRows() {
    if (empty_at_end_ > 0 && cells_->width() > 1) {
      cells_->DropEmptyRows(empty_at_end_);
      empty_rows_ += empty_at_end_;
      if (first_empty_line_ == 0) first_empty_line_ = empty_end_line_;
    }
    if (empty_rows_ == 0) return;
    record_.notes.push_back(fmt::format("{} row{} without any value {} left out, the first in line {}", empty_rows_,
                                        empty_rows_ == 1 ? "" : "s", empty_rows_ == 1 ? "is" : "are",
                                        first_empty_line_));
  }

  void DropCutRow() {
    if (!lines_.open_end() || last_line_ != lines_.number() || last_closed_ || empty_at_end_ > 0 ||
        cells_->rows() < 2 || !cells_->last_is_numeric() || (!all_closed_ && !cut_.MayBeCut(cells_->last_values()))) {
      return;
    }
    cells_->DropRow(last_line_);
    record_.notes.push_back(
        fmt::format("line {}, the last, has no line end, and its last cell {} is shorter than those above: it may be "
                    "cut, and the row is left out",
                    last_line_, Shown(last_cell_)));
  }

  std::string NoColumn() const {
    std::string text = "holds no column of numbers";
    for (const auto& [name, why] : record_.left_out) text += fmt::format("; {} {}", Shown(name), why);
    return text;
  }

  /// A row that may be one of words behind the table.
  struct Odd {
    std::size_t number;
    std::string text, fault;
  };

  csv::Lines lines_;
  std::size_t file_bytes_;
  Record record_;
  std::vector<csv::HeadLine> head_;
  csv::Layout layout_;
  std::optional<csv::CellColumns> cells_;
  std::size_t at_ = 0;  // next line of the head
  std::size_t line_number_ = 0, last_line_ = 0, first_empty_line_ = 0, empty_end_line_ = 0;
  std::string storage_;  // of a quoted cell
  std::size_t empty_rows_ = 0, empty_at_end_ = 0;
  bool last_closed_ = false, all_closed_ = true;  // by a separator: the last row, and all rows above it
  csv::CutCheck cut_;
  std::string last_cell_;
  std::vector<Odd> tail_;
  std::vector<std::string> bad_;
  std::size_t bad_count_ = 0;
  std::string failure_;
};

}  // namespace

Result<Record> ReadCsv(const std::filesystem::path& path, int skip) {
  const auto fail = [&](std::string message) {
    return Failure{.message = std::move(message), .signal = path.string(), .time_s = {}, .exit_code = 2};
  };
  // Before it is opened: a device may do something then.
  struct stat info = {};
  if (::stat(path.c_str(), &info) != 0) {
    return fail(errno == ENOENT ? "there is no such file"
                                : "cannot be read: " + std::generic_category().message(errno));
  }
  if (S_ISDIR(info.st_mode)) return fail("is a directory, not a file");
  const bool pipe = S_ISFIFO(info.st_mode) || S_ISSOCK(info.st_mode);
  if (!S_ISREG(info.st_mode) && !pipe) return fail("is a device: only files and pipes are read");
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0 || ::fstat(descriptor, &info) != 0) {
    return fail("cannot be read: " + std::generic_category().message(errno));
  }
  const auto bytes = pipe ? 0 : static_cast<std::size_t>(info.st_size);
  csv::Lines lines(descriptor, pipe ? kMostPipeBytes : bytes,
                   pipe ? fmt::format("gave more than {} MB: a pipe may give no more, a file may", kMostPipeBytes >> 20)
                        : fmt::format("grew beyond its {} bytes while it was read: wait until it is written", bytes));
  for (int i = 0; i < skip && lines.Next(); ++i) {
  }
  Result<Record> record = Reader(std::move(lines), path.string(), bytes).Read();
  ::close(descriptor);
  return record;
}

}  // namespace dynoproof::trace
