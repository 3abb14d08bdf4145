#include "base/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <sstream>
#include <string_view>
#include <tuple>

namespace dynoproof {
namespace {

/// A text whose bytes a terminal obeys (control characters, marks of direction, separators of lines) are shown instead:
/// names come from files, and a file must not write what looks like another message. Ends of lines and tabs stay.
std::string Shown(std::string_view text) {
  std::string shown;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = [&](std::size_t i) -> unsigned {
      return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
    };
    const unsigned first = byte(k), second = byte(k + 1), third = byte(k + 2);
    const unsigned code = first == 0xC2 ? second : (first & 0xF) << 12 | (second & 0x3F) << 6 | (third & 0x3F);
    const bool three = (first & 0xF0) == 0xE0;
    if ((first < 0x20 && first != '\n' && first != '\t') || first == 0x7F) {
      shown += fmt::format("\\x{:02x}", first);
    } else if (first == 0xC2 && code < 0xA0) {
      shown += fmt::format("\\x{:02x}", code);
      k += 1;
    } else if (three && ((code >= 0x200B && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) ||
                         (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF)) {
      shown += fmt::format("\\u{:04x}", code);
      k += 2;
    } else {
      shown += text[k];
    }
  }
  return shown;
}

}  // namespace

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
      text += fmt::format("{}:{}:{}: ", Shown(item.where.file), item.where.line, item.where.column);
    } else if (!item.where.file.empty()) {
      text += Shown(item.where.file) + ": ";
    }
    text += paint(error ? "1;31" : "1;33", error ? "error" : "warning") + ": " + Shown(item.message) + "\n";
    const auto source = sources_.find(item.where.file);
    const bool quoted =
        item.where.known() && source != sources_.end() && item.where.line <= static_cast<int>(source->second.size());
    const std::string tail =
        Shown(item.hint + (item.more.empty() ? "" : (item.hint.empty() ? "" : "   ") + ("more: " + item.more)));
    if (quoted) {
      const std::string& line = source->second[item.where.line - 1];
      text += fmt::format("{:>5} | {}\n", item.where.line, Shown(line));
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
