#include "reduce/moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>

#include "model/motion.h"
#include "reduce/connections.h"
#include "reduce/tree.h"

namespace dynoproof::reduce {
namespace {

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

/// A rotor of slices becomes one inertia: the modes within it are gone.
Move Lump(const std::string& name) {
  return {fmt::format("rotor {} is one inertia", name), [name](Value& root) {
            Value* rotor = root.FindPath("plant.rotor." + name);
            if (rotor == nullptr || !rotor->is_table()) return false;
            const Value* inertia = rotor->Find(KeyIn(MotionIn(root), *rotor, "inertia_kg_m2"));
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

/// Two bodies that a shaft joins become one, which keeps the name of the one that was `changed`, for that is looked for. What was seen of the
/// shaft is seen of its neighbour.
Move Join(const std::string& shaft, const std::set<std::string>& changed) {
  return {fmt::format("shaft {} is rigid", shaft), [shaft, changed](Value& root) {
            const Value* between = root.FindPath("plant.shaft." + shaft + ".between");
            if (between == nullptr || !between->is_array() || between->array().size() != 2 ||
                !between->array()[0].is_string() || !between->array()[1].is_string())
              return false;
            std::string a = BodyOf(between->array()[0].string()), b = BodyOf(between->array()[1].string());
            if (changed.contains("plant.inertia." + b)) std::swap(a, b);
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
std::vector<Move> Joints(const Value& root, const std::set<std::string>& changed) {
  std::vector<std::pair<double, std::string>> shafts;
  for (const Value::Entry& entry : TableAt(root, "plant.shaft")) {
    const std::string key = KeyIn(MotionIn(root), entry.value, "stiffness_Nm_per_rad");
    shafts.emplace_back(-entry.value.NumberOr(key, 0.0), entry.key);
  }
  std::ranges::sort(shafts);
  std::vector<Move> moves;
  for (const auto& [stiffness, name] : shafts) moves.push_back(Join(name, changed));
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
  const Value::Array& items = ListAt(root, list);
  if (items.size() <= fewest) return moves;
  for (std::size_t i = 0; i < items.size(); ++i) moves.push_back(Without(fmt::format("{}.{}", list, i)));
  return moves;
}

std::vector<Move> Variants(const Value& root, const Known& known) {
  std::vector<Move> moves;
  for (const Value::Entry& entry : TableAt(root, "variant")) moves.push_back(WithAll("variant." + entry.key, known));
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
    const Value::Array& pieces = ListAt(root, path);
    for (std::size_t i = 0; pieces.size() > 1 && i < pieces.size(); ++i)
      moves.push_back(Without(fmt::format("{}.{}", path, i)));
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
  for (std::size_t i = 0; i < ListAt(root, "check").size(); ++i)
    moves.push_back(FirstWords(fmt::format("check.{}.origin", i)));
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

void RoundAll(const Value& value, const std::string& path, int digits, const std::set<std::string>& changed,
              std::vector<Move>& moves) {
  if (changed.contains(path)) return;
  if (value.is_number() && !value.is_integer() && Rounded(value.number(), digits) != value.number()) {
    moves.push_back({fmt::format("{} in {} digits", path, digits), [path, digits](Value& root) {
                       Value* number = root.FindPath(path);
                       if (number == nullptr || !number->is_number()) return false;
                       *number = Value(Rounded(number->number(), digits));
                       return true;
                     }});
  }
  if (value.is_table()) {
    for (const Value::Entry& entry : value.table())
      RoundAll(entry.value, path + "." + entry.key, digits, changed, moves);
  }
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.array().size(); ++i)
      RoundAll(value.array()[i], fmt::format("{}.{}", path, i), digits, changed, moves);
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

std::vector<Group> GroupsOf(const Value& root, const std::vector<std::string>& kept, const Levels& levels,
                            const std::set<std::string>& changed) {
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
                               {"bodies", Joints(root, changed)},
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

Group Digits(const Value& root, int digits, const std::set<std::string>& changed) {
  Group group{fmt::format("numbers in {} digits", digits), {}};
  for (const char* section : {"plant", "input", "control", "part"}) {
    if (const Value* values = root.Find(section); values != nullptr)
      RoundAll(*values, section, digits, changed, group.moves);
  }
  return group;
}

Group KeysOfChecks(const Value& root) {
  Group group{"keys of checks", {}};
  for (std::size_t i = 0; i < ListAt(root, "check").size(); ++i) {
    const std::string check = fmt::format("check.{}", i);
    for (const Value::Entry& entry : TableAt(root, check)) {
      const std::string path = check + "." + entry.key;
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
  for (const Value& check : ListAt(root, "check")) {
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
