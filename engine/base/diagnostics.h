// Faults of a user's file, each with its place, what was seen, and what to write instead. All of them are collected and
// shown in one go.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace dynoproof {

/// A piece of a source text. Lines and columns count from 1; line 0 means the place is not in a file.
struct SourceSpan {
  std::string file;  // as the user wrote it, or "--set"
  int line = 0;
  int column = 0;
  int length = 1;

  bool known() const { return line > 0; }
};

struct Diagnostic {
  enum class Severity { kError, kWarning };
  Severity severity = Severity::kError;
  SourceSpan where;
  std::string message;  // what was seen and which rule it breaks
  std::string hint;     // what to write instead; may be empty
  std::string more;     // a command to read on; may be empty
};

class Diagnostics {
 public:
  /// Keeps the text of a file so that messages can quote the line. `file` is the name used in SourceSpan.
  void AddSource(const std::string& file, const std::string& text);

  void Error(const SourceSpan& where, std::string message, std::string hint = "", std::string more = "");
  void Warning(const SourceSpan& where, std::string message, std::string hint = "", std::string more = "");

  bool has_errors() const;
  int error_count() const;
  const std::vector<Diagnostic>& items() const { return items_; }

  /// Takes over the items and sources of another collection.
  void Append(const Diagnostics& other);

  /// All items in the order of file and line, each as `file:line:col: error: message` with the quoted line, a marker
  /// under the place, and the hint. `colour` adds terminal colours.
  std::string Format(bool colour = false) const;

 private:
  std::vector<Diagnostic> items_;
  std::map<std::string, std::vector<std::string>> sources_;  // file -> lines
};

}  // namespace dynoproof
