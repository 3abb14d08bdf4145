#include "trace/csv_text.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>
#include <utility>

#include "base/text_safety.h"

namespace dynoproof::trace::csv {

namespace {

/// What a file is that is no text of columns, told by its first bytes.
std::string Foreign(std::string_view start) {
  static constexpr std::pair<std::string_view, const char*> kKinds[] = {
      {"\xFF\xFE", "is UTF-16 text; save it as UTF-8"},
      {"\xFE\xFF", "is UTF-16 text; save it as UTF-8"},
      {"\x89HDF", "is an HDF5 file, not text: its name should end in .h5"},
      {"MATLAB 5.0 MAT-file", "is a MAT file, not text: its name should end in .mat"},
      {"MATLAB 7.3 MAT-file", "is a MAT file, not text: its name should end in .mat"},
      {"PK\x03\x04", "is a zip archive or an Excel workbook, not text; save the sheet as CSV"},
      {"\xD0\xCF\x11\xE0", "is an Excel workbook, not text; save the sheet as CSV"},
      {"\x1F\x8B", "is compressed by gzip; unpack it first"},
      {"MDF     ", "is an MDF file, not text; export it as CSV or MAT"},
      {"UnFinMF ", "is an MDF file that was never finished; export it as CSV or MAT"},
      {"TDSm", "is a TDMS file, not text; export it as CSV or LVM"},
      {"%PDF-", "is a PDF file, not text of columns"},
      {"<?xml", "is XML, not text of columns"},
      {"<!DOCTYPE", "is a web page, not text of columns"},
      {"<html", "is a web page, not text of columns"},
  };
  for (const auto& [first, what] : kKinds) {
    if (start.starts_with(first)) return what;
  }
  return "";
}

}  // namespace

Lines::Lines(int descriptor, std::size_t most, std::string too_many)
    : descriptor_(descriptor), most_(most), too_many_(std::move(too_many)), buffer_(std::size_t{1} << 20, '\0') {
  constexpr std::size_t kLongestSignature = 20;
  while (fault_.empty() && end_ < kLongestSignature && Fill()) {
  }
  const std::string_view start(buffer_.data(), end_ + returns_);
  if (start.starts_with("\xEF\xBB\xBF")) begin_ = 3;
  // A signature says more than the zero bytes that usually follow it.
  if (const std::string what = Foreign(start); !what.empty()) fault_ = what;
}

bool Lines::Fill() {
  if (at_end_) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ + returns_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  const std::size_t stop = end_ + returns_;
  if (stop == buffer_.size()) buffer_.resize(2 * buffer_.size());
  ssize_t got = 0;
  do {
    got = ::read(descriptor_, buffer_.data() + stop, buffer_.size() - stop);
  } while (got < 0 && errno == EINTR);
  if (got < 0) fault_ = "cannot be read: " + std::generic_category().message(errno);
  at_end_ = got <= 0;
  const auto bytes = static_cast<std::size_t>(std::max<ssize_t>(got, 0));
  total_ += bytes;
  if (total_ > most_) fault_ = too_many_;
  if (const void* const zero = std::memchr(buffer_.data() + stop, '\0', bytes); zero != nullptr && fault_.empty()) {
    const char* const unread = buffer_.data() + begin_;
    const auto line = std::count(unread, static_cast<const char*>(zero), '\n') + 1;
    fault_ = fmt::format("is a binary file, or a damaged one: there is a zero byte near line {}",
                         number_ + static_cast<std::size_t>(line));
  }
  const bool any = bytes > 0 || returns_ > 0;
  TakeLineEnds(bytes);
  return any;
}

void Lines::TakeLineEnds(std::size_t got) {
  const std::size_t stop = end_ + returns_ + got;
  if (returns_ == 0 && std::memchr(buffer_.data() + end_, '\r', got) == nullptr) {
    end_ = stop;
    return;
  }
  std::size_t to = end_;
  for (std::size_t i = end_; i < stop;) {
    std::size_t next = i;
    while (next < stop && buffer_[next] == '\r') ++next;
    if (next == i) {
      buffer_[to++] = buffer_[i++];
      continue;
    }
    if (next == stop && !at_end_) {
      end_ = to;
      returns_ = next - i;
      std::fill_n(buffer_.begin() + static_cast<std::ptrdiff_t>(to), returns_, '\r');
      return;
    }
    if (next < stop && buffer_[next] == '\n') {
      i = next + 1;
      buffer_[to++] = '\n';
    } else {  // each ends a line of its own
      for (; i < next; ++i) buffer_[to++] = '\n';
    }
  }
  end_ = to;
  returns_ = 0;
}

std::optional<std::string_view> Lines::Next() {
  std::size_t searched = begin_;
  for (;;) {
    if (!fault_.empty()) return {};
    const char* const found = static_cast<const char*>(std::memchr(buffer_.data() + searched, '\n', end_ - searched));
    const std::size_t unsearched = end_ - begin_;
    if (found == nullptr && Fill()) {
      searched = begin_ + unsearched;
      continue;
    }
    if (!fault_.empty() || (found == nullptr && begin_ == end_)) return {};
    open_end_ = found == nullptr;
    const std::size_t stop = open_end_ ? end_ : static_cast<std::size_t>(found - buffer_.data());
    const std::string_view line(buffer_.data() + begin_, stop - begin_);
    begin_ = open_end_ ? end_ : stop + 1;
    ++number_;
    return line;
  }
}

std::string_view Trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

namespace {

/// Drops the separator at the front of `rest`, and says whether there was one.
bool TakeSeparator(std::string_view& rest, char separator) {
  if (rest.empty()) return false;
  const bool blanks = separator == ' ' || separator == kWideBlanks;
  rest.remove_prefix(blanks ? std::min(rest.find_first_not_of(" \t"), rest.size()) : 1);
  return true;
}

std::size_t EndOfCell(std::string_view rest, char separator) {
  if (separator == kWideBlanks) return std::min({rest.find("  "), rest.find('\t'), rest.size()});
  return std::min(separator == ' ' ? rest.find_first_of(" \t") : rest.find(separator), rest.size());
}

}  // namespace

std::optional<std::string_view> TakeCell(std::string_view& rest, char separator, std::string& storage, bool& more) {
  std::size_t start = 0;
  while (start < rest.size() && rest[start] == ' ') ++start;
  if (start == rest.size() || rest[start] != '"') {
    const std::size_t end = EndOfCell(rest, separator);
    const std::string_view cell = Trim(rest.substr(0, end));
    rest.remove_prefix(end);
    more = TakeSeparator(rest, separator);
    return cell;
  }
  storage.clear();
  std::size_t i = start + 1;
  for (;; ++i) {
    if (i >= rest.size()) return {};
    if (rest[i] == '"') {
      if (i + 1 >= rest.size() || rest[i + 1] != '"') break;
      ++i;
    }
    storage += rest[i];
  }
  rest.remove_prefix(i + 1);
  const std::size_t end = EndOfCell(rest, separator);
  if (!Trim(rest.substr(0, end)).empty()) return {};
  rest.remove_prefix(end);
  more = TakeSeparator(rest, separator);
  return Trim(storage);
}

std::optional<std::vector<std::string>> Split(std::string_view line, char separator) {
  std::vector<std::string> cells;
  std::string storage;
  for (bool more = true; more;) {
    const auto cell = TakeCell(line, separator, storage, more);
    if (!cell) return {};
    cells.emplace_back(*cell);
  }
  return cells;
}

std::optional<double> NumberReader::Read(std::string_view cell) {
  constexpr std::size_t kLongest = 400;  // more digits than any double has
  char swapped[kLongest];
  const std::size_t mark = cell.find_first_of(".,");
  if (mark != std::string_view::npos) {
    if (mark_ == 0) {
      if (cell[mark] == ',' && !comma_allowed_) return {};
    } else if (cell[mark] != mark_) {
      return {};
    }
    if (cell[mark] == ',') {
      if (cell.size() > kLongest) return {};
      std::copy(cell.begin(), cell.end(), swapped);
      swapped[mark] = '.';
    }
  }
  const char* begin = mark != std::string_view::npos && cell[mark] == ',' ? swapped : cell.data();
  const char* const end = begin + cell.size();
  if (*begin == '+' && cell.size() > 1 && begin[1] != '-' && begin[1] != '+') ++begin;
  double value = 0.0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (stop != end && stop > begin && (*stop == 'd' || *stop == 'D')) {
    std::string with_e(cell);
    with_e[cell.size() - static_cast<std::size_t>(end - stop)] = 'e';
    return Read(with_e);
  }
  if (stop != end) return {};
  if (error == std::errc::result_out_of_range) {
    // Too large or too small, from_chars does not say which; a text that is too small has a negative exponent or opens
    // with zeros.
    const std::string_view text(begin, static_cast<std::size_t>(end - begin));
    const std::string_view digits = text.substr(text.starts_with('-') ? 1 : 0);
    const std::size_t exponent = digits.find_first_of("eE");
    const bool small = exponent == std::string_view::npos ? digits.starts_with("0.") || digits.starts_with('.')
                                                          : digits.substr(exponent + 1).starts_with('-');
    if (!small) return {};
    value = text.starts_with('-') ? -0.0 : 0.0;
  } else if (error != std::errc()) {
    return {};
  }
  if (mark_ == 0 && mark != std::string_view::npos) mark_ = cell[mark];
  return value;
}

std::string NumberReader::Explain(std::string_view cell) const {
  const std::string shown = Shown(cell);
  if (NumberReader(true).Read(cell)) {
    if (mark_ != 0) {
      return fmt::format("{} has another decimal mark than the other numbers, which have \"{}\"", shown, mark_);
    }
    if (LooksLikeThousands(cell))
      return shown + " has a comma that may part thousands; write the decimal mark as a point";
    return shown + " has a decimal comma, where no other number has one";
  }
  const std::size_t mark = cell.find_first_of(".,");
  const bool two_marks = mark != std::string_view::npos && cell.find_first_of(".,", mark + 1) != std::string_view::npos;
  if (two_marks && cell.find_first_not_of("+-0123456789.,eE") == std::string_view::npos) {
    return shown + " has two marks; marks between thousands are not read";
  }
  double value = 0.0;
  if (std::from_chars(cell.data(), cell.data() + cell.size(), value).ec == std::errc::result_out_of_range) {
    return shown + " is outside the range of a double";
  }
  return shown + " is not a number";
}

bool LooksLikeThousands(std::string_view number) {
  if (number.starts_with('-') || number.starts_with('+')) number.remove_prefix(1);
  const std::size_t mark = number.find_first_of(".,");
  return mark != std::string_view::npos && mark >= 1 && mark <= 3 && number.front() != '0' &&
         number.size() == mark + 4 && number.find_first_not_of("0123456789", mark + 1) == std::string_view::npos;
}

}  // namespace dynoproof::trace::csv
