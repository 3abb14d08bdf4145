#include "reduce/moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace dynoproof::reduce {
namespace {

/// Stands for an item of a list that is gone, so that the others keep their numbers until all moves are done.
const char* const kGone = "\x01gone";

bool IsGone(const Value& value) { return value.is_string() && value.string() == kGone; }

void Sweep(Value& value) {
  if (value.is_array()) {
    std::erase_if(value.array(), IsGone);
    for (Value& item : value.array()) Sweep(item);
  }
  if (!value.is_table()) return;
  for (Value::Entry& entry : value.table()) Sweep(entry.value);
  std::erase_if(value.table(), [](const Value::Entry& entry) {
    const bool empty_list = entry.value.is_array() && entry.value.array().empty();
    return IsGone(entry.value) || empty_list || (entry.value.is_table() && entry.value.table().empty());
  });
}

Move Without(const std::vector<std::string>& paths, std::string what) {
  return {std::move(what), [paths](Value& root) {
            bool any = false;
            for (const std::string& path : paths) {
              Value* value = root.FindPath(path);
              if (value == nullptr || IsGone(*value)) continue;
              *value = Value(kGone);
              any = true;
            }
            return any;
          }};
}
Move Without(const std::string& path) { return Without({path}, path); }

/// The body of an end: "I1" of "I1.left".
std::string BodyOf(std::string_view end) { return std::string(end.substr(0, end.find('.'))); }

/// Texts of lists and single ones below `value` that name the body, or one of its ends, get another name.
void Rename(Value& value, const std::string& from, const std::string& to) {
  if (value.is_string() &&
      (value.string() == from || value.string() == from + ".left" || value.string() == from + ".right"))
    value = Value(to);
  if (value.is_array()) {
    for (Value& item : value.array()) Rename(item, from, to);
  }
}

/// All that hangs on one body of a drive line, or is seen of it, does so on another.
void Rehang(Value& root, const std::string& from, const std::string& to) {
  for (const char* section : {"shaft", "load", "torque", "run"}) {
    Value* entries = root.FindPath(std::string("plant.") + section);
    if (entries == nullptr || !entries->is_table()) continue;
    for (Value::Entry& entry : entries->table()) {
      for (const char* key : {"between", "on", "inertias"}) {
        if (Value* names = entry.value.Find(key); names != nullptr) Rename(*names, from, to);
      }
    }
  }
  Value* outputs = root.Find("output");
  if (outputs == nullptr || !outputs->is_table()) return;
  for (Value::Entry& entry : outputs->table()) {
    Value* of = entry.value.Find("of");
    if (of == nullptr || !of->is_string()) continue;
    for (const std::string end : {".left", ".right", ""}) {
      const std::string prefix = "plant." + from + end + ".";
      if (!of->string().starts_with(prefix)) continue;
      *of = Value("plant." + to + "." + of->string().substr(prefix.size()));
      break;
    }
  }
}

/// A rotor of slices becomes one inertia: the modes within it are gone.
Move Lump(const std::string& name) {
  return {fmt::format("rotor {} is one inertia", name), [name](Value& root) {
            Value* rotor = root.FindPath("plant.rotor." + name);
            if (rotor == nullptr || !rotor->is_table()) return false;
            const Value* inertia = rotor->Find("inertia_kg_m2");
            if (inertia == nullptr) return false;
            const Value moved = *inertia;
            root["plant"]["rotor"].Erase(name);
            root["plant"]["inertia"][name] = moved;
            Rehang(root, name, name);
            if (Value* torques = root.FindPath("plant.torque"); torques != nullptr && torques->is_table()) {
              for (Value::Entry& entry : torques->table()) entry.value.Erase("slices");
            }
            return true;
          }};
}

/// Two bodies that a shaft joins become one.
Move Merge(const std::string& shaft) {
  return {fmt::format("shaft {} is rigid", shaft), [shaft](Value& root) {
            const Value* between = root.FindPath("plant.shaft." + shaft + ".between");
            if (between == nullptr || !between->is_array() || between->array().size() != 2 ||
                !between->array()[0].is_string() || !between->array()[1].is_string())
              return false;
            const std::string a = BodyOf(between->array()[0].string()), b = BodyOf(between->array()[1].string());
            Value *first = root.FindPath("plant.inertia." + a), *second = root.FindPath("plant.inertia." + b);
            if (a == b || first == nullptr || second == nullptr || !first->is_number() || !second->is_number())
              return false;
            *first = Value(first->number() + second->number());
            root["plant"]["inertia"].Erase(b);
            root["plant"]["shaft"].Erase(shaft);
            Rehang(root, b, a);
            return true;
          }};
}

const Value::Table& TableAt(const Value& root, std::string_view path) {
  static const Value::Table none;
  const Value* value = root.FindPath(path);
  return value != nullptr && value->is_table() ? value->table() : none;
}

/// Stiff ones first: they move least.
std::vector<Move> Merges(const Value& root) {
  std::vector<std::pair<double, std::string>> shafts;
  for (const Value::Entry& entry : TableAt(root, "plant.shaft"))
    shafts.emplace_back(-entry.value.NumberOr("stiffness_Nm_per_rad", 0.0), entry.key);
  std::ranges::sort(shafts);
  std::vector<Move> moves;
  for (const auto& [stiffness, name] : shafts) moves.push_back(Merge(name));
  return moves;
}

std::vector<Move> Sections(const Value& root) {
  std::vector<Move> moves;
  for (const Value::Entry& entry : root.table()) {
    if (entry.key == "run" || entry.key == "plant" || entry.key == "input" || entry.key == "output" ||
        entry.key == "check" || entry.key == "effect" || entry.key == "control")
      continue;
    moves.push_back(Without(entry.key));
  }
  for (const Value::Entry& entry : TableAt(root, "control")) moves.push_back(Without("control." + entry.key));
  return moves;
}

std::vector<Move> Signals(const Value& root, const std::vector<std::string>& kept) {
  std::vector<Move> moves;
  const auto wanted = [&](const std::string& name) { return std::ranges::count(kept, name) > 0; };
  for (const Value::Entry& entry : TableAt(root, "output")) {
    if (!wanted(entry.key)) moves.push_back(Without("output." + entry.key));
  }
  for (const Value::Entry& entry : TableAt(root, "input")) {
    if (wanted(entry.key)) continue;
    std::vector<std::string> paths = {"input." + entry.key};
    // With the torque that it drives.
    const std::string to = entry.value.TextOr("to");
    if (to.starts_with("plant.")) paths.push_back("plant.torque." + to.substr(6));
    moves.push_back(Without(paths, paths.front()));
  }
  for (const char* list : {"effect", "check"}) {
    const Value* items = root.Find(list);
    if (items == nullptr || !items->is_array() || items->array().size() < (std::string_view(list) == "check" ? 2U : 1U))
      continue;
    for (std::size_t i = 0; i < items->array().size(); ++i) moves.push_back(Without(fmt::format("{}.{}", list, i)));
  }
  return moves;
}

std::vector<Move> Stages(const Value& root) {
  std::vector<Move> moves;
  for (const auto& [section, chain] : {std::pair("input", "actuator"), std::pair("output", "sensor")}) {
    for (const Value::Entry& entry : TableAt(root, section)) {
      const Value* stages = entry.value.Find(chain);
      const std::string path = fmt::format("{}.{}.{}", section, entry.key, chain);
      if (stages == nullptr) continue;
      if (!stages->is_array()) {
        moves.push_back(Without(path));
        continue;
      }
      for (std::size_t i = 0; i < stages->array().size(); ++i) moves.push_back(Without(fmt::format("{}.{}", path, i)));
    }
  }
  return moves;
}

/// Entries of the plant's tables: loads, shafts, inertias, whatever the plant calls its parts.
std::vector<Move> Parts(const Value& root) {
  std::vector<Move> moves;
  for (const Value::Entry& section : TableAt(root, "plant")) {
    for (const Value::Entry& entry : TableAt(root, "plant." + section.key)) {
      if (entry.value.is_table()) moves.push_back(Without(fmt::format("plant.{}.{}", section.key, entry.key)));
    }
  }
  return moves;
}

void Leaves(const Value& value, const std::string& path, std::vector<std::string>& paths) {
  if (!value.is_table()) {
    paths.push_back(path);
    return;
  }
  for (const Value::Entry& entry : value.table())
    Leaves(entry.value, path.empty() ? entry.key : path + "." + entry.key, paths);
}

std::vector<Move> Keys(const Value& root) {
  std::vector<std::string> paths;
  for (const Value::Entry& entry : root.table()) {
    if (entry.key != "check") Leaves(entry.value, entry.key, paths);
  }
  std::vector<Move> moves;
  for (const std::string& path : paths) moves.push_back(Without(path));
  return moves;
}

void RoundAll(const Value& value, const std::string& path, int digits, std::vector<Move>& moves) {
  if (value.is_number() && !value.is_integer() && Rounded(value.number(), digits) != value.number()) {
    moves.push_back({fmt::format("{} in {} digits", path, digits), [path, digits](Value& root) {
                       Value* number = root.FindPath(path);
                       if (number == nullptr || !number->is_number()) return false;
                       *number = Value(Rounded(number->number(), digits));
                       return true;
                     }});
  }
  if (value.is_table()) {
    for (const Value::Entry& entry : value.table()) RoundAll(entry.value, path + "." + entry.key, digits, moves);
  }
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.array().size(); ++i)
      RoundAll(value.array()[i], fmt::format("{}.{}", path, i), digits, moves);
  }
}

std::vector<Move> Digits(const Value& root, int digits) {
  std::vector<Move> moves;
  for (const char* section : {"plant", "input", "control"}) {
    if (const Value* values = root.Find(section); values != nullptr) RoundAll(*values, section, digits, moves);
  }
  return moves;
}

}  // namespace

double Rounded(double value, int digits) { return std::stod(fmt::format("{:.{}e}", value, digits - 1)); }

std::vector<Group> GroupsOf(const Value& root, const std::vector<std::string>& kept) {
  std::vector<Move> lumps;
  for (const Value::Entry& entry : TableAt(root, "plant.rotor")) lumps.push_back(Lump(entry.key));
  std::vector<Group> groups = {{"sections", Sections(root)}, {"signals, effects and checks", Signals(root, kept)},
                               {"rotors", std::move(lumps)}, {"stages", Stages(root)},
                               {"bodies", Merges(root)},     {"parts of the plant", Parts(root)},
                               {"keys", Keys(root)},         {"digits", Digits(root, 2)}};
  std::erase_if(groups, [](const Group& group) { return group.moves.empty(); });
  return groups;
}

void Apply(const std::vector<Move>& moves, Value& root) {
  for (const Move& move : moves) move.apply(root);
  Sweep(root);
}

}  // namespace dynoproof::reduce
