#include "plugins/plant/fmu/fmu.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "base/text.h"
#include "plugins/plant/parameter_section.h"

namespace dynoproof {
namespace {

/// The path of a unit as a scenario names it: from the folder of the file in which it is written.
std::string PathOf(const Value& file) {
  const std::filesystem::path path = file.string();
  if (path.is_absolute() || !file.where().known()) return path.string();
  return (std::filesystem::path(file.where().file).parent_path() / path).lexically_normal().string();
}

/// The unit of a plan; null where there is none.
std::shared_ptr<const UnitFile> UnitOf(const Plan& plan) {
  const Value* file = plan.root.FindPath("plant.file");
  if (file == nullptr || !file->is_string()) return nullptr;
  const Result<std::shared_ptr<const UnitFile>> unit = UnitFile::Of(PathOf(*file));
  return unit.ok() ? *unit : nullptr;
}

void Log(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...) {}

const UnitVariable* Find(const std::vector<UnitVariable>& variables, const std::string& name) {
  const auto found = std::ranges::find(variables, name, &UnitVariable::name);
  return found != variables.end() ? &*found : nullptr;
}

bool Good(fmi2Status status) { return status == fmi2OK || status == fmi2Warning; }

}  // namespace

PluginInfo FmuPlant::Info() {
  return {"plant",
          "fmu",
          "a Functional Mock-up Unit for model exchange, integrated by the solvers here",
          "x' = rates of the unit at (t, x, u), y = its outputs",
          "FMI 2.0 (fmi-standard.org)",
          {}};
}

PlantTraits FmuPlant::Traits() {
  PlantTraits traits;
  traits.nuisances = [](const Plan& plan) {
    std::vector<NuisanceParameter> nuisances = ParametersInSection(plan);
    if (const std::shared_ptr<const UnitFile> unit = UnitOf(plan)) {
      for (const UnitVariable& state : unit->states)
        nuisances.push_back(StartInMotion("plant.start." + state.name, state.nominal));
    }
    return nuisances;
  };
  traits.sections = {"parameter"};
  traits.separating_experiment =
      "excite each input alone, at two amplitudes and over the frequencies at which the unit moves";
  return traits;
}

FmuPlant::FmuPlant(std::shared_ptr<const UnitFile> file) : file_(std::move(file)) {
  callbacks_ = {Log, std::calloc, std::free, nullptr, nullptr};
  const auto ports = [](const std::vector<UnitVariable>& variables, std::vector<Port>& to) {
    for (const UnitVariable& one : variables) to.push_back({one.name, one.unit, one.description, one.nominal});
  };
  ports(file_->inputs, layout_.inputs);
  ports(file_->states, layout_.states);
  ports(file_->states, layout_.outputs);
  ports(file_->outputs, layout_.outputs);
  for (const UnitVariable& one : file_->inputs) inputs_.push_back(one.reference);
  for (const UnitVariable& one : file_->outputs) outputs_.push_back(one.reference);
}

FmuPlant::~FmuPlant() {
  if (instance_ != nullptr) file_->functions.free_instance(instance_);
}

std::unique_ptr<FmuPlant> FmuPlant::Create(const Params& params, const Value& table, BuildContext& context) {
  const int before = context.diagnostics.error_count();
  const auto fault = [&](const std::string& path, const std::string& message, const std::string& hint = "") {
    const Value* at = table.FindPath(path);
    context.diagnostics.Error((at != nullptr ? *at : table).where(), message, hint, "dynoproof describe fmu");
  };
  const Value* named = table.Find("file");
  const Result<std::shared_ptr<const UnitFile>> file = UnitFile::Of(named != nullptr ? PathOf(*named) : params.file);
  if (!file.ok()) {
    fault("file", fmt::format("{}: {}", params.file, file.failure().message));
    return nullptr;
  }
  const auto check = [&](const char* section, const auto& entries, const std::vector<UnitVariable>& variables) {
    std::vector<std::string> names;
    for (const UnitVariable& one : variables) names.push_back(one.name);
    for (const auto& [name, value] : entries) {
      if (Find(variables, name) != nullptr) continue;
      const std::optional<std::string> near = Closest(name, names);
      fault(fmt::format("{}.{}", section, name), fmt::format("the unit has no {} \"{}\"", section, name),
            near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("it has: {}", fmt::join(names, ", ")));
    }
  };
  check("parameter", params.parameter, (*file)->parameters);
  check("start", params.start, (*file)->states);
  if ((*file)->states.empty()) fault("file", "the unit has no continuous states: nothing to integrate");
  if (context.diagnostics.error_count() != before) return nullptr;
  std::unique_ptr<FmuPlant> plant(new FmuPlant(*file));
  if (const std::string wrong = plant->Begin(params); !wrong.empty()) {
    fault("file", fmt::format("{}: {}", params.file, wrong));
    return nullptr;
  }
  return plant;
}

std::string FmuPlant::Begin(const Params& params) {
  const UnitFunctions& f = file_->functions;
  instance_ =
      f.instantiate("plant", fmi2ModelExchange, file_->guid.c_str(), file_->resources.c_str(), &callbacks_, 0, 0);
  if (instance_ == nullptr)
    return file_->once_in_a_process ? "it can be instantiated once in a process alone, and is there already"
                                    : "it cannot be instantiated";
  for (const auto& [name, value] : params.parameter) {
    if (!Good(f.set_real(instance_, &Find(file_->parameters, name)->reference, 1, &value)))
      return fmt::format("it does not take {} = {}", name, value);
  }
  if (!Good(f.setup_experiment(instance_, 0, 0.0, 0.0, 0, 0.0)) || !Good(f.enter_initialization(instance_)) ||
      !Good(f.exit_initialization(instance_)))
    return "it does not initialize with these parameters";
  fmi2EventInfo info = {};
  for (int i = 0; i == 0 || (info.newDiscreteStatesNeeded != 0 && i < 100); ++i) {
    if (!Good(f.new_discrete_states(instance_, &info))) return "its first event fails";
  }
  if (info.nextEventTimeDefined != 0)
    return fmt::format("it has an event at {} s: events inside a unit are not followed", info.nextEventTime);
  if (!Good(f.enter_continuous_time(instance_))) return "it does not enter its continuous time";
  starts_.resize(file_->states.size());
  if (!Good(f.get_states(instance_, starts_.data(), starts_.size()))) return "it does not tell its states";
  for (const auto& [name, value] : params.start)
    starts_[static_cast<std::size_t>(Find(file_->states, name) - file_->states.data())] = value;
  return "";
}

void FmuPlant::Start(std::span<const double>, std::span<double> states, std::span<int>) const {
  std::ranges::copy(starts_, states.begin());
}

bool FmuPlant::FeedsThrough(int in, int out) const {
  const auto own = static_cast<std::size_t>(out);
  return own >= file_->states.size() && file_->feeds[own - file_->states.size()][static_cast<std::size_t>(in)];
}

bool FmuPlant::Look(const View& view) const {
  const UnitFunctions& f = file_->functions;
  return Good(f.set_time(instance_, view.time_s)) &&
         Good(f.set_states(instance_, view.states.data(), view.states.size())) &&
         (inputs_.empty() || Good(f.set_real(instance_, inputs_.data(), inputs_.size(), view.inputs.data())));
}

void FmuPlant::Output(const View& view, std::span<double> outputs) const {
  std::ranges::copy(view.states, outputs.begin());
  const std::span<double> own = outputs.subspan(view.states.size());
  if (own.empty()) return;
  // Where the unit refuses a state, its outputs are NaN, and the run breaks.
  if (!Look(view) || !Good(file_->functions.get_real(instance_, outputs_.data(), outputs_.size(), own.data())))
    std::ranges::fill(own, std::numeric_limits<double>::quiet_NaN());
}

void FmuPlant::Derivative(const View& view, std::span<double> rates) const {
  if (!Look(view) || !Good(file_->functions.get_derivatives(instance_, rates.data(), rates.size())))
    std::ranges::fill(rates, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace dynoproof
