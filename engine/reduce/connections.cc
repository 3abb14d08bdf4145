#include "reduce/connections.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "reduce/tree.h"

namespace dynoproof::reduce {
namespace {

/// A number or table that others name: "plant.inertia.I5" is "plant.I5" elsewhere, and "I5" within the plant.
bool Names(const std::string& text, const std::string& holder, const std::string& path) {
  const std::string first = path.substr(0, path.find('.')), last = path.substr(path.rfind('.') + 1);
  const std::string full = first + "." + last;
  if (text == full || text.starts_with(full + ".")) return true;
  if (first == "plant") return (holder.starts_with("plant.") && BodyOf(text) == last) || text.ends_with(":" + last);
  if (first == "variant") return holder.starts_with("check.") && text == last;
  const bool by_signal = holder.starts_with("check.") || holder.starts_with("variant.") || holder == "analysis";
  return (first == "input" || first == "output") && ((by_signal && text == last) || text == first + ":" + last);
}

bool NamesAny(const Value& value, const std::string& holder, const std::string& path) {
  if (value.is_string()) return Names(value.string(), holder, path);
  if (value.is_array())
    return std::ranges::any_of(value.array(), [&](const Value& item) { return NamesAny(item, holder, path); });
  return value.is_table() && std::ranges::any_of(value.table(), [&](const Value::Entry& entry) {
           return NamesAny(entry.value, holder, path);
         });
}

double LevelAt(const Levels& levels, const std::string& path) {
  const auto level = levels.find(path);
  return level != levels.end() ? level->second : 0.0;
}

/// Takes what names the part out of its holder where the holder can do without: of lists their items, and a loop that runs through
/// it is opened, at its level. False: the holder goes as well.
bool LetGo(Value& holder, const std::string& at, const std::string& path, const Levels& levels) {
  if (!holder.is_table()) return false;
  for (Value::Entry& entry : holder.table()) {
    if (!NamesAny(entry.value, at, path)) continue;
    if (entry.value.is_array() && entry.key != "between") {
      std::erase_if(entry.value.array(), [&](const Value& item) { return NamesAny(item, at, path); });
      if (entry.value.array().empty()) return false;
    } else if (at.starts_with("input.") && entry.key == "from") {
      entry = {"source", Value{{"type", "constant"}, {"value", LevelAt(levels, at)}}, {}};
    } else {
      return false;
    }
  }
  return true;
}

/// The torques of the plant that an input may drive.
std::vector<std::string> TorquesOf(const Value& input) {
  std::vector<std::string> torques;
  const Value* to = input.Find("to");
  if (to == nullptr) return torques;
  for (const Value& port : to->is_array() ? to->array() : Value::Array{*to}) {
    if (port.is_string() && port.string().starts_with("plant."))
      torques.push_back("plant.torque." + port.string().substr(6));
  }
  return torques;
}

/// A port of the plant that a part drives is driven by an input that stays at the level which was seen there. False where none was.
bool HoldPort(Value& root, const std::string& path, const Levels& levels) {
  Value* port = root.FindPath(path);
  const std::string name = path.substr(path.rfind('.') + 1);
  if (!path.starts_with("plant.inputs.") || !port->is_string() || !levels.contains(port->string()) ||
      root.FindPath("input." + name) != nullptr)
    return false;
  const double level = LevelAt(levels, port->string());
  *port = Value(kGone);
  root["input"][name] = Value{{"to", "plant." + name}, {"source", Value{{"type", "constant"}, {"value", level}}}};
  return true;
}

/// A part goes with all that cannot be without it: with an inertia its shafts, what acts on it and what is seen of it. False where
/// that takes what is kept.
bool TakeWithAll(Value& root, const std::string& path, const Known& known) {
  Value* part = root.FindPath(path);
  if (part == nullptr || IsGone(*part)) return false;
  const std::string section = path.substr(0, path.find('.')), name = path.substr(path.rfind('.') + 1);
  if (section == "check" || ((section == "input" || section == "output") && std::ranges::count(known.kept, name) > 0))
    return false;
  // A torque that nothing drives any more goes, too.
  std::vector<std::string> driven;
  if (path.starts_with("plant.inputs.")) driven.push_back("plant.torque." + name);
  if (section == "input") driven = TorquesOf(*part);
  *part = Value(kGone);
  for (const std::string& torque : driven) {
    if (Value* one = root.FindPath(torque); one != nullptr) *one = Value(kGone);
  }
  for (const std::string& at : PartsOf(root)) {
    Value* holder = root.FindPath(at);
    if (holder == nullptr || IsGone(*holder) || !NamesAny(*holder, at, path)) continue;
    if (LetGo(*holder, at, path, known.levels) || HoldPort(root, at, known.levels)) continue;
    if (!TakeWithAll(root, at, known)) return false;
  }
  return true;
}

/// The port of the same name that asks the part of a port, by way of the parts that feed it: of "part.machine.torque" the
/// "control.core.T_ref" that its control takes as torque, or "input.T_set".
std::optional<std::string> AskedOf(const Value& root, const std::string& port) {
  const auto part_of = [](const std::string& text) { return text.substr(0, text.rfind('.')); };
  const std::string name = port.substr(port.rfind('.') + 1);
  std::vector<std::string> parts = {part_of(port)};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const Value::Entry& input : TableAt(root, "input")) {
      if (input.value.TextOr("to") == parts[i] + "." + name) return "input." + input.key;
    }
    const std::string inputs = parts[i] + ".inputs";
    for (const Value::Entry& input : TableAt(root, inputs)) {
      const std::string from = input.value.is_string() ? input.value.string() : "";
      if (!from.starts_with("control.") && !from.starts_with("part.")) continue;
      if (input.key == name) return from;
      if (std::ranges::count(parts, part_of(from)) == 0) parts.push_back(part_of(from));
    }
  }
  return std::nullopt;
}

/// A machine and its control give the torque that they are asked for: what they drive takes that from where they did.
Move Shortcut(const std::string& path, const std::string& port, const Known& known) {
  return {fmt::format("{} is what {} is asked for", path, port), [path, port, known](Value& root) {
            Value without = root;
            const std::optional<std::string> asked = AskedOf(root, port);
            Value* end = without.FindPath(path);
            if (!asked || end == nullptr || IsGone(*end)) return false;
            const bool by_input = asked->starts_with("input.");
            if (!by_input && end->is_string()) {
              *end = Value(*asked);
            } else if (!by_input) {
              (*end)["from"] = Value(*asked);
            } else if (end->is_string()) {
              *end = Value(kGone);
              (*without.FindPath(*asked))["to"] = Value("plant." + path.substr(path.rfind('.') + 1));
            } else {
              const Value input = *without.FindPath(*asked);
              end->Erase("from");
              for (const char* key : {"source", "from"}) {
                if (const Value* drives = input.Find(key); drives != nullptr) (*end)[key] = *drives;
              }
            }
            if (!TakeWithAll(without, port.substr(0, port.rfind('.')), known)) return false;
            root = std::move(without);
            return true;
          }};
}

bool NamesAPart(const Value& value) {
  if (value.is_string()) return value.string().starts_with("control.") || value.string().starts_with("part.");
  if (value.is_array()) return std::ranges::any_of(value.array(), NamesAPart);
  return value.is_table() &&
         std::ranges::any_of(value.table(), [](const Value::Entry& entry) { return NamesAPart(entry.value); });
}

void Merge(Value& into, const Value& from) {
  if (!into.is_table() || !from.is_table()) {
    into = from;
    return;
  }
  for (const Value::Entry& entry : from.table()) {
    Value* there = into.Find(entry.key);
    if (there != nullptr) Merge(*there, entry.value);
    if (there == nullptr) into[entry.key] = entry.value;
  }
}

}  // namespace

std::vector<std::string> PartsOf(const Value& root) {
  std::vector<std::string> paths;
  for (const Value::Entry& section : root.table()) {
    const bool list = section.value.is_array();
    if (list && !section.value.array().empty() && section.value.array().front().is_table()) {
      for (std::size_t i = 0; i < section.value.array().size(); ++i)
        paths.push_back(fmt::format("{}.{}", section.key, i));
    }
    if (section.key == "analysis") paths.push_back(section.key);
    if (!section.value.is_table() || section.key == "analysis" || section.key == "run") continue;
    for (const Value::Entry& entry : section.value.table()) {
      const std::string path = section.key + "." + entry.key;
      if (section.key != "plant") paths.push_back(path);
      if (section.key != "plant" || !entry.value.is_table()) continue;
      for (const Value::Entry& part : entry.value.table()) paths.push_back(path + "." + part.key);
    }
  }
  return paths;
}

Move WithAll(const std::string& path, const Known& known) {
  return {path, [path, known](Value& root) {
            Value without = root;
            if (!TakeWithAll(without, path, known)) return false;
            root = std::move(without);
            return true;
          }};
}

std::vector<Move> Shortcuts(const Value& root, const Known& known) {
  std::vector<Move> moves;
  const auto add = [&](const std::string& path, const std::string& port) {
    if ((port.starts_with("control.") || port.starts_with("part.")) && AskedOf(root, port))
      moves.push_back(Shortcut(path, port, known));
  };
  for (const Value::Entry& entry : TableAt(root, "plant.inputs")) {
    if (entry.value.is_string()) add("plant.inputs." + entry.key, entry.value.string());
  }
  for (const Value::Entry& entry : TableAt(root, "input")) add("input." + entry.key, entry.value.TextOr("from"));
  return moves;
}

std::vector<Move> Adoptions(const Value& root) {
  std::vector<Move> moves;
  for (const Value::Entry& entry : TableAt(root, "variant")) {
    if (!NamesAPart(entry.value)) continue;
    const std::string path = "variant." + entry.key;
    moves.push_back({"all as in " + path, [path](Value& tree) {
                       const Value* variant = tree.FindPath(path);
                       if (variant == nullptr || !variant->is_table()) return false;
                       const Value taken = *variant;
                       Merge(tree, taken);
                       return true;
                     }});
  }
  return moves;
}

}  // namespace dynoproof::reduce
