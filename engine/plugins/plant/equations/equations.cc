#include "plugins/plant/equations/equations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "base/text.h"
#include "plugins/plant/equations/expression.h"
#include "plugins/plant/parameter_section.h"

namespace dynoproof {
namespace {

constexpr const char* kTime = "t";

std::string LoadOf(const std::string& body) { return "load_" + body; }

/// As much of an expression as a message shows.
std::string Shown(const std::string& text) {
  constexpr std::size_t kMost = 60;
  return text.size() <= kMost ? text : text.substr(0, kMost) + "...";
}

bool IsIdentifier(const std::string& name) {
  const auto letter = [](unsigned char c) { return std::isalpha(c) != 0 || c == '_'; };
  return !name.empty() && letter(static_cast<unsigned char>(name[0])) &&
         std::ranges::all_of(name, [&](unsigned char c) { return letter(c) || std::isdigit(c) != 0; });
}

}  // namespace

/// Finds every fault of the section before it gives up.
class Equations::Builder {
 public:
  Builder(const Params& params, const Value& table, BuildContext& context)
      : params_(params), table_(table), context_(context), plant_(new Equations()) {}

  std::unique_ptr<Equations> Build() {
    const int before = context_.diagnostics.error_count();
    NameAll();
    if (params_.state.empty()) Fault("state", "a plant without states", "write [plant.state.NAME] with rate = \"...\"");
    LayOut();
    texts_ = {params_.define.begin(), params_.define.end()};
    for (const auto& [name, text] : params_.define) Order(name);
    for (const std::string& name : ordered_)
      plant_->definitions_.emplace_back(slots_.at(name), Read("define." + name, texts_.at(name), known_));
    for (const auto& [name, state] : params_.state)
      plant_->rates_.push_back(Read("state." + name + ".rate", state.rate, known_));
    for (const auto& [name, output] : params_.output)
      plant_->outputs_.push_back(Read("output." + name + ".value", output.value, known_));
    ReadBodies();
    AskWhatFeeds();
    if (context_.diagnostics.error_count() != before) return nullptr;
    return std::move(plant_);
  }

 private:
  void Fault(const std::string& path, const std::string& message, const std::string& hint = "") {
    const Value* at = table_.FindPath(path);
    context_.diagnostics.Error((at != nullptr ? *at : table_).where(), message, hint, "dynoproof describe equations");
  }

  /// Expression::NamesIn(), each text read once: a fit builds the same plant many times.
  const std::set<std::string>& NamesIn(const std::string& text) const {
    const auto known = names_in_.find(text);
    return known != names_in_.end() ? known->second : names_in_.emplace(text, Expression::NamesIn(text)).first->second;
  }

  /// One name, one meaning.
  void Name(const std::string& path, const std::string& name) {
    if (!IsIdentifier(name))
      return Fault(path, fmt::format("\"{}\" is no name", name), "letters, digits and _, a letter first");
    if (name == kTime || name == "pi")
      return Fault(path, fmt::format("\"{}\" has a meaning already", name), "another name");
    if (std::ranges::count(Expression::Functions(), name) > 0)
      return Fault(path, fmt::format("\"{}\" is a function", name), "another name");
    if (!names_.insert(name).second) Fault(path, fmt::format("\"{}\" is there twice", name), "each name once");
  }

  void NameAll() {
    for (const auto& [name, input] : params_.input) Name("input." + name, name);
    for (const auto& [name, state] : params_.state) Name("state." + name, name);
    for (const auto& [name, value] : params_.parameter) Name("parameter." + name, name);
    for (const auto& [name, body] : params_.body) Name("body." + name, LoadOf(name));
    for (const auto& [name, text] : params_.define) Name("define." + name, name);
    for (const auto& [name, output] : params_.output) Name("output." + name, name);
  }

  void LayOut() {
    Equations& plant = *plant_;
    plant.inputs_ = params_.input.size();
    plant.states_ = params_.state.size();
    const std::size_t bodies = params_.body.size();
    plant.values_.assign(1 + plant.inputs_ + plant.states_ + bodies + params_.define.size(), 0.0);
    std::size_t slot = 0;
    const auto take = [&](const std::string& name, std::map<std::string, double*>* also) {
      slots_[name] = slot;
      if (name == kTime || names_.contains(name)) {
        known_[name] = &plant.values_[slot];
        if (also != nullptr) (*also)[name] = &plant.values_[slot];
      }
      ++slot;
    };
    take(kTime, &of_motion_);
    for (const auto& [name, input] : params_.input) {
      take(name, nullptr);
      plant.layout_.inputs.push_back({name, input.unit, input.description, input.nominal});
    }
    for (const auto& [name, state] : params_.state) {
      take(name, &of_motion_);
      plant.starts_.push_back(state.start);
      plant.layout_.states.push_back({name, state.unit, state.description, state.nominal});
    }
    plant.layout_.outputs = plant.layout_.states;
    for (const auto& [name, output] : params_.output)
      plant.layout_.outputs.push_back({name, output.unit, output.description, output.nominal});
    for (const auto& [name, body] : params_.body) take(LoadOf(name), nullptr);
    for (const auto& [name, text] : params_.define) take(name, nullptr);
    for (const auto& [name, value] : params_.parameter) {
      if (names_.contains(name) && !known_.contains(name)) constants_[name] = value;
    }
  }

  /// Puts a definition behind those that it needs.
  void Order(const std::string& name) {
    if (std::ranges::count(ordered_, name) > 0) return;
    if (std::ranges::count(open_, name) > 0) {
      Fault("define." + name, fmt::format("\"{}\" needs itself: {} -> {}", name, fmt::join(open_, " -> "), name),
            "a definition is an expression of states, inputs, parameters and other definitions");
      return;
    }
    open_.push_back(name);
    for (const std::string& used : NamesIn(texts_.at(name))) {
      if (texts_.contains(used)) Order(used);
    }
    open_.pop_back();
    ordered_.push_back(name);
  }

  /// Null, with diagnostics, where it is none.
  std::unique_ptr<Expression> Read(const std::string& path, const std::string& text,
                                   const std::map<std::string, double*>& numbers) {
    std::vector<std::string> names;
    for (const auto& [name, value] : numbers) names.push_back(name);
    for (const auto& [name, value] : constants_) names.push_back(name);
    bool known = true;
    for (const std::string& used : NamesIn(text)) {
      if (std::ranges::count(names, used) > 0) continue;
      known = false;
      std::vector<std::string> all = names;
      all.insert(all.end(), Expression::Functions().begin(), Expression::Functions().end());
      const std::optional<std::string> near = Closest(used, all);
      const bool elsewhere = names_.contains(used);
      const bool function = std::ranges::count(Expression::Functions(), used) > 0;
      Fault(path, fmt::format("\"{}\" is not known in \"{}\"", used, Shown(text)),
            function    ? fmt::format("a function: write {}(...)", used)
            : elsewhere ? "the motion of a body is an expression of t, states and parameters alone"
            : near      ? fmt::format("did you mean \"{}\"?", *near)
                        : "write it as a parameter, an input, a state or a definition");
    }
    if (!known) return nullptr;
    Result<std::unique_ptr<Expression>> expression = Expression::Of(text, numbers, constants_);
    if (expression.ok()) return *std::move(expression);
    bool called_well = true;
    for (const std::string& called : Expression::CalledIn(text)) {
      if (std::ranges::count(Expression::Functions(), called) > 0) continue;
      called_well = false;
      const std::optional<std::string> near = Closest(called, Expression::Functions());
      Fault(path, fmt::format("there is no function \"{}\"", called),
            near ? fmt::format("did you mean \"{}\"?", *near)
                 : fmt::format("known: {}", fmt::join(Expression::Functions(), ", ")));
    }
    if (!called_well) return nullptr;
    Fault(path, fmt::format("\"{}\" is no expression: {}", Shown(text), expression.failure().message),
          fmt::format("operators + - * / ^, comparisons, a ? b : c, functions {}",
                      fmt::join(Expression::Functions(), " ")));
    return nullptr;
  }

  void ReadBodies() {
    std::vector<SlidingLoads::Body> bodies;
    for (const auto& [name, body] : params_.body) {
      bodies.push_back({name, body.transition_speed, body.nominal_load});
      Body made;
      made.slot = slots_.at(LoadOf(name));
      made.speed = Read("body." + name + ".speed", body.speed, of_motion_);
      if (!body.position.empty()) made.position = Read("body." + name + ".position", body.position, of_motion_);
      plant_->bodies_.push_back(std::move(made));
      if (!Used(LoadOf(name)))
        Fault("body." + name,
              fmt::format("{} stands in no equation: what acts on the body moves nothing", LoadOf(name)),
              fmt::format("add it to the forces in a rate, as in rate = \"(F + {})/m\"", LoadOf(name)));
    }
    const Motion motion = params_.motion == "translation" ? Motion::kTranslation : Motion::kRotation;
    if (std::optional<SlidingLoads> loads =
            SlidingLoads::Of(params_.load, bodies, "equations", motion, context_, plant_->layout_))
      plant_->loads_ = *std::move(loads);
  }

  bool Used(const std::string& name) const {
    const auto in = [&](const std::string& text) { return NamesIn(text).contains(name); };
    return std::ranges::any_of(params_.state, [&](const auto& one) { return in(one.second.rate); }) ||
           std::ranges::any_of(params_.define, [&](const auto& one) { return in(one.second); });
  }

  /// Which outputs follow which inputs at once, through whatever definitions.
  void AskWhatFeeds() {
    std::map<std::string, std::set<std::string>> inputs_of;
    const std::function<std::set<std::string>(const std::string&)> inputs_in = [&](const std::string& text) {
      std::set<std::string> found;
      for (const std::string& name : NamesIn(text)) {
        found.insert(name);
        if (const auto known = inputs_of.find(name); known != inputs_of.end())
          found.insert(known->second.begin(), known->second.end());
      }
      return found;
    };
    for (const std::string& name : ordered_) inputs_of[name] = inputs_in(texts_.at(name));
    plant_->feeds_.assign(plant_->layout_.outputs.size(), std::vector<bool>(plant_->inputs_, false));
    for (std::size_t k = 0; k < params_.output.size(); ++k) {
      const std::set<std::string> names = inputs_in(params_.output[k].second.value);
      for (std::size_t i = 0; i < plant_->inputs_; ++i)
        plant_->feeds_[plant_->states_ + k][i] = names.contains(params_.input[i].first);
    }
  }

  const Params& params_;
  const Value& table_;
  BuildContext& context_;
  std::unique_ptr<Equations> plant_;
  std::set<std::string> names_;
  mutable std::map<std::string, std::set<std::string>> names_in_;
  std::map<std::string, std::size_t> slots_;
  std::map<std::string, double*> known_, of_motion_;  // in equations; where a body is
  std::map<std::string, double> constants_;
  std::map<std::string, std::string> texts_;  // of definitions
  std::vector<std::string> ordered_, open_;
};

PluginInfo Equations::Info() {
  return {"plant",
          "equations",
          "ordinary differential equations that the scenario writes down",
          "x' = rate(t, x, u, p, load), y = value(t, x, u, p, load)",
          "definition",
          {}};
}

PlantTraits Equations::Traits() {
  PlantTraits traits;
  traits.nuisances = [](const Plan& plan) {
    std::vector<NuisanceParameter> nuisances = ParametersInSection(plan);
    const Value* states = plan.root.FindPath("plant.state");
    for (const std::string& name : states != nullptr ? KeysOf(*states) : std::vector<std::string>()) {
      const std::string path = "plant.state." + name;
      nuisances.push_back(StartInMotion(path + ".start", plan.root.NumberOr(path + ".nominal", 1.0)));
    }
    const std::vector<NuisanceParameter> loads = LoadSizes(plan);
    nuisances.insert(nuisances.end(), loads.begin(), loads.end());
    return nuisances;
  };
  traits.bodies = [](const Plan& plan) {
    std::vector<Place> bodies;
    const Value* table = plan.root.FindPath("plant.body");
    for (const std::string& name : table != nullptr ? KeysOf(*table) : std::vector<std::string>())
      bodies.push_back({"inertia", name, ""});
    return bodies;
  };
  traits.sections = {"parameter"};
  traits.separating_experiment =
      "excite each input alone, at two amplitudes and over the frequencies at which the plant moves: a wrong number "
      "scales "
      "with the amplitude, a dry friction does not";
  return traits;
}

std::unique_ptr<Equations> Equations::Create(const Params& params, const Value& table, BuildContext& context) {
  return Builder(params, table, context).Build();
}

Equations::Equations() = default;
Equations::~Equations() = default;

void Equations::Start(std::span<const double>, std::span<double> states, std::span<int>) const {
  std::ranges::copy(starts_, states.begin());
  values_[0] = 0.0;
  std::ranges::copy(starts_, values_.begin() + 1 + static_cast<std::ptrdiff_t>(inputs_));
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    loads_.Start(b, PositionOf(bodies_[b]), (*bodies_[b].speed)(), states);
}

bool Equations::FeedsThrough(int in, int out) const {
  return feeds_[static_cast<std::size_t>(out)][static_cast<std::size_t>(in)];
}

double Equations::PositionOf(const Body& body) const { return body.position ? (*body.position)() : 0.0; }

void Equations::Look(const View& view) const {
  values_[0] = view.time_s;
  const auto inputs = values_.begin() + 1;
  std::ranges::copy(view.inputs, inputs);
  std::ranges::copy(view.states.first(states_), inputs + static_cast<std::ptrdiff_t>(inputs_));
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    values_[bodies_[b].slot] = -loads_.Torque(b, PositionOf(bodies_[b]), (*bodies_[b].speed)(), view);
  for (const auto& [slot, expression] : definitions_) values_[slot] = (*expression)();
}

void Equations::Output(const View& view, std::span<double> outputs) const {
  std::ranges::copy(view.states.first(states_), outputs.begin());
  if (outputs_.empty()) return;
  Look(view);
  for (std::size_t k = 0; k < outputs_.size(); ++k) outputs[states_ + k] = (*outputs_[k])();
}

void Equations::Derivative(const View& view, std::span<double> rates) const {
  Look(view);
  for (std::size_t i = 0; i < states_; ++i) rates[i] = (*rates_[i])();
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    loads_.Derivative(b, PositionOf(bodies_[b]), (*bodies_[b].speed)(), view, rates);
}

}  // namespace dynoproof
