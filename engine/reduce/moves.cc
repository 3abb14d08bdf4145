#include "reduce/moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
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

Move Without(const std::string& path) {
  return {path, [path](Value& root) {
            Value* value = root.FindPath(path);
            if (value == nullptr || IsGone(*value)) return false;
            *value = Value(kGone);
            return true;
          }};
}

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
  if (Value* effects = root.Find("effect"); effects != nullptr && effects->is_array()) {
    for (Value& effect : effects->array()) {
      if (Value* at = effect.Find("at"); at != nullptr) Rename(*at, "inertia:" + from, "inertia:" + to);
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

/// Everything that may name something else, or be named.
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

/// What the moves have to know beside the tree.
struct Known {
  std::vector<std::string> kept;  // signals that the check looks at
  Levels levels;
};

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

Move WithAll(const std::string& path, const Known& known) {
  return {path, [path, known](Value& root) {
            Value without = root;
            if (!TakeWithAll(without, path, known)) return false;
            root = std::move(without);
            return true;
          }};
}

const Value::Table& TableAt(const Value& root, std::string_view path) {
  static const Value::Table none;
  const Value* value = root.FindPath(path);
  return value != nullptr && value->is_table() ? value->table() : none;
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

/// Texts below `value` that name the part, or a port of it, name another one.
void NameAnew(Value& value, const std::string& from, const std::string& to) {
  if (value.is_string() && (value.string() == from || value.string().starts_with(from + ".")))
    value = Value(to + value.string().substr(from.size()));
  if (value.is_array()) {
    for (Value& item : value.array()) NameAnew(item, from, to);
  }
  if (!value.is_table()) return;
  for (Value::Entry& entry : value.table()) NameAnew(entry.value, from, to);
}

/// A shaft at the body.
std::optional<std::string> ShaftAt(const Value& root, const std::string& body) {
  for (const Value::Entry& entry : TableAt(root, "plant.shaft")) {
    const Value* between = entry.value.Find("between");
    for (const Value& end : between != nullptr && between->is_array() ? between->array() : Value::Array{}) {
      if (end.is_string() && BodyOf(end.string()) == body) return entry.key;
    }
  }
  return std::nullopt;
}

/// Two bodies that a shaft joins become one. What was seen of the shaft is seen of its neighbour.
Move Join(const std::string& shaft) {
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
            if (const auto neighbour = ShaftAt(root, a)) NameAnew(root, "plant." + shaft, "plant." + *neighbour);
            return true;
          }};
}

/// Stiff ones first: they move least.
std::vector<Move> Joints(const Value& root) {
  std::vector<std::pair<double, std::string>> shafts;
  for (const Value::Entry& entry : TableAt(root, "plant.shaft"))
    shafts.emplace_back(-entry.value.NumberOr("stiffness_Nm_per_rad", 0.0), entry.key);
  std::ranges::sort(shafts);
  std::vector<Move> moves;
  for (const auto& [stiffness, name] : shafts) moves.push_back(Join(name));
  return moves;
}

std::vector<Move> Sections(const Value& root) {
  std::vector<Move> moves;
  for (const Value::Entry& entry : root.table()) {
    if (entry.key == "run" || entry.key == "plant" || entry.key == "input" || entry.key == "output" ||
        entry.key == "check" || entry.key == "effect" || entry.key == "control" || entry.key == "part")
      continue;
    moves.push_back(Without(entry.key));
  }
  return moves;
}

std::vector<Move> Signals(const Value& root, const Known& known) {
  std::vector<Move> moves;
  const auto wanted = [&](const std::string& name) { return std::ranges::count(known.kept, name) > 0; };
  for (const Value::Entry& entry : TableAt(root, "output")) {
    if (!wanted(entry.key)) moves.push_back(Without("output." + entry.key));
  }
  for (const Value::Entry& entry : TableAt(root, "input")) {
    if (!wanted(entry.key)) moves.push_back(WithAll("input." + entry.key, known));
  }
  return moves;
}

/// Items of a list of tables of which `fewest` are none to take: of checks one stays.
std::vector<Move> Items(const Value& root, const std::string& list, std::size_t fewest) {
  std::vector<Move> moves;
  const Value* items = root.Find(list);
  if (items == nullptr || !items->is_array() || items->array().size() <= fewest) return moves;
  for (std::size_t i = 0; i < items->array().size(); ++i) moves.push_back(Without(fmt::format("{}.{}", list, i)));
  return moves;
}

std::vector<Move> Variants(const Value& root, const Known& known) {
  std::vector<Move> moves;
  for (const Value::Entry& entry : TableAt(root, "variant")) moves.push_back(WithAll("variant." + entry.key, known));
  return moves;
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

/// What a variant connects otherwise is connected so in all of the scenario: the parts that only the others need can go then.
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

/// Stages of actuators and sensors, and the pieces that a source adds up.
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
  for (const Value::Entry& entry : TableAt(root, "input")) {
    const std::string path = "input." + entry.key + ".source.sources";
    const Value* pieces = root.FindPath(path);
    if (pieces == nullptr || !pieces->is_array() || pieces->array().size() < 2) continue;
    for (std::size_t i = 0; i < pieces->array().size(); ++i) moves.push_back(Without(fmt::format("{}.{}", path, i)));
  }
  return moves;
}

/// Controls and other parts, and entries of the plant's tables: loads, shafts, inertias, whatever the plant calls its own.
std::vector<Move> Parts(const Value& root, const Known& known) {
  std::vector<Move> moves;
  for (const std::string& path : PartsOf(root)) {
    if (path.starts_with("control.") || path.starts_with("part.") || path.starts_with("plant."))
      moves.push_back(WithAll(path, known));
  }
  return moves;
}

/// What the part of a port is asked for at a port of the same name, by way of the parts that feed it: of "part.machine.torque" the
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

/// A sum of one piece is that piece.
std::vector<Move> Sums(const Value& root) {
  std::vector<Move> moves;
  for (const Value::Entry& entry : TableAt(root, "input")) {
    const std::string path = "input." + entry.key + ".source";
    moves.push_back({path + " is no sum", [path](Value& tree) {
                       Value* source = tree.FindPath(path);
                       Value* pieces = source != nullptr ? source->Find("sources") : nullptr;
                       if (pieces == nullptr || !pieces->is_array() || pieces->array().size() != 1) return false;
                       *source = Value(pieces->array().front());
                       return true;
                     }});
  }
  return moves;
}

/// The first of these keys of a source that holds a number, or a list that begins with one; 0 where none does. Of a sum all of it.
double LevelOf(const Value& source, std::initializer_list<const char*> keys) {
  if (const Value* pieces = source.Find("sources"); pieces != nullptr && pieces->is_array()) {
    double sum = 0.0;
    for (const Value& piece : pieces->array()) sum += piece.is_table() ? LevelOf(piece, keys) : 0.0;
    return sum;
  }
  for (const char* key : keys) {
    const Value* level = source.Find(key);
    if (level != nullptr && level->is_array() && !level->array().empty()) level = &level->array().front();
    if (level != nullptr && level->is_number()) return level->number();
  }
  return 0.0;
}

/// An input that stays where it begins, or that begins at its level and stays there: a step excites all that a chirp does.
std::vector<Move> Constants(const Value& root, bool where_it_begins) {
  std::vector<Move> moves;
  for (const Value::Entry& entry : TableAt(root, "input")) {
    const Value* source = entry.value.Find("source");
    if (source == nullptr || !source->is_table() || source->TextOr("type") == "constant") continue;
    const double value = where_it_begins ? LevelOf(*source, {"initial", "values", "from", "offset"})
                                         : LevelOf(*source, {"value", "amplitude", "amplitudes", "rms", "to"});
    if (!where_it_begins && value == 0.0) continue;
    const std::string path = "input." + entry.key + ".source";
    moves.push_back({fmt::format("input.{} is {:g}", entry.key, value), [path, value](Value& tree) {
                       Value* old = tree.FindPath(path);
                       if (old == nullptr || !old->is_table()) return false;
                       *old = Value{{"type", "constant"}, {"value", value}};
                       return true;
                     }});
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

/// A text that has to be there, up to its first mark.
Move FirstWords(const std::string& path) {
  return {path + " in its first words", [path](Value& root) {
            Value* text = root.FindPath(path);
            if (text == nullptr || !text->is_string() || IsGone(*text)) return false;
            const std::string words = text->string().substr(0, text->string().find_first_of(":;,."));
            const bool shorter = !words.empty() && words.size() < text->string().size();
            if (shorter) *text = Value(words);
            return shorter;
          }};
}

/// Words that a reader wants and a run does not: they go in one try.
bool IsWord(const std::string& path) {
  const std::string key = path.substr(path.rfind('.') + 1);
  return path.find('.') == std::string::npos || key == "description" || key == "unit";
}

std::vector<Move> Words(const Value& root) {
  std::vector<std::string> paths;
  Leaves(root, "", paths);
  std::vector<Move> moves;
  for (const std::string& path : paths) {
    if (path != "check" && path != "effect" && IsWord(path)) moves.push_back(Without(path));
  }
  if (const Value* checks = root.Find("check"); checks != nullptr && checks->is_array()) {
    for (std::size_t i = 0; i < checks->array().size(); ++i)
      moves.push_back(FirstWords(fmt::format("check.{}.origin", i)));
  }
  return moves;
}

/// Keys of one section. Stages have had their turn.
std::vector<Move> Keys(const Value& root, const std::string& section) {
  std::vector<std::string> paths;
  if (const Value* value = root.Find(section); value != nullptr && value->is_table()) Leaves(*value, section, paths);
  std::vector<Move> moves;
  for (const std::string& path : paths) {
    if (!IsWord(path) && !path.ends_with(".sensor") && !path.ends_with(".actuator")) moves.push_back(Without(path));
  }
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

/// An instant or a length of time: its name ends with "_s", and is no other quantity "per s".
bool IsTime(const std::string& key) { return key.ends_with("_s") && !key.ends_with("per_s"); }

/// Instants and lengths of time below `value`.
bool ScaleTimes(Value& value, double factor) {
  bool any = false;
  if (value.is_array()) {
    for (Value& item : value.array()) any = ScaleTimes(item, factor) || any;
  }
  if (!value.is_table()) return any;
  for (Value::Entry& entry : value.table()) {
    if (IsTime(entry.key)) {
      const bool list = entry.value.is_array();
      for (Value& number : list ? std::span(entry.value.array()) : std::span(&entry.value, 1)) {
        if (!number.is_number() || number.number() == 0.0) continue;
        number = Value(Rounded(factor * number.number(), 3));
        any = true;
      }
    } else {
      any = ScaleTimes(entry.value, factor) || any;
    }
  }
  return any;
}

}  // namespace

Move Earlier(double factor) {
  return {fmt::format("events at {:g} of their time", factor), [factor](Value& root) {
            bool any = false;
            for (const Value::Entry& entry : TableAt(root, "input")) {
              if (Value* source = root.FindPath("input." + entry.key + ".source"); source != nullptr)
                any = ScaleTimes(*source, factor) || any;
            }
            if (Value* checks = root.Find("check"); checks != nullptr) any = ScaleTimes(*checks, factor) || any;
            Value* duration = root.FindPath("run.duration_s");
            if (any && duration != nullptr && duration->is_number())
              *duration = Value(Rounded(factor * duration->number(), 3));
            return any;
          }};
}

double Rounded(double value, int digits) { return std::stod(fmt::format("{:.{}e}", value, digits - 1)); }

std::vector<Group> GroupsOf(const Value& root, const std::vector<std::string>& kept, const Levels& levels) {
  const Known known{kept, levels};
  std::vector<Move> lumps;
  for (const Value::Entry& entry : TableAt(root, "plant.rotor")) lumps.push_back(Lump(entry.key));
  std::vector<Group> groups = {{"words", Words(root)},
                               {"sections", Sections(root)},
                               {"variants", Variants(root, known)},
                               {"wiring of variants", Adoptions(root)},
                               {"checks", Items(root, "check", 1)},
                               {"effects", Items(root, "effect", 0)},
                               {"signals", Signals(root, known)},
                               {"shortcuts", Shortcuts(root, known)},
                               {"parts", Parts(root, known)},
                               {"rotors", std::move(lumps)},
                               {"stages", Stages(root)},
                               {"bodies", Joints(root)},
                               {"sums", Sums(root)},
                               {"inputs that rest", Constants(root, true)},
                               {"inputs that step", Constants(root, false)}};
  for (const Value::Entry& section : root.table()) {
    if (section.key != "variant") groups.push_back({"keys of " + section.key, Keys(root, section.key)});
  }
  groups.push_back({"keys of variant", Keys(root, "variant")});
  std::erase_if(groups, [](const Group& group) { return group.moves.empty(); });
  return groups;
}

Group Digits(const Value& root, int digits) {
  Group group{fmt::format("numbers in {} digits", digits), {}};
  for (const char* section : {"plant", "input", "control", "part"}) {
    if (const Value* values = root.Find(section); values != nullptr) RoundAll(*values, section, digits, group.moves);
  }
  return group;
}

Group KeysOfChecks(const Value& root) {
  Group group{"keys of checks", {}};
  const Value* checks = root.Find("check");
  for (std::size_t i = 0; checks != nullptr && checks->is_array() && i < checks->array().size(); ++i) {
    if (!checks->array()[i].is_table()) continue;
    for (const Value::Entry& entry : checks->array()[i].table()) {
      const std::string path = fmt::format("check.{}.{}", i, entry.key);
      if (entry.key == "kind" || entry.key == "origin") continue;
      group.moves.push_back(Without(path));
      for (std::size_t k = 0; entry.value.is_array() && k < entry.value.array().size(); ++k)
        group.moves.push_back(Without(fmt::format("{}.{}", path, k)));
    }
  }
  return group;
}

double LastLookOf(const Value& root) {
  double last = 0.0, shortest = std::numeric_limits<double>::infinity();
  const Value* checks = root.Find("check");
  for (const Value& check : checks != nullptr && checks->is_array() ? checks->array() : Value::Array{}) {
    if (!check.is_table()) continue;
    for (const Value::Entry& entry : check.table()) {
      if (!IsTime(entry.key)) continue;
      for (const Value& time : entry.value.is_array() ? entry.value.array() : Value::Array{entry.value}) {
        last = std::max(last, time.is_number() ? time.number() : 0.0);
        if (!entry.value.is_array() && time.is_number()) shortest = std::min(shortest, time.number());
      }
    }
  }
  return shortest < last ? last + shortest : last;
}

Levels LevelsOf(const Value& root, const trace::Trace& trace) {
  Levels levels;
  for (const auto& [section, key] : {std::pair("input", "from"), std::pair("output", "of")}) {
    for (const Value::Entry& entry : TableAt(root, section)) {
      const trace::Signal* signal = trace.Find(entry.key);
      if (signal == nullptr || signal->values.empty()) continue;
      const double sum = std::accumulate(signal->values.begin(), signal->values.end(), 0.0);
      const double level = Rounded(sum / static_cast<double>(signal->values.size()), 3);
      levels[std::string(section) + "." + entry.key] = level;
      levels[entry.value.TextOr(key)] = level;
    }
  }
  return levels;
}

void Apply(const std::vector<Move>& moves, Value& root) {
  for (const Move& move : moves) move.apply(root);
  Sweep(root);
}

}  // namespace dynoproof::reduce
