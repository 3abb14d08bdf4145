// The registry: every plugin by kind and name. Built-in and loaded plugins register by the same call.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/component.h"
#include "model/effect.h"
#include "model/law.h"
#include "model/params.h"

namespace dynoproof {

class Registry;

/// A recorded signal; shared, because a fit builds the same model many times.
struct Series {
  std::shared_ptr<const std::vector<double>> time, values;  // equal lengths, time strictly rising [s]
};
/// Recorded signals by name: what `replay` sources play. No plugin opens a file.
using Records = std::map<std::string, Series>;

/// What a plugin may know when it is built.
struct BuildContext {
  const Registry& registry;
  Diagnostics& diagnostics;
  std::string context;             // names the table in messages: "plant (drive_line)"
  std::vector<std::string> known;  // keys of the table that the caller reads
  double period_s = 1e-4;          // of the run
  std::int64_t seed = 1;           // of this block's noise
  double nominal = 1.0;            // of the input or output that a stage belongs to
  const Records* records = nullptr;
  Motion motion = Motion::kRotation;  // in which a plant or law is built: its keys are those of this motion
};

/// What `list` and `describe` show. `kind` is plant, law, control, source, actuator or sensor.
struct PluginInfo {
  std::string kind, name, summary, law, source;
  std::vector<ParamInfo> parameters;
};

class CheckPlan;  // experiment/check.h
class Rig;        // sim/rig.h

/// A kind of [[check]]: what `list` and `describe` show of it, and how a table becomes a check of it.
struct CheckKind {
  std::string name, summary;
  std::vector<ParamInfo> parameters;
  std::vector<std::string> relative_limits = {};  // parameters that are a largest relative deviation
  bool compares_solvers = false;                  // `realtime` against `reference`
  bool follows_plan = false;                      // with what the same plan gives otherwise: a wrong number is in both
  bool needs_analysis = false;                    // the section [analysis] of the scenario
  std::function<std::unique_ptr<CheckPlan>(const Value& table, Diagnostics& diagnostics)> make;  // null: faulty table
};

template <class T>
using Factory = std::function<std::unique_ptr<T>(const Value& table, BuildContext& context)>;

class Registry {
 public:
  /// Registers a component or law class P with: P::Info() -> PluginInfo (parameters left empty), P::Params, and either
  /// P(const P::Params&, const BuildContext&), P(const P::Params&) or P::Create(params, table, context). A plugin whose
  /// parameters are tables of further plugins may have P::ReportMore(params, table, context): it is called when the
  /// parameters were faulty, so that the faults inside those tables are reported in the same go. A plant may have
  /// P::Traits() -> PlantTraits.
  template <class P>
  void Add() {
    PluginInfo info = P::Info();
    if (!Claim(info.kind, info.name)) return;
    info.parameters = ListParams<typename P::Params>();
    const auto make = [](const Value& table, BuildContext& context) -> std::unique_ptr<P> {
      typename P::Params params;
      std::vector<std::string> known = context.known;
      known.emplace_back("type");
      if (!ReadParams(table, params, context.diagnostics, context.context, std::move(known), context.motion)) {
        if constexpr (requires { P::ReportMore(params, table, context); }) P::ReportMore(params, table, context);
        return nullptr;
      }
      if constexpr (requires { P::Create(params, table, context); }) {
        return P::Create(params, table, context);
      } else if constexpr (std::is_constructible_v<P, const typename P::Params&, const BuildContext&>) {
        return std::make_unique<P>(params, context);
      } else {
        return std::make_unique<P>(params);
      }
    };
    if constexpr (std::is_base_of_v<Law, P>) {
      laws_[info.name] = make;
    } else {
      components_[{info.kind, info.name}] = make;
      if constexpr (requires { P::Traits(); }) (*plants_)[info.name] = P::Traits();
    }
    plugins_[{info.kind, info.name}] = std::move(info);
  }
  void Add(std::unique_ptr<Effect> effect);
  /// Registers a kind of check C, a CheckPlan; experiment/check.h says what it declares.
  template <class C>
  void AddCheck() {
    if (Claim("check", C::kName)) checks_[C::kName] = C::template KindOf<C>();
  }

  /// What is registered from here on is of this shared library. A name that is taken stays what it was: to replace a law behind the
  /// back of a scenario would change its physics without a word.
  void BeginLibrary(const std::string& file);
  /// "law \"spring_damper\" is there already, from dynoproof itself": one for each name that BeginLibrary()'s wanted again.
  const std::vector<std::string>& clashes() const { return clashes_; }
  /// Shared libraries that have registered something, in order.
  const std::vector<std::string>& libraries() const { return libraries_; }

  /// Builds from a table whose key `type` names the plugin; faults become diagnostics and null.
  std::unique_ptr<Component> MakeComponent(const std::string& kind, const Value& table, BuildContext& context) const;
  /// The same for a law; `key` is the key that names it ("law").
  std::unique_ptr<Law> MakeLaw(const std::string& name, const Value& table, BuildContext& context) const;

  const Effect* FindEffect(std::string_view name) const;
  /// What the plant of a plan declares.
  const PlantTraits& PlantOf(const Plan& plan) const { return dynoproof::PlantOf(plan, *plants_); }
  const PluginInfo* FindPlugin(const std::string& kind, const std::string& name) const;
  const CheckKind* FindCheck(std::string_view name) const;
  std::vector<const CheckKind*> Checks() const;    // by name
  std::vector<const PluginInfo*> Plugins() const;  // by kind, then name
  std::vector<const Effect*> Effects() const;      // by name

 private:
  using Key = std::pair<std::string, std::string>;  // kind, name
  /// Whether nobody has that name yet; else a clash.
  bool Claim(const std::string& kind, const std::string& name);

  std::map<Key, std::string> owners_;
  std::vector<std::string> libraries_, clashes_;
  std::map<Key, PluginInfo> plugins_;
  std::map<Key, Factory<Component>> components_;
  std::map<std::string, Factory<Law>> laws_;
  std::map<std::string, std::unique_ptr<Effect>, std::less<>> effects_;
  std::shared_ptr<PlantCatalogue> plants_ = std::make_shared<PlantCatalogue>();  // shared with the effects
  std::map<std::string, CheckKind, std::less<>> checks_;
};

/// Registers every built-in plugin (engine/plugins/register_all.cc).
void RegisterBuiltIns(Registry& registry);

}  // namespace dynoproof
