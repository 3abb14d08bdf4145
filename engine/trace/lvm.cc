#include "trace/lvm.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/text_safety.h"
#include "trace/csv_text.h"

namespace dynoproof::trace::csv {
namespace {

constexpr std::string_view kEnd = "***End_of_Header***";

using Header = std::map<std::string, std::vector<std::string>, std::less<>>;

/// The lines up to the next end of a header, each a key and its values; the place after it, or nothing without an end.
std::optional<std::size_t> ReadHeader(const std::vector<HeadLine>& head, std::size_t at, char separator, Header& into) {
  for (; at < head.size(); ++at) {
    std::vector<std::string> cells = Split(head[at].text, separator).value_or(std::vector<std::string>{});
    if (cells.empty()) continue;
    if (cells.front() == kEnd) return at + 1;
    std::string key = cells.front();
    cells.erase(cells.begin());
    into[std::move(key)] = std::move(cells);
  }
  return {};
}

std::string First(const Header& header, std::string_view key) {
  const auto found = header.find(key);
  return found == header.end() || found->second.empty() ? "" : found->second.front();
}

/// X0 or Delta_X of all channels.
std::optional<double> Common(const Header& header, std::string_view key, std::size_t channels, char mark) {
  const auto found = header.find(key);
  if (found == header.end() || found->second.size() < channels || channels == 0) return {};
  std::optional<double> common;
  for (std::size_t i = 0; i < channels; ++i) {
    const std::string& cell = found->second[i];
    const std::optional<double> value = cell.empty() ? std::nullopt : NumberReader(mark == ',', mark).Read(cell);
    if (!value || (common && *common != *value)) return {};
    common = value;
  }
  return common;
}

Layout Refuse(std::string why) {
  Layout layout;
  layout.fault = "is a LabVIEW measurement file (LVM) " + std::move(why);
  return layout;
}

}  // namespace

bool IsLvm(std::string_view first_line) { return first_line.starts_with("LabVIEW Measurement"); }

bool BeginsLvmBlock(std::string_view line) {
  return line.starts_with(kEnd) || line.starts_with("Channels") || line.starts_with("***Start_Special***");
}

Layout FindLvmLayout(const std::vector<HeadLine>& head) {
  Layout layout;
  // The header names the separator, which already parts its own cells.
  layout.separator =
      std::ranges::any_of(head, [](const HeadLine& l) { return l.text.starts_with("Separator,"); }) ? ',' : '\t';
  Header file, block;
  std::optional<std::size_t> at = ReadHeader(head, 0, layout.separator, file);
  if (!at) return Refuse("whose header has no end in its first lines");
  layout.mark = First(file, "Decimal_Separator") == "," ? ',' : '.';
  layout.comma_allowed = layout.mark == ',';
  const std::string x_columns = First(file, "X_Columns");
  if (x_columns == "Multi") {
    return Refuse("with an X column for every channel, which is not read: export it with one X column or none");
  }
  at = ReadHeader(head, *at, layout.separator, block);
  if (!at || *at >= head.size()) return Refuse("without a block of channels, or one whose header has no end");
  NumberReader numbers(false);
  const std::string count = First(block, "Channels");
  const double channels = count.empty() ? 0.0 : numbers.Read(count).value_or(0.0);
  const std::vector<std::string> names = Split(head[*at].text, layout.separator).value_or(std::vector<std::string>{});
  if (!(channels >= 1) || !(static_cast<double>(names.size()) >= 1 + channels)) {
    return Refuse(fmt::format("whose line {} should name {} channels: {}", head[*at].number,
                              count.empty() ? "its" : count, Shown(head[*at].text)));
  }
  const auto width = 1 + static_cast<std::size_t>(channels);
  const std::string dimension = First(block, "X_Dimension");
  const bool is_time = dimension.empty() || dimension == "Time";
  layout.columns.push_back({is_time ? "time" : names[0], is_time ? "s" : "", is_time ? names[0] : ""});
  if (is_time) layout.time = 0;
  const auto units = block.find("Y_Unit_Label");
  for (std::size_t i = 1; i < width; ++i) {
    const bool has_unit = units != block.end() && units->second.size() >= i;
    layout.columns.push_back({names[i], has_unit ? UnitOfCell(units->second[i - 1]) : "", ""});
  }
  if (x_columns != "One") {
    const std::optional<double> start = Common(block, "X0", width - 1, layout.mark);
    const std::optional<double> step = Common(block, "Delta_X", width - 1, layout.mark);
    if (!start || !step || !(*step > 0.0)) {
      return Refuse("without an X column, whose X0 and Delta_X are not whole, or not the same for all channels");
    }
    layout.raster = Raster{*start, *step};
    layout.notes.push_back(fmt::format("the times are X0 = {} and Delta_X = {} of the file's header", *start, *step));
  }
  layout.spare_cells = true;
  layout.names_line = head[*at].number;
  layout.first_row = *at + 1;
  return layout;
}

}  // namespace dynoproof::trace::csv
