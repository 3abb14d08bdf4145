#include "trace/csv_text.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>

namespace dynoproof::trace::csv {

Lines::Lines(int descriptor) : descriptor_(descriptor), buffer_(std::size_t{1} << 20, '\0') {
  if (!Fill()) return;
  const std::string_view start(buffer_.data(), end_);
  if (start.starts_with("\xEF\xBB\xBF")) begin_ = 3;
  if (start.starts_with("\xFF\xFE") || start.starts_with("\xFE\xFF")) {
    fault_ = "is UTF-16 text; save it as UTF-8";
  } else if (start.starts_with("\x89HDF\r\n")) {
    fault_ = "is an HDF5 file, not text";
  } else if (start.substr(0, 4096).find('\0') != std::string_view::npos) {
    fault_ = "is a binary file, not text";
  }
}

bool Lines::Fill() {
  if (at_end_) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  for (;;) {
    const ssize_t got = ::read(descriptor_, buffer_.data() + end_, buffer_.size() - end_);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fault_ = "cannot be read: " + std::generic_category().message(errno);
    at_end_ = got <= 0;
    if (got > 0) end_ += static_cast<std::size_t>(got);
    return got > 0;
  }
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
    const std::size_t stop = found == nullptr ? end_ : static_cast<std::size_t>(found - buffer_.data());
    std::string_view line(buffer_.data() + begin_, stop - begin_);
    begin_ = found == nullptr ? end_ : stop + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++number_;
    return line;
  }
}

std::string_view Trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

char FindSeparator(std::string_view header) {
  bool quoted = false, tab = false;
  for (const char c : header) {
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == ';') return ';';
    tab = tab || c == '\t';
  }
  return tab ? '\t' : ',';
}

std::optional<std::string_view> TakeCell(std::string_view& rest, char separator, std::string& storage, bool& more) {
  std::size_t start = 0;
  while (start < rest.size() && rest[start] == ' ') ++start;
  if (start == rest.size() || rest[start] != '"') {
    const std::size_t end = std::min(rest.find(separator), rest.size());
    const std::string_view cell = Trim(rest.substr(0, end));
    more = end < rest.size();
    rest.remove_prefix(more ? end + 1 : end);
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
  const std::size_t end = std::min(rest.find(separator), rest.size());
  if (!Trim(rest.substr(0, end)).empty()) return {};
  more = end < rest.size();
  rest.remove_prefix(more ? end + 1 : end);
  return Trim(storage);
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
  const std::string shown = fmt::format("\"{}\"{}", cell.substr(0, 40), cell.size() > 40 ? "..." : "");
  NumberReader lenient(true);
  if (lenient.Read(cell)) {
    if (mark_ == 0) return shown + " has a decimal comma, which needs \";\" or tab between the cells";
    return fmt::format("{} has another decimal mark than the numbers before, which have \"{}\"", shown, mark_);
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

}  // namespace dynoproof::trace::csv
