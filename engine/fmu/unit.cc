#include "fmu/unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "base/text.h"
#include "base/units.h"
#include "experiment/build_info.h"
#include "fmu/run.h"
#include "model/prior.h"

namespace dynoproof::fmu {
namespace {

/// A scenario's id as a name in C.
std::string IdentifierOf(const std::string& id) {
  std::string name;
  for (const char c : id) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0) name.insert(0, "_");
  return name;
}

/// The numbers of the plant that importers may set, those that are written.
std::vector<Variable> ParametersOf(const Prepared& scenario) {
  std::vector<Variable> parameters;
  for (const NuisanceParameter& one : NuisancesWithPriors(scenario.registry->PlantOf(scenario.plan), scenario.plan)) {
    const Value* value = scenario.plan.root.FindPath(one.path);
    if (one.initial || value == nullptr || !value->is_number()) continue;
    const std::string unit = UnitOfSuffix(one.path);  // an inertia's key is its name and tells none
    parameters.push_back({one.path, unit == "1" ? "" : unit, one.reason, value->number(), 1.0});
  }
  return parameters;
}

void AddVariable(pugi::xml_node variables, const Variable& one, std::size_t reference, const char* causality,
                 const char* variability, bool starts) {
  pugi::xml_node variable = variables.append_child("ScalarVariable");
  variable.append_attribute("name") = one.name.c_str();
  variable.append_attribute("valueReference") = static_cast<unsigned>(reference);
  if (!one.description.empty()) variable.append_attribute("description") = one.description.c_str();
  variable.append_attribute("causality") = causality;
  variable.append_attribute("variability") = variability;
  if (std::string_view(causality) == "output") variable.append_attribute("initial") = "calculated";
  pugi::xml_node real = variable.append_child("Real");
  if (!one.unit.empty()) real.append_attribute("unit") = one.unit.c_str();
  if (one.nominal != 1.0) real.append_attribute("nominal") = fmt::format("{}", one.nominal).c_str();
  if (starts) real.append_attribute("start") = fmt::format("{}", one.start).c_str();
}

std::string DescriptionWith(const Fmu& unit, const std::string& guid) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = document.append_child("fmiModelDescription");
  root.append_attribute("fmiVersion") = "2.0";
  root.append_attribute("modelName") = unit.id.c_str();
  root.append_attribute("guid") = guid.c_str();
  if (!unit.title.empty()) root.append_attribute("description") = unit.title.c_str();
  root.append_attribute("generationTool") = fmt::format("dynoproof {}", build_info::kVersion).c_str();
  root.append_attribute("variableNamingConvention") = "flat";
  pugi::xml_node simulation = root.append_child("CoSimulation");
  simulation.append_attribute("modelIdentifier") = unit.identifier.c_str();
  simulation.append_attribute("needsExecutionTool") = "true";
  simulation.append_attribute("canHandleVariableCommunicationStepSize") = "true";
  std::set<std::string> units;
  for (const auto* some : {&unit.inputs, &unit.outputs, &unit.parameters}) {
    for (const Variable& one : *some) {
      if (!one.unit.empty()) units.insert(one.unit);
    }
  }
  if (!units.empty()) {
    pugi::xml_node definitions = root.append_child("UnitDefinitions");
    for (const std::string& name : units) definitions.append_child("Unit").append_attribute("name") = name.c_str();
  }
  pugi::xml_node experiment = root.append_child("DefaultExperiment");
  experiment.append_attribute("startTime") = "0";
  experiment.append_attribute("stopTime") = fmt::format("{}", unit.duration_s).c_str();
  experiment.append_attribute("stepSize") = fmt::format("{}", unit.period_s).c_str();
  pugi::xml_node variables = root.append_child("ModelVariables");
  std::size_t reference = 0;
  for (const Variable& one : unit.inputs) AddVariable(variables, one, reference++, "input", "continuous", true);
  for (const Variable& one : unit.outputs) AddVariable(variables, one, reference++, "output", "continuous", false);
  for (const Variable& one : unit.parameters) AddVariable(variables, one, reference++, "parameter", "fixed", true);
  pugi::xml_node structure = root.append_child("ModelStructure");
  for (const char* list : {"Outputs", "InitialUnknowns"}) {
    if (unit.outputs.empty()) break;
    pugi::xml_node unknowns = structure.append_child(list);
    for (std::size_t i = 0; i < unit.outputs.size(); ++i)
      unknowns.append_child("Unknown").append_attribute("index") = static_cast<unsigned>(unit.inputs.size() + i + 1);
  }
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace

Result<Fmu> FmuOf(const Prepared& scenario) {
  Fmu unit;
  unit.id = scenario.plan.id;
  unit.identifier = IdentifierOf(scenario.plan.id);
  unit.title = scenario.title;
  const Rig& rig = *scenario.rig;
  unit.period_s = rig.SecondsOf(rig.period);
  unit.duration_s = static_cast<double>(rig.steps) * unit.period_s;
  Result<std::unique_ptr<Run>> run = Run::Of(scenario.plan, *scenario.registry);
  if (!run.ok()) return run.failure();
  for (const InputLine& line : rig.inputs) {
    if (!line.source) continue;
    unit.inputs.push_back({line.name, line.unit, line.description, (*run)->inputs()[unit.inputs.size()], line.nominal});
  }
  const Result<std::vector<double>> outputs = (*run)->Outputs();
  if (!outputs.ok()) return outputs.failure();
  for (std::size_t i = 0; i < rig.outputs.size(); ++i)
    unit.outputs.push_back(
        {rig.outputs[i].name, rig.outputs[i].unit, rig.outputs[i].description, (*outputs)[i], rig.outputs[i].nominal});
  unit.parameters = ParametersOf(scenario);
  // An importer may check that a library and a description belong together.
  unit.guid = Fingerprint(DescriptionWith(unit, ""));
  return unit;
}

std::string ModelDescription(const Fmu& unit) { return DescriptionWith(unit, unit.guid); }

}  // namespace dynoproof::fmu
