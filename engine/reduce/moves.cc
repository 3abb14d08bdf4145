#include "reduce/moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

/// Takes what names the part out of its holder where the holder can do without: of lists their items, and a loop that runs through
/// it is opened. False: the holder goes as well.
bool LetGo(Value& holder, const std::string& at, const std::string& path) {
  if (!holder.is_table()) return false;
  for (Value::Entry& entry : holder.table()) {
    if (!NamesAny(entry.value, at, path)) continue;
    if (entry.value.is_array() && entry.key != "between") {
      std::erase_if(entry.value.array(), [&](const Value& item) { return NamesAny(item, at, path); });
      if (entry.value.array().empty()) return false;
    } else if (at.starts_with("input.") && entry.key == "from") {
      entry = {"source", Value{{"type", "constant"}, {"value", 0.0}}, {}};
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

/// A part goes with all that cannot be without it: with an inertia its shafts, what acts on it and what is seen of it. False where
/// that takes what is kept.
bool TakeWithAll(Value& root, const std::string& path, const std::vector<std::string>& kept) {
  Value* part = root.FindPath(path);
  if (part == nullptr || IsGone(*part)) return false;
  const std::string section = path.substr(0, path.find('.')), name = path.substr(path.rfind('.') + 1);
  if (section == "check" || ((section == "input" || section == "output") && std::ranges::count(kept, name) > 0))
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
    if (holder == nullptr || IsGone(*holder) || !NamesAny(*holder, at, path) || LetGo(*holder, at, path)) continue;
    if (!TakeWithAll(root, at, kept)) return false;
  }
  return true;
}

Move WithAll(const std::string& path, const std::vector<std::string>& kept) {
  return {path, [path, kept](Value& root) {
            Value without = root;
            if (!TakeWithAll(without, path, kept)) return false;
            root = std::move(without);
            return true;
          }};
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
        entry.key == "check" || entry.key == "effect" || entry.key == "control" || entry.key == "part")
      continue;
    moves.push_back(Without(entry.key));
  }
  return moves;
}

std::vector<Move> Signals(const Value& root, const std::vector<std::string>& kept) {
  std::vector<Move> moves;
  const auto wanted = [&](const std::string& name) { return std::ranges::count(kept, name) > 0; };
  for (const Value::Entry& entry : TableAt(root, "output")) {
    if (!wanted(entry.key)) moves.push_back(Without("output." + entry.key));
  }
  for (const Value::Entry& entry : TableAt(root, "input")) {
    if (!wanted(entry.key)) moves.push_back(WithAll("input." + entry.key, kept));
  }
  for (const char* list : {"effect", "check"}) {
    const Value* items = root.Find(list);
    if (items == nullptr || !items->is_array() || items->array().size() < (std::string_view(list) == "check" ? 2U : 1U))
      continue;
    for (std::size_t i = 0; i < items->array().size(); ++i) moves.push_back(Without(fmt::format("{}.{}", list, i)));
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
std::vector<Move> Parts(const Value& root, const std::vector<std::string>& kept) {
  std::vector<Move> moves;
  for (const std::string& path : PartsOf(root)) {
    if (path.starts_with("control.") || path.starts_with("part.") || path.starts_with("plant."))
      moves.push_back(WithAll(path, kept));
  }
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

std::vector<Move> Keys(const Value& root) {
  std::vector<std::string> paths;
  for (const Value::Entry& entry : root.table()) {
    if (entry.key != "check") Leaves(entry.value, entry.key, paths);
  }
  std::vector<Move> moves;
  for (const std::string& path : paths) moves.push_back(Without(path));
  if (const Value* checks = root.Find("check"); checks != nullptr && checks->is_array()) {
    for (std::size_t i = 0; i < checks->array().size(); ++i)
      moves.push_back(FirstWords(fmt::format("check.{}.origin", i)));
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

std::vector<Move> Digits(const Value& root, int digits) {
  std::vector<Move> moves;
  for (const char* section : {"plant", "input", "control"}) {
    if (const Value* values = root.Find(section); values != nullptr) RoundAll(*values, section, digits, moves);
  }
  return moves;
}

/// Instants and lengths of time below `value`, whose names end with "_s" and no other quantity "per s".
bool ScaleTimes(Value& value, double factor) {
  bool any = false;
  if (value.is_array()) {
    for (Value& item : value.array()) any = ScaleTimes(item, factor) || any;
  }
  if (!value.is_table()) return any;
  for (Value::Entry& entry : value.table()) {
    if (entry.key.ends_with("_s") && !entry.key.ends_with("per_s")) {
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

std::vector<Group> GroupsOf(const Value& root, const std::vector<std::string>& kept) {
  std::vector<Move> lumps;
  for (const Value::Entry& entry : TableAt(root, "plant.rotor")) lumps.push_back(Lump(entry.key));
  std::vector<Group> groups = {{"sections", Sections(root)},
                               {"signals, effects and checks", Signals(root, kept)},
                               {"parts", Parts(root, kept)},
                               {"rotors", std::move(lumps)},
                               {"stages", Stages(root)},
                               {"bodies", Merges(root)},
                               {"sums", Sums(root)},
                               {"inputs that rest", Constants(root, true)},
                               {"inputs that step", Constants(root, false)},
                               {"keys", Keys(root)},
                               {"digits", Digits(root, 2)}};
  std::erase_if(groups, [](const Group& group) { return group.moves.empty(); });
  return groups;
}

void Apply(const std::vector<Move>& moves, Value& root) {
  for (const Move& move : moves) move.apply(root);
  Sweep(root);
}

}  // namespace dynoproof::reduce
