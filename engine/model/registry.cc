#include "model/registry.h"

#include <fmt/format.h>

namespace dynoproof {
namespace {

/// Reports that `name` is no plugin of that kind, with the nearest known name.
void UnknownPlugin(const SourceSpan& where, const std::string& kind, const std::string& name,
                   const std::vector<std::string>& known, Diagnostics& diagnostics) {
  const std::optional<std::string> near = Closest(name, known);
  diagnostics.Error(where, fmt::format("there is no {} \"{}\"", kind, name),
                    near            ? fmt::format("did you mean \"{}\"?", *near)
                    : known.empty() ? fmt::format("there is no {} at all: is a plugin missing (--plugin FILE)?", kind)
                                    : fmt::format("known: {}", fmt::join(known, ", ")),
                    "dynoproof list");
}

}  // namespace

void Registry::BeginLibrary(const std::string& file) {
  libraries_.push_back(file);
  clashes_.clear();
}

bool Registry::Claim(const std::string& kind, const std::string& name) {
  const std::string own = libraries_.empty() ? "dynoproof itself" : libraries_.back();
  const auto [owner, free] = owners_.insert({{kind, name}, own});
  if (!free) clashes_.push_back(fmt::format("{} \"{}\" is there already, from {}", kind, name, owner->second));
  return free;
}

void Registry::Add(std::unique_ptr<Effect> effect) {
  std::string name = effect->info().name;
  if (!Claim("effect", name)) return;
  effect->plants_ = plants_;
  effects_[std::move(name)] = std::move(effect);
}

std::unique_ptr<Component> Registry::MakeComponent(const std::string& kind, const Value& table,
                                                   BuildContext& context) const {
  std::vector<std::string> known;
  for (const auto& [key, factory] : components_) {
    if (key.first == kind) known.push_back(key.second);
  }
  const Value* type = table.Find("type");
  if (type == nullptr || !type->is_string()) {
    context.diagnostics.Error(table.where(), fmt::format("{} needs a \"type\"", context.context),
                              fmt::format("known: {}", fmt::join(known, ", ")), "dynoproof list");
    return nullptr;
  }
  const auto factory = components_.find({kind, type->string()});
  if (factory == components_.end()) {
    UnknownPlugin(type->where(), kind, type->string(), known, context.diagnostics);
    return nullptr;
  }
  context.context = fmt::format("{}.{} \"{}\"", kind, type->string(), context.context);
  if (kind == "plant") context.motion = MotionOf(table);
  return factory->second(table, context);
}

std::unique_ptr<Law> Registry::MakeLaw(const std::string& name, const Value& table, BuildContext& context) const {
  const auto factory = laws_.find(name);
  if (factory == laws_.end()) {
    std::vector<std::string> known;
    for (const auto& [law, make] : laws_) known.push_back(law);
    const Value* written = table.Find("law");
    UnknownPlugin(written != nullptr ? written->where() : table.where(), "law", name, known, context.diagnostics);
    return nullptr;
  }
  context.context = fmt::format("law.{} \"{}\"", name, context.context);
  return factory->second(table, context);
}

const Effect* Registry::FindEffect(std::string_view name) const {
  const auto it = effects_.find(name);
  return it == effects_.end() ? nullptr : it->second.get();
}

const PluginInfo* Registry::FindPlugin(const std::string& kind, const std::string& name) const {
  const auto it = plugins_.find({kind, name});
  return it == plugins_.end() ? nullptr : &it->second;
}

const CheckKind* Registry::FindCheck(std::string_view name) const {
  const auto it = checks_.find(name);
  return it == checks_.end() ? nullptr : &it->second;
}

std::vector<const CheckKind*> Registry::Checks() const {
  std::vector<const CheckKind*> list;
  for (const auto& [name, kind] : checks_) list.push_back(&kind);
  return list;
}

std::vector<const PluginInfo*> Registry::Plugins() const {
  std::vector<const PluginInfo*> list;
  for (const auto& [key, info] : plugins_) list.push_back(&info);
  return list;
}

std::vector<const Effect*> Registry::Effects() const {
  std::vector<const Effect*> list;
  for (const auto& [name, effect] : effects_) list.push_back(effect.get());
  return list;
}

}  // namespace dynoproof
