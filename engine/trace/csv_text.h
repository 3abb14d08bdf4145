// The small print of text records: lines, cells, numbers.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"

namespace dynoproof::trace::csv {

/// The lines of a file or pipe, read in blocks, without their ends (LF, CRLF, CR CR LF or CR) and without a byte order
/// mark.
class Lines {
 public:
  /// The descriptor is owned by the caller. More bytes than `most` are a fault, which `too_many` tells.
  Lines(int descriptor, std::size_t most, std::string too_many);

  /// The next line, valid until the following call; nothing at the end or after a fault.
  std::optional<std::string_view> Next();
  /// Number of the line that Next() gave last, from 1.
  std::size_t number() const { return number_; }
  /// Whether the line that Next() gave last is the file's last and has no line end.
  bool open_end() const { return open_end_; }
  /// What went wrong: a read error, too many bytes, or contents that are no text.
  const std::string& fault() const { return fault_; }

 private:
  bool Fill();
  void TakeLineEnds(std::size_t got);

  int descriptor_;
  std::size_t most_;
  std::string too_many_;
  std::string buffer_;
  std::size_t begin_ = 0, end_ = 0;  // the unread part of buffer_
  std::size_t returns_ = 0;          // carriage returns behind end_ of which it is open whether a line feed follows
  std::size_t total_ = 0;            // bytes read
  std::size_t number_ = 0;
  bool at_end_ = false, open_end_ = false;
  std::string fault_;
};

/// `text` without blanks and tabs at its ends.
std::string_view Trim(std::string_view text);

/// Instead of a separator: two blanks or more, or tabs; a cell may hold single blanks ("Shaft torque (Nm)").
inline constexpr char kWideBlanks = '\v';

/// Takes the next cell off `rest`, trimmed. Quoted cells lose their quotes, `storage` holds them if need be. Nothing
/// when a quote is not closed or followed by more text. `more` says whether a separator followed. The separator ' '
/// means any number of blanks and tabs, in a line that neither begins nor ends with one.
std::optional<std::string_view> TakeCell(std::string_view& rest, char separator, std::string& storage, bool& more);

/// All cells of a line; nothing if a quote is wrong.
std::optional<std::vector<std::string>> Split(std::string_view line, char separator);

/// Reads numbers, with an exponent of e, E or as Fortran has it d, D. Remembers the decimal mark from the first number
/// that has one, if it is not told.
class NumberReader {
 public:
  explicit NumberReader(bool comma_allowed, char mark = 0) : comma_allowed_(comma_allowed), mark_(mark) {}

  /// The value of a trimmed, non-empty cell, or nothing: then Explain() says why. Too small for a double is 0.
  std::optional<double> Read(std::string_view cell);
  /// Why `cell` is no number.
  std::string Explain(std::string_view cell) const;

 private:
  bool comma_allowed_;
  char mark_;
};

/// Whether the mark of a number may as well part thousands: "1,234", but not "0,234", "12,34" or "1,2345".
bool LooksLikeThousands(std::string_view number);

}  // namespace dynoproof::trace::csv
