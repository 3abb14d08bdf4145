#include "experiment/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace dynoproof {
namespace {

/// A value on one line, as TOML has it.
std::string Line(const Value& value) {
  if (value.is_string()) return fmt::format("\"{}\"", value.string());
  if (value.is_bool()) return value.boolean() ? "true" : "false";
  if (value.is_integer()) return fmt::format("{}", value.integer());
  if (value.is_number()) return fmt::format("{:.10g}", value.number());
  std::string text;
  if (value.is_array()) {
    for (const Value& item : value.array()) text += (text.empty() ? "" : ", ") + Line(item);
    return "[" + text + "]";
  }
  for (const Value::Entry& entry : value.table()) {
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", entry.key, Line(entry.value));
  }
  return "{ " + text + " }";
}

class Walk {
 public:
  explicit Walk(const Registry& registry) : registry_(registry) {}

  void Table(const std::string& path, const Value& table) {
    for (const Value::Entry& entry : table.table()) {
      if (path.empty() && (entry.key == "check" || entry.key == "title" || entry.key == "source")) continue;
      Entry(path.empty() ? entry.key : path + "." + entry.key, entry.value);
    }
    Defaults(path, table);
  }
  std::vector<Setting> settings;

 private:
  void Entry(const std::string& path, const Value& value) {
    if (value.is_table()) return Table(path, value);
    if (value.is_array() && !value.array().empty() && value.array().front().is_table()) {
      for (std::size_t i = 0; i < value.array().size(); ++i) Entry(fmt::format("{}.{}", path, i), value.array()[i]);
      return;
    }
    const SourceSpan& where = value.where();
    std::string from = where.file;
    if (where.known() && where.file != "--set") from += fmt::format(":{}", where.line);
    settings.push_back({path, Line(value), from.empty() ? "made from others" : from, "", ""});
  }

  void Add(const std::string& path, const Value& table, const std::vector<ParamInfo>& parameters) {
    for (const ParamInfo& one : parameters) {
      if (one.fallback.empty() || table.Find(one.name) != nullptr) continue;
      settings.push_back({path + "." + one.name, one.fallback, Setting::kDefault, one.unit, one.description, one.type});
    }
  }

  void Defaults(const std::string& path, const Value& table) {
    if (path == "run") {
      Add(path, table, ListParams<RunSettings>());
      const Value none;
      const Value *reference = table.Find("reference"), *realtime = table.Find("realtime");
      Add("run.reference", reference != nullptr ? *reference : none, ListParams<RunSettings::Reference>());
      Add("run.realtime", realtime != nullptr ? *realtime : none, ListParams<RunSettings::Realtime>());
    }
    const Value *type = table.Find("type"), *law = table.Find("law");
    const bool by_type = type != nullptr && type->is_string();
    if (!by_type && (law == nullptr || !law->is_string())) return;
    for (const char* kind : {"source", "actuator", "sensor", "control", "plant", "part", "law"}) {
      const bool here = by_type ? path.find(kind) != std::string::npos || std::string_view(kind) == "plant"
                                : std::string_view(kind) == "law";
      if (!here) continue;
      const PluginInfo* plugin = registry_.FindPlugin(kind, by_type ? type->string() : law->string());
      if (plugin == nullptr) continue;
      return Add(path, table, plugin->parameters);
    }
  }

  const Registry& registry_;
};

}  // namespace

std::vector<Setting> SettingsOf(const Plan& plan, const Registry& registry) {
  Walk walk(registry);
  if (plan.root.is_table()) walk.Table("", plan.root);
  return std::move(walk.settings);
}

}  // namespace dynoproof
