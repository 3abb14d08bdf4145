#include "scenario/load.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/text.h"
#include "base/text_safety.h"
#include "scenario/find.h"
#include "scenario/nesting.h"

namespace dynoproof {
namespace {

namespace fs = std::filesystem;

SourceSpan Span(const toml::source_region& source, const std::string& file) {
  SourceSpan span{file, static_cast<int>(source.begin.line), static_cast<int>(source.begin.column), 1};
  if (source.end.line == source.begin.line) {
    span.length = std::max(1, static_cast<int>(source.end.column) - static_cast<int>(source.begin.column));
  }
  return span;
}

/// Names go into messages, traces, tables and file names: one with a line end could write what looks like another line.
bool CheckKey(std::string_view key, const SourceSpan& where, Diagnostics& diagnostics) {
  if (WithoutControls(key) == key) return true;
  diagnostics.Error(where, fmt::format("the key {} has control characters", Shown(key)),
                    "letters, digits and underscores");
  return false;
}

Value Convert(const toml::node& node, const std::string& file, Diagnostics& diagnostics) {
  Value value;
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table) {
      SourceSpan where = Span(key.source(), file);
      where.length = static_cast<int>(key.str().size());
      if (!CheckKey(key.str(), where, diagnostics)) continue;
      value.table().push_back({std::string(key.str()), Convert(child, file, diagnostics), where});
    }
    // toml++ keeps tables in the order of their keys; a scenario reads in the order of writing.
    std::stable_sort(value.table().begin(), value.table().end(), [](const Value::Entry& a, const Value::Entry& b) {
      return std::pair(a.where.line, a.where.column) < std::pair(b.where.line, b.where.column);
    });
  } else if (const toml::array* array = node.as_array()) {
    Value::Array items;
    for (const toml::node& child : *array) items.push_back(Convert(child, file, diagnostics));
    value = Value(std::move(items));
  } else if (const auto* integer = node.as_integer()) {
    value = Value(integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    value = Value(number->get());
  } else if (const auto* boolean = node.as_boolean()) {
    value = Value(boolean->get());
  } else if (const auto* text = node.as_string()) {
    value = Value(text->get());
  } else {
    diagnostics.Error(Span(node.source(), file), "dates and times have no meaning in a scenario", "write a string");
    value = Value("");
  }
  value.set_where(Span(node.source(), file));
  return value;
}

/// The most files that a scenario may take in. One that is named twice counts twice: it is merged anew each time.
constexpr int kMostFiles = 1000;

/// Parses one file; nothing after a syntax error or when it cannot be read.
std::optional<Value> ParseFile(const std::string& file, const SourceSpan& asked_by, Diagnostics& diagnostics) {
  std::error_code error;
  const bool regular = fs::is_regular_file(file, error);
  const std::optional<std::string> text = regular ? ReadTextFile(file) : std::nullopt;
  if (!text) {
    diagnostics.Error(asked_by, fmt::format("cannot read \"{}\"", file),
                      fs::is_directory(file, error) ? "it is a folder" : "is the path right?");
    return std::nullopt;
  }
  diagnostics.AddSource(file, *text);
  if (const std::optional<int> line = LineTooDeep(*text)) {
    diagnostics.Error({file, *line, 1, 1}, fmt::format("more than {} tables and lists lie in one another", kMostLevels),
                      "write them side by side");
    return std::nullopt;
  }
  try {
    const toml::table table = toml::parse(*text, file);
    return Convert(table, file, diagnostics);
  } catch (const toml::parse_error& fault) {
    diagnostics.Error(Span(fault.source(), file), fmt::format("not TOML: {}", fault.description()),
                      "mend this first; further faults show after it");
    return std::nullopt;
  }
}

/// Merges `patch` into `base`: tables key by key, other values replaced. Effects and checks add up, those of `base`
/// first: a file that includes another and adds a check must not lose the others in silence.
void Include(Value& base, Value patch) {
  for (const char* key : {"effect", "check"}) {
    const Value* first = base.Find(key);
    Value* more = patch.Find(key);
    if (first == nullptr || more == nullptr || !first->is_array() || !more->is_array()) continue;
    more->array().insert(more->array().begin(), first->array().begin(), first->array().end());
  }
  MergeInto(base, patch);
}

/// Whether this program reads the format that a file says it has.
bool KnownFormat(const Value& root, Diagnostics& diagnostics) {
  constexpr std::int64_t kNewest = 1;
  const Value* format = root.Find("format");
  if (format == nullptr) return true;
  if (!format->is_integer() || format->integer() < 1) {
    diagnostics.Error(format->where(), "\"format\" is no version of the scenario format",
                      fmt::format("write format = {}", kNewest));
    return false;
  }
  if (format->integer() <= kNewest) return true;
  diagnostics.Error(
      format->where(),
      fmt::format("the file is of format {}, this program reads formats up to {}", format->integer(), kNewest),
      "take a newer dynoproof, which says so by `dynoproof --version`, or write the file for format 1");
  return false;
}

/// The files that are read for one scenario.
struct Files {
  std::set<std::string> open;  // to find circles
  int count = 0;
};

/// The file with its includes merged below it.
std::optional<Value> ReadWithIncludes(const std::string& file, const SourceSpan& asked_by, Files& files,
                                      Diagnostics& diagnostics) {
  if (++files.count > kMostFiles) {
    if (files.count == kMostFiles + 1)  // once is enough
      diagnostics.Error(asked_by, fmt::format("includes take in more than {} files", kMostFiles),
                        "each is counted as often as it is included: name it in one file alone");
    return std::nullopt;
  }
  std::set<std::string>& open = files.open;
  std::error_code error;
  const std::string canonical = fs::weakly_canonical(file, error).string();
  if (!open.insert(canonical).second) {
    diagnostics.Error(asked_by, fmt::format("\"{}\" includes itself", file), "remove the circle");
    return std::nullopt;
  }
  std::optional<Value> own = ParseFile(file, asked_by, diagnostics);
  if (!own || !KnownFormat(*own, diagnostics)) {
    open.erase(canonical);
    return std::nullopt;
  }
  Value merged;
  merged.set_where(own->where());
  bool good = true;
  if (const Value* include = own->Find("include")) {
    const Value::Array list = include->is_array() ? include->array() : Value::Array{*include};
    for (const Value& item : list) {
      if (!item.is_string()) {
        diagnostics.Error(item.where(), fmt::format("\"include\" has {}", item.KindName()), "write file names");
        good = false;
        continue;
      }
      const std::string path = (fs::path(file).parent_path() / item.string()).lexically_normal().string();
      std::optional<Value> part = ReadWithIncludes(path, item.where(), files, diagnostics);
      if (part) Include(merged, *part);
      good = good && part.has_value();
    }
    own->Erase("include");
  }
  if (const Value* without = own->Find("without")) {
    const Value::Array list = without->is_array() ? without->array() : Value::Array{*without};
    for (const Value& item : list) {
      if (item.is_string() && merged.Find(item.string()) != nullptr) {
        merged.Erase(item.string());
        continue;
      }
      diagnostics.Error(item.where(), "\"without\" leaves out what no included file has",
                        "name sections of the included files, e.g. without = [\"check\"]");
      good = false;
    }
    own->Erase("without");
  }
  open.erase(canonical);
  if (!good) return std::nullopt;
  Include(merged, *own);
  return merged;
}

/// Moves the places of values parsed out of "v = TEXT" to where TEXT begins in the pseudo file "--set".
void MoveInto(Value& value, int line, int shift) {
  value.set_where({"--set", line, value.where().column + shift, value.where().length});
  if (value.is_array()) {
    for (Value& item : value.array()) MoveInto(item, line, shift);
  } else if (value.is_table()) {
    for (Value::Entry& entry : value.table()) {
      entry.where = {"--set", line, entry.where.column + shift, entry.where.length};
      MoveInto(entry.value, line, shift);
    }
  }
}

/// The deepest part of a dotted path that exists: its value, and its own path ("" for the root).
std::pair<Value*, std::string> DeepestKnown(Value& root, std::string path) {
  for (;;) {
    const std::size_t last = path.rfind('.');
    path = last == std::string::npos ? "" : path.substr(0, last);
    if (Value* here = root.FindPath(path)) return {here, path};
  }
}

/// Applies "a.b.c=value", written in line `number` of the pseudo file "--set".
void Override(Value& root, const std::string& text, int number, Diagnostics& diagnostics) {
  const std::size_t equals = text.find('=');
  const std::string path = text.substr(0, std::min(equals, text.size()));
  const SourceSpan where{"--set", number, 1, std::max(1, static_cast<int>(path.size()))};
  const bool gap = path.starts_with('.') || path.ends_with('.') || path.find("..") != std::string::npos;
  if (equals == std::string::npos || path.empty() || gap) {
    diagnostics.Error(where, fmt::format("\"{}\" is no override", text), "write --set path.to.key=value");
    return;
  }
  if (!CheckKey(path, where, diagnostics)) return;
  if (std::ranges::count(path, '.') >= kMostLevels || LineTooDeep("v = " + text.substr(equals + 1))) {
    diagnostics.Error(where, fmt::format("more than {} tables and lists would lie in one another", kMostLevels),
                      "write --set path.to.key=value");
    return;
  }
  Value value = ParseTomlValue(text.substr(equals + 1));
  constexpr int kBegin = 5;  // column at which TEXT stands in "v = TEXT"
  MoveInto(value, number, static_cast<int>(equals) + 2 - kBegin);
  value.set_where(
      {"--set", number, static_cast<int>(equals) + 2, std::max(1, static_cast<int>(text.size() - equals) - 1)});
  if (Value* old = root.FindPath(path)) {
    if (old->is_number() && !value.is_number()) {
      diagnostics.Error(value.where(), fmt::format("\"{}\" is a number", path), "write a number");
      return;
    }
    // 2 for 2.0 is what a person types; the kind of the old value is kept where it loses nothing.
    const SourceSpan span = value.where();
    if (value.is_integer() && old->is_number() && !old->is_integer()) value = Value(value.number());
    value.set_where(span);
    *old = std::move(value);
    return;
  }
  const auto [parent, known] = DeepestKnown(root, path);
  const std::string missing = path.substr(known.empty() ? 0 : known.size() + 1);
  const std::size_t dot = missing.find('.');
  const std::vector<std::string> keys = KeysOf(*parent);
  // A new section is made when nothing is named nearly like it: whoever reads the scenario knows whether it may be
  // there.
  const std::optional<std::string> near =
      dot == std::string::npos ? std::nullopt : Closest(missing.substr(0, dot), keys);
  if (parent->is_table() && !near) {
    Value* into = parent;
    std::string rest = missing;
    for (std::size_t end = rest.find('.');; end = rest.find('.')) {
      const std::string key = rest.substr(0, end);
      Value& made = (*into)[key];
      made.set_where(where);
      into->table().back().where = where;
      into = &made;
      if (end == std::string::npos) break;
      rest = rest.substr(end + 1);
    }
    *into = std::move(value);
    return;
  }
  const std::string full = known.empty() ? "" : known + ".";
  diagnostics.Error(where, fmt::format("the scenario has no \"{}\"", path),
                    near                 ? fmt::format("did you mean \"{}{}\"?", full, *near)
                    : parent->is_array() ? fmt::format("\"{}\" has the items 0 ... {}", known,
                                                       static_cast<int>(parent->array().size()) - 1)
                                         : fmt::format("\"{}\" is {}", known, parent->KindName()));
}

bool BareKey(const std::string& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

std::string Quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string Key(const std::string& key) { return BareKey(key) ? key : Quoted(key); }

}  // namespace

std::string InlineToml(const Value& value) {
  if (value.is_string()) return Quoted(value.string());
  if (value.is_bool()) return value.boolean() ? "true" : "false";
  if (value.is_integer()) return fmt::format("{}", value.integer());
  if (value.is_array() || value.is_table()) {
    std::vector<std::string> items;
    if (value.is_array()) {
      for (const Value& item : value.array()) items.push_back(InlineToml(item));
      return fmt::format("[{}]", fmt::join(items, ", "));
    }
    for (const Value::Entry& entry : value.table()) items.push_back(Key(entry.key) + " = " + InlineToml(entry.value));
    return fmt::format("{{ {} }}", fmt::join(items, ", "));
  }
  std::string number = fmt::format("{}", value.number());  // the shortest text that reads back the same
  if (number.find_first_of(".en") == std::string::npos) number += ".0";
  return number;
}

namespace {

bool TableArray(const Value& value) {
  return value.is_array() && !value.array().empty() &&
         std::all_of(value.array().begin(), value.array().end(), [](const Value& item) { return item.is_table(); });
}

void WriteTable(const Value& table, const std::string& path, int depth, std::string& out) {
  for (const Value::Entry& entry : table.table()) {
    const bool section = (entry.value.is_table() && depth < 2) || (depth == 0 && TableArray(entry.value));
    if (!section) out += Key(entry.key) + " = " + InlineToml(entry.value) + "\n";
  }
  for (const Value::Entry& entry : table.table()) {
    const std::string name = path.empty() ? Key(entry.key) : path + "." + Key(entry.key);
    if (entry.value.is_table() && depth < 2) {
      std::string body;
      WriteTable(entry.value, name, depth + 1, body);
      // A table that holds nothing but tables needs no line of its own.
      if (body.empty() || !body.starts_with("\n[")) out += fmt::format("\n[{}]\n", name);
      out += body;
    } else if (depth == 0 && TableArray(entry.value)) {
      for (const Value& item : entry.value.array()) {
        out += fmt::format("\n[[{}]]\n", name);
        WriteTable(item, name, 2, out);
      }
    }
  }
}

}  // namespace

std::optional<Plan> LoadPlan(const std::string& file, const std::vector<std::string>& overrides,
                             Diagnostics& diagnostics) {
  Files files;
  std::optional<Value> root = ReadWithIncludes(file, {file}, files, diagnostics);
  if (!root) return std::nullopt;
  std::string text;
  for (const std::string& one : overrides) text += one + "\n";
  diagnostics.AddSource("--set", text);
  for (std::size_t i = 0; i < overrides.size(); ++i) {
    Override(*root, overrides[i], static_cast<int>(i) + 1, diagnostics);
  }
  if (const Value* deep = ValueTooDeep(*root)) {
    diagnostics.Error(deep->where(), fmt::format("more than {} tables and lists lie in one another", kMostLevels),
                      "write them side by side");
    return std::nullopt;
  }
  if (!KnownFormat(*root, diagnostics)) return std::nullopt;
  return Plan{ScenarioId(file), file, std::move(*root)};
}

std::string ToToml(const Value& root) {
  std::string out;
  WriteTable(root, "", 0, out);
  return out;
}

std::optional<Value> FromToml(const std::string& text) {
  if (LineTooDeep(text)) return std::nullopt;
  try {
    Diagnostics ignored;
    return Convert(toml::parse(text), "", ignored);
  } catch (const toml::parse_error&) {
    return std::nullopt;
  }
}

Value ParseTomlValue(const std::string& text) {
  if (LineTooDeep("v = " + text)) return Value(text);
  try {
    const toml::table table = toml::parse("v = " + text);
    Diagnostics ignored;
    if (const toml::node* node = table.get("v"); node != nullptr && table.size() == 1) {
      return Convert(*node, "", ignored);
    }
  } catch (const toml::parse_error&) {
    // Bare words are strings: --set run.solver=reference.
  }
  return Value(text);
}

}  // namespace dynoproof
