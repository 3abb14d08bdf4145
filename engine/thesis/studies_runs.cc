#include "thesis/studies_runs.h"

#include <fmt/format.h>

#include <tuple>

#include "experiment/prepare.h"
#include "experiment/run_scenario.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "thesis/study_parameters.h"

namespace dynoproof {
namespace {

Result<Figures> Run(const Registry& registry, const std::string& scenario, const std::string& kind,
                    const std::vector<std::string>& settings) {
  Diagnostics diagnostics;
  const std::vector<std::string> files = FindScenarios(scenario, diagnostics);
  std::optional<Plan> plan = files.size() == 1 ? LoadPlan(files[0], settings, diagnostics) : std::nullopt;
  if (!plan) return BadStudy("needs a \"scenario\"\n" + diagnostics.Format());
  Value::Array chosen;
  const Value* checks = plan->root.Find("check");
  for (const Value& check : checks != nullptr && checks->is_array() ? checks->array() : Value::Array{}) {
    if (check.TextOr("kind") == kind) chosen.push_back(check);
  }
  if (chosen.empty()) return BadStudy(fmt::format("{} has no check of the kind \"{}\"", scenario, kind));
  plan->root["check"] = Value(std::move(chosen));
  const std::unique_ptr<Prepared> prepared = Prepare(std::move(*plan), {}, registry, diagnostics);
  if (prepared == nullptr) return BadStudy(diagnostics.Format());
  const Result<Course> course = Play(*prepared, {});
  if (!course.ok()) return course.failure();
  CheckContext context(prepared->plan, *prepared->rig, course->samples, prepared->rig->run.solver);
  context.trace = &course->trace;
  context.registry = &registry;
  context.records = prepared->records.get();
  RunChecks(prepared->checks, context);
  return context.figures;
}

Result<Figure> Pick(const Result<Figures>& figures, const std::string& name) {
  if (!figures.ok()) return figures.failure();
  const auto found = figures->find(name);
  if (found == figures->end()) return BadStudy(fmt::format("there is no figure \"{}\"", name));
  return found->second;
}

}  // namespace

Result<Figures> FiguresOf(const Registry& registry, const std::string& scenario, const std::string& kind,
                          const std::vector<std::string>& settings) {
  static std::map<std::tuple<const Registry*, std::string, std::string, std::vector<std::string>>, Figures> kept;
  const auto key = std::tuple(&registry, scenario, kind, settings);
  const auto known = kept.find(key);
  if (known != kept.end()) return known->second;
  Result<Figures> figures = Run(registry, scenario, kind, settings);
  if (figures.ok()) kept[key] = *figures;
  return figures;
}

Result<Figure> ScenarioFigure(const Registry& registry, const Value& parameters) {
  std::vector<std::string> settings;
  const Value* set = parameters.Find("set");
  for (const Value& one : set != nullptr && set->is_array() ? set->array() : Value::Array{}) {
    if (!one.is_string()) return BadStudy("\"set\" is a list of key=value");
    settings.push_back(one.string());
  }
  const std::string scenario = parameters.TextOr("scenario"), kind = parameters.TextOr("kind"),
                    name = parameters.TextOr("figure");
  const Result<Figure> figure = Pick(FiguresOf(registry, scenario, kind, settings), name);
  const bool over_scenario = parameters.Find("over_scenario") != nullptr;
  if (!figure.ok() || (parameters.Find("over") == nullptr && !over_scenario)) return figure;
  const Result<Figure> over = over_scenario
                                  ? Pick(FiguresOf(registry, parameters.TextOr("over_scenario"), kind, settings), name)
                                  : Pick(FiguresOf(registry, scenario, kind, settings), parameters.TextOr("over"));
  if (!over.ok()) return over;
  return Figure{figure->value / over->value, "1"};
}

}  // namespace dynoproof
