// The small print of text records: lines, cells, numbers.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"

namespace dynoproof::trace::csv {

/// The lines of a file or pipe, read in blocks, without their ends (LF or CRLF) and without a byte order mark.
class Lines {
 public:
  explicit Lines(int descriptor);  // owned by the caller

  /// The next line, valid until the following call; nothing at the end or after a fault.
  std::optional<std::string_view> Next();
  /// Number of the line that Next() gave last, from 1.
  std::size_t number() const { return number_; }
  /// What went wrong: a read error, or contents that are no text.
  const std::string& fault() const { return fault_; }

 private:
  bool Fill();

  int descriptor_;
  std::string buffer_;
  std::size_t begin_ = 0, end_ = 0;  // the unread part of buffer_
  std::size_t number_ = 0;
  bool at_end_ = false;
  std::string fault_;
};

/// `text` without blanks and tabs at its ends.
std::string_view Trim(std::string_view text);

/// `;`, tab or `,` as csv.h says, from the row of names.
char FindSeparator(std::string_view header);

/// Takes the next cell off `rest`, trimmed. Quoted cells lose their quotes, `storage` holds them if need be. Nothing
/// when a quote is not closed or followed by more text. `more` says whether a separator followed.
std::optional<std::string_view> TakeCell(std::string_view& rest, char separator, std::string& storage, bool& more);

/// Reads numbers; remembers the decimal mark from the first number that has one.
class NumberReader {
 public:
  explicit NumberReader(bool comma_allowed) : comma_allowed_(comma_allowed) {}

  /// The value of a trimmed, non-empty cell, or nothing: then Explain() says why. Too small for a double is 0.
  std::optional<double> Read(std::string_view cell);
  /// Why `cell` is no number.
  std::string Explain(std::string_view cell) const;

 private:
  bool comma_allowed_;
  char mark_ = 0;
};

}  // namespace dynoproof::trace::csv
