#include "base/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <sstream>
#include <string_view>
#include <tuple>

#include "base/text_safety.h"

namespace dynoproof {
void Diagnostics::AddSource(const std::string& file, const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.ends_with('\r')) line.pop_back();
    lines.push_back(std::move(line));
  }
  sources_[file] = std::move(lines);
}

void Diagnostics::Error(const SourceSpan& where, std::string message, std::string hint, std::string more) {
  items_.push_back({Diagnostic::Severity::kError, where, std::move(message), std::move(hint), std::move(more)});
}

void Diagnostics::Warning(const SourceSpan& where, std::string message, std::string hint, std::string more) {
  // A component that is built several times, such as the source of a scenario with variants, warns once.
  const bool known = std::any_of(items_.begin(), items_.end(), [&](const Diagnostic& item) {
    return item.severity == Diagnostic::Severity::kWarning && item.message == message &&
           std::tie(item.where.file, item.where.line, item.where.column) ==
               std::tie(where.file, where.line, where.column);
  });
  if (known) return;
  items_.push_back({Diagnostic::Severity::kWarning, where, std::move(message), std::move(hint), std::move(more)});
}

int Diagnostics::error_count() const {
  return static_cast<int>(std::count_if(items_.begin(), items_.end(), [](const Diagnostic& item) {
    return item.severity == Diagnostic::Severity::kError;
  }));
}

bool Diagnostics::has_errors() const { return error_count() > 0; }

void Diagnostics::Append(const Diagnostics& other) {
  items_.insert(items_.end(), other.items_.begin(), other.items_.end());
  for (const auto& [file, lines] : other.sources_) sources_[file] = lines;
}

namespace {

/// Lines behind the first one stand further in: a line end in a text of the file begins no line that looks like a message.
std::string Hanging(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '\n' ? std::string("\n        ") : std::string(1, c);
  return result;
}

}  // namespace

std::string Diagnostics::Format(bool colour) const {
  std::vector<std::size_t> order(items_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
    const SourceSpan& left = items_[a].where;
    const SourceSpan& right = items_[b].where;
    return std::tie(left.file, left.line, left.column) < std::tie(right.file, right.line, right.column);
  });
  const auto paint = [colour](const char* code, const std::string& text) {
    return colour ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
  };
  std::string text;
  for (const std::size_t index : order) {
    const Diagnostic& item = items_[index];
    const bool error = item.severity == Diagnostic::Severity::kError;
    if (item.where.known()) {
      text += fmt::format("{}:{}:{}: ", Hanging(AsMessage(item.where.file)), item.where.line, item.where.column);
    } else if (!item.where.file.empty()) {
      text += Hanging(AsMessage(item.where.file)) + ": ";
    }
    text +=
        paint(error ? "1;31" : "1;33", error ? "error" : "warning") + ": " + Hanging(AsMessage(item.message)) + "\n";
    const auto source = sources_.find(item.where.file);
    const bool quoted =
        item.where.known() && source != sources_.end() && item.where.line <= static_cast<int>(source->second.size());
    const std::string tail = Hanging(
        AsMessage(item.hint + (item.more.empty() ? "" : (item.hint.empty() ? "" : "   ") + ("more: " + item.more))));
    if (quoted) {
      const std::string& line = source->second[item.where.line - 1];
      text += fmt::format("{:>5} | {}\n", item.where.line, AsMessage(line));
      // Tabs stay tabs in the marker line so that it lines up whatever the terminal's tab width.
      std::string pad;
      for (int i = 0; i + 1 < item.where.column; ++i) {
        pad += i < static_cast<int>(line.size()) && line[i] == '\t' ? '\t' : ' ';
      }
      const std::string marker(std::max(1, item.where.length), '^');
      text += "      | " + pad + paint("1;32", marker) + (tail.empty() ? "" : " " + tail) + "\n";
    } else if (!tail.empty()) {
      text += "        " + tail + "\n";
    }
  }
  return text;
}

}  // namespace dynoproof
