#include "sim/rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "base/text.h"
#include "base/units.h"

namespace dynoproof {

int Rig::FindSlot(std::string_view name) const {
  const auto it = std::find(slots.begin(), slots.end(), name);
  return it == slots.end() ? -1 : static_cast<int>(it - slots.begin());
}

const Block* Rig::FindBlock(std::string_view name) const {
  for (const auto* list : {&blocks, &controls}) {
    for (const Block& block : *list) {
      if (block.name == name) return &block;
    }
  }
  return nullptr;
}

std::vector<double> Rig::KnownFrom() const {
  // Of each signal. A sample is of before its tick, so that what a tick gives is seen from half a period behind it on.
  std::vector<double> from(slots.size(), 0.0);
  for (const Block& control : controls)
    std::fill_n(from.begin() + control.first_output, control.outputs(),
                SecondsOf(control.offset) + 0.5 * SecondsOf(period));
  for (const InputLine& line : inputs) {
    if (line.source == nullptr && !line.continuous) from[line.command] = from[line.delayed] = from[line.from];
  }
  for (const Block& block : blocks) {  // each after those that it reads at the same instant
    for (int out = 0; out < block.outputs(); ++out) {
      for (std::size_t in = 0; in < block.inputs.size(); ++in) {
        double& own = from[block.first_output + out];
        if (block.component->FeedsThrough(static_cast<int>(in), out)) own = std::max(own, from[block.inputs[in]]);
      }
    }
  }
  std::vector<double> known_from;
  for (const OutputLine& line : outputs) {
    const double of_signal = from[line.signal];
    known_from.push_back(of_signal > 0.0 ? of_signal + SecondsOf(period) * line.delay_periods : 0.0);
  }
  return known_from;
}

Frame Rig::MakeFrame() const {
  Frame frame;
  frame.signals.assign(slots.size(), 0.0);
  frame.states.assign(state_ports.size(), 0.0);
  frame.control_states.assign(control_states, 0.0);
  frame.rings.assign(rings, 0.0);
  frame.modes.assign(modes, 0);
  frame.control_modes.assign(control_modes, 0);
  return frame;
}

namespace {

/// Builds a rig section by section; wiring by name comes last, when every signal has its slot.
class RigBuilder {
 public:
  RigBuilder(const Plan& plan, const Registry& registry, const Records& records, Diagnostics& diagnostics)
      : plan_(plan), registry_(registry), records_(records), diagnostics_(diagnostics), rig_(new Rig) {}

  std::unique_ptr<Rig> Build() {
    const int before = diagnostics_.error_count();
    CheckTopLevel(plan_, diagnostics_);
    rig_->id = plan_.id;
    rig_->run = ReadRun(plan_, diagnostics_);
    const auto period =
        ToNanoseconds(rig_->run.period_s);  // what cannot be kept has been reported; go on with the usual one
    rig_->period = period && *period > 0 ? *period : 100'000;
    rig_->clock_rate = rig_->run.clock_rate;
    const auto duration = ToNanoseconds(rig_->run.duration_s);
    rig_->steps = duration ? *duration / rig_->period : 0;
    AddPlant();
    AddParts("part", false);
    AddParts("control", true);
    for (auto& [name, spec] : ReadInputs(plan_, diagnostics_)) AddInput(name, spec);
    for (auto& [name, spec] : ReadOutputs(plan_, diagnostics_)) AddOutput(name, spec);
    if (rig_->outputs.empty()) {
      diagnostics_.Error(plan_.root.where(), "the scenario records nothing",
                         "add [output.NAME] with of = \"plant....\"");
    }
    Wire();
    if (diagnostics_.error_count() == before) {
      Order();
      Place();
      CutPeriod();
    }
    return diagnostics_.error_count() == before ? std::move(rig_) : nullptr;
  }

 private:
  int AddSlot(const std::string& name) {
    rig_->slots.push_back(name);
    slot_of_[name] = static_cast<int>(rig_->slots.size()) - 1;
    return static_cast<int>(rig_->slots.size()) - 1;
  }

  BuildContext Context(const std::string& name, std::vector<std::string> known, double nominal = 1.0) {
    // Every block draws its noise from a stream of its own, found by its name: adding a block changes no other's noise.
    const auto stream = static_cast<std::int64_t>(std::stoull(Fingerprint(name), nullptr, 16) >> 1);
    return {registry_, diagnostics_, name, std::move(known), rig_->run.period_s, rig_->run.seed ^ stream,
            nominal,   &records_};
  }

  /// Makes the block and its output slots; its inputs stay unwired (-1).
  Block* AddBlock(const std::string& kind, const std::string& name, const Value& table, std::vector<std::string> known,
                  double nominal, std::vector<std::unique_ptr<Block>>& list) {
    BuildContext context = Context(name, std::move(known), nominal);
    std::unique_ptr<Component> component = registry_.MakeComponent(kind, table, context);
    if (component == nullptr) return nullptr;
    auto block = std::make_unique<Block>();
    block->name = name;
    block->inputs.assign(component->layout().inputs.size(), -1);
    block->first_output = static_cast<int>(rig_->slots.size());
    for (const Port& port : component->layout().outputs) {
      AddSlot(name + "." + port.name);
      unit_of_[name + "." + port.name] = port.unit;
    }
    block->component = std::move(component);
    list.push_back(std::move(block));
    return list.back().get();
  }

  void AddPlant() {
    const Value* plant = plan_.root.Find("plant");
    if (plant == nullptr || !plant->is_table()) {
      diagnostics_.Error(plan_.root.where(), "the scenario has no section [plant]",
                         "add [plant] with type = \"drive_line\"");
      return;
    }
    AddBlock("plant", "plant", *plant, {"inputs"}, 1.0, continuous_);
    if (const Value* inputs = plant->Find("inputs")) WireTable(*inputs, "plant");
  }

  void AddParts(const std::string& section, bool discrete) {
    const Value* tables = plan_.root.Find(section);
    if (tables == nullptr) return;
    if (!tables->is_table()) {
      diagnostics_.Error(tables->where(), fmt::format("\"{}\" is {}", section, tables->KindName()),
                         fmt::format("write [{}.NAME]", section));
      return;
    }
    for (const Value::Entry& entry : tables->table()) {
      const std::string name = section + "." + entry.key;
      if (!entry.value.is_table()) {
        diagnostics_.Error(entry.value.where(), fmt::format("{} is {}", name, entry.value.KindName()), "write a table");
        continue;
      }
      std::vector<std::string> known = {"inputs"};
      if (discrete) known.insert(known.end(), {"period_s", "offset_s"});
      Block* block =
          AddBlock(discrete ? "control" : "plant", name, entry.value, known, 1.0, discrete ? discrete_ : continuous_);
      if (block == nullptr) continue;
      if (discrete) ReadTiming(entry.value, *block);
      if (discrete && block->inputs.size() > kMaxControlInputs) {
        diagnostics_.Error(entry.value.where(), fmt::format("{} has {} inputs", name, block->inputs.size()),
                           fmt::format("at most {}: a tick has fixed memory", kMaxControlInputs));
      }
      if (const Value* inputs = entry.value.Find("inputs")) WireTable(*inputs, name);
    }
  }

  void ReadTiming(const Value& table, Block& block) {
    const auto read = [&](const char* key, double fallback, bool zero_allowed) -> Nanoseconds {
      const Value* value = table.Find(key);
      const double seconds = value == nullptr || !value->is_number() ? fallback : value->number();
      const auto time = ToNanoseconds(seconds);
      const bool good = (value == nullptr || value->is_number()) && time && *time % rig_->period == 0 &&
                        (*time > 0 || (zero_allowed && *time == 0));
      if (!good && value != nullptr) {  // without one it is run.period_s, which has its own fault then
        diagnostics_.Error(value->where(), fmt::format("{} of {} is no multiple of run.period_s", key, block.name),
                           fmt::format("a multiple of {} s: let the rates divide", rig_->run.period_s));
      }
      return good ? *time : rig_->period;
    };
    block.period = read("period_s", rig_->run.period_s, false);
    block.offset = read("offset_s", 0.0, true);
  }

  /// inputs = { port = "signal" } of a block.
  void WireTable(const Value& table, const std::string& block) {
    if (!table.is_table()) {
      diagnostics_.Error(table.where(), fmt::format("\"inputs\" of {} is {}", block, table.KindName()),
                         "write inputs = { port = \"signal\" }");
      return;
    }
    for (const Value::Entry& entry : table.table()) {
      if (!entry.value.is_string()) {
        diagnostics_.Error(entry.value.where(), fmt::format("\"{}\" names no signal", entry.key), "write a string");
      } else {
        port_wishes_.push_back({block + "." + entry.key, entry.value.string(), entry.value.where(), entry.where});
      }
    }
  }

  const Value* Section(const char* section, const std::string& name) const {
    return plan_.root.Find(section)->Find(name);
  }

  /// Adds the stages of a chain; returns the slot at its end and sums up the pure delays.
  int AddStages(const std::string& kind, const std::string& chain, const std::vector<Value>& stages, int slot,
                double nominal, double& delay_s) {
    bool sampled = false;
    for (std::size_t i = 0; i < stages.size(); ++i) {
      const std::string name = fmt::format("{}.{}.{}", chain, kind, i);
      if (!stages[i].is_table()) {
        diagnostics_.Error(stages[i].where(), fmt::format("{} is {}", name, stages[i].KindName()),
                           "write { type = ... }");
        continue;
      }
      Block* block = AddBlock(kind, name, stages[i], {}, nominal, continuous_);
      if (block == nullptr) continue;
      delay_s += block->component->delay_s();
      if (sampled && block->states() > 0) {
        diagnostics_.Error(stages[i].where(), fmt::format("{} filters a signal that is noise or steps already", name),
                           "put noise and quantisation last");
      }
      sampled = sampled || block->component->sampled();
      block->inputs[0] = slot;
      slot = block->first_output;
    }
    return slot;
  }

  /// A signal is a dataset of the trace, a column of a record and a step of a dotted path: its name must do for all.
  void CheckName(const std::string& section, const std::string& name) {
    const Value* table = Section(section.c_str(), name);
    const std::string what = fmt::format("{}.{}", section, name);
    if (name.empty() || name.find_first_of("/.\"") != std::string::npos) {
      diagnostics_.Error(table->where(), fmt::format("{}: a signal cannot have this name", what),
                         "letters, digits and underscores, no dot, slash or quote");
    } else if (name == "t" || name == "time") {
      diagnostics_.Error(table->where(), fmt::format("{}: \"{}\" is the time of a trace and a record", what, name),
                         "choose another name");
    } else if (!signal_names_.insert(name).second) {
      diagnostics_.Error(table->where(), fmt::format("{}: an input has this name already", what),
                         "a trace holds inputs and outputs side by side: choose another name");
    }
  }

  /// A unit that somebody wrote must be the port's: nothing is converted between a signal and the model.
  void CheckUnit(const std::string& what, const std::string& written, const std::string& port_unit,
                 const SourceSpan& where) {
    const std::optional<Unit> ours = ParseUnit(written), ports = ParseUnit(port_unit);
    if (!ours) {
      diagnostics_.Error(where, fmt::format("the unit \"{}\" of {} is unknown", written, what),
                         fmt::format("the port has \"{}\"", port_unit));
    } else if (ports && !(ours->exponents == ports->exponents && ours->factor == ports->factor &&
                          ours->offset == ports->offset)) {
      diagnostics_.Error(where, fmt::format("{} is in \"{}\", its port in \"{}\"", what, written, port_unit),
                         "nothing is converted here: write the port's unit, or leave \"unit\" out");
    }
  }

  void AddInput(const std::string& name, const InputSpec& spec) {
    const Value& table = *Section("input", name);
    CheckName("input", name);
    InputLine line;
    line.name = name;
    line.unit = spec.unit;
    line.description = spec.description;
    line.nominal = spec.nominal;
    const bool has_source = table.Find("source") != nullptr;
    if (has_source == !spec.from.empty()) {
      diagnostics_.Error(table.where(), fmt::format("input.{} needs exactly one of \"source\" and \"from\"", name),
                         "source = { type = \"chirp\", ... } or from = \"control.NAME.port\"", "dynoproof list");
    }
    const std::string chain = "input." + name;
    line.command = AddSlot(chain + ".command");
    line.delayed = line.command;
    if (has_source && spec.source.is_table()) {
      BuildContext context = Context(chain + ".source", {}, spec.nominal);
      line.source = registry_.MakeComponent("source", spec.source, context);
    } else if (has_source) {
      diagnostics_.Error(spec.source.where(), fmt::format("the source of {} is {}", chain, spec.source.KindName()),
                         "write source = { type = ... }");
    }
    line.delayed = AddSlot(chain + ".delayed");
    double delay_s = 0.0;
    slot_of_[chain] = AddStages("actuator", chain, spec.actuator, line.delayed, spec.nominal, delay_s);
    // Whole nanoseconds, as the clock: delays that differ by round-off alone share a cut.
    const Nanoseconds delay = std::llround(delay_s * 1e9 / rig_->clock_rate);
    if (delay == 0) {
      Replace(line.delayed, line.command);
      line.delayed = line.command;
    }
    line.delay_periods = static_cast<int>(delay / rig_->period);
    line.delay_fraction = static_cast<double>(delay % rig_->period) / static_cast<double>(rig_->period);
    for (const std::string& port : spec.to) {
      const Value* to = table.Find("to");
      port_wishes_.push_back({port, chain, to->where(), to->where()});
      port_wishes_.back().input = static_cast<int>(rig_->inputs.size());
    }
    if (!spec.from.empty()) from_wishes_.push_back({rig_->inputs.size(), spec.from, table.Find("from")->where()});
    rig_->inputs.push_back(std::move(line));
  }

  void AddOutput(const std::string& name, const OutputSpec& spec) {
    CheckName("output", name);
    OutputLine line;
    line.name = name;
    line.unit = spec.unit;
    line.description = spec.description;
    line.nominal = spec.nominal;
    const std::string chain = "output." + name;
    // The stages are built first and wired to the signal below, when every signal is known.
    double delay_s = 0.0;
    const std::size_t first = continuous_.size();
    line.signal = AddStages("sensor", chain, spec.sensor, -1, spec.nominal, delay_s);
    const bool direct = line.signal == -1;
    line.sample = AddSlot(chain);
    const Nanoseconds delay = std::llround(delay_s * 1e9 / rig_->clock_rate),
                      periods = (delay + rig_->period - 1) / rig_->period;
    line.delay_periods = static_cast<int>(periods);
    line.sample_fraction = static_cast<double>(periods * rig_->period - delay) / static_cast<double>(rig_->period);
    rig_->outputs.push_back(std::move(line));
    const SourceSpan where = Section("output", name)->Find("of")->where();
    of_wishes_.push_back({rig_->outputs.size() - 1, direct ? nullptr : continuous_[first].get(), spec.of, where});
  }

  /// The slot of a signal that a user names, or -1 with a diagnostic.
  int Find(const std::string& signal, const SourceSpan& where) {
    const auto it = slot_of_.find(signal);
    if (it != slot_of_.end()) return it->second;
    if (!built_all_) return -1;  // a block that failed to build has no ports: its own fault is enough
    std::vector<std::string> names;
    for (const auto& [name, slot] : slot_of_) names.push_back(name);
    const std::optional<std::string> near = Closest(signal, names);
    diagnostics_.Error(
        where, fmt::format("there is no signal \"{}\"", signal),
        near ? fmt::format("did you mean \"{}\"?", *near) : "signals are block.port, such as plant.k4.torque",
        "dynoproof describe " + ShellQuoted(plan_.file));
    return -1;
  }

  void Wire() {
    built_all_ = !diagnostics_.has_errors();
    for (const PortWish& wish : port_wishes_) WirePort(wish);
    for (const FromWish& wish : from_wishes_) {
      const int slot = Find(wish.signal, wish.where);
      if (slot < 0) continue;
      InputLine& line = rig_->inputs[wish.input];
      line.from = slot;
      for (const auto& block : continuous_) {
        if (slot < block->first_output || slot >= block->first_output + block->outputs()) continue;
        line.continuous = true;
        if (line.delayed != line.command) {
          diagnostics_.Error(wish.where, fmt::format("input.{} delays a continuous signal", line.name),
                             "a pure delay needs a held input");
        }
      }
      if (line.continuous) Replace(line.command, slot);
    }
    for (const OfWish& wish : of_wishes_) {
      const int slot = Find(wish.signal, wish.where);
      OutputLine& line = rig_->outputs[wish.output];
      if (wish.first_stage != nullptr) {
        wish.first_stage->inputs[0] = slot;
      } else {
        line.signal = slot;
      }
      const auto unit = unit_of_.find(wish.signal);
      if (line.unit.empty()) {
        line.unit = unit != unit_of_.end() ? unit->second : "1";
      } else if (unit != unit_of_.end() && wish.first_stage == nullptr) {
        CheckUnit("output." + line.name, line.unit, unit->second, Section("output", line.name)->Find("unit")->where());
      }
    }
    for (const auto* list : {&continuous_, &discrete_}) {
      for (const auto& block : *list) {
        for (std::size_t i = 0; i < block->inputs.size(); ++i) {
          if (block->inputs[i] >= 0 || !built_all_) continue;
          const std::string port = block->name + "." + block->component->layout().inputs[i].name;
          if (refused_.contains(port) || block->name.starts_with("output.")) continue;
          const Value* table = plan_.root.FindPath(block->name);
          diagnostics_.Error(table != nullptr ? table->where() : plan_.root.where(),
                             fmt::format("nothing drives {}", port),
                             fmt::format("add [input.NAME] with to = \"{}\"", port));
        }
      }
    }
  }

  struct PortWish {
    std::string port, signal;
    SourceSpan signal_where, port_where;
    int input = -1;  // of the rig, when that input drives the port; actuator stages keep the unit
  };

  void WirePort(const PortWish& wish) {
    std::vector<std::string> ports;
    for (const auto* list : {&continuous_, &discrete_}) {
      for (const auto& block : *list) {
        const auto& inputs = block->component->layout().inputs;
        for (std::size_t i = 0; i < inputs.size(); ++i) {
          const std::string name = block->name + "." + inputs[i].name;
          ports.push_back(name);
          if (name != wish.port) continue;
          const int slot = Find(wish.signal, wish.signal_where);
          if (block->inputs[i] >= 0 && slot >= 0) {
            diagnostics_.Error(wish.port_where, fmt::format("{} is driven twice", name), "one signal per port");
          }
          if (slot < 0) refused_.insert(name);
          if (wish.input >= 0) TakeUnit(rig_->inputs[wish.input], inputs[i].unit);
          block->inputs[i] = slot;
          return;
        }
      }
    }
    if (!built_all_) return;
    const std::optional<std::string> near = Closest(wish.port, ports);
    diagnostics_.Error(
        wish.port_where, fmt::format("there is no input port \"{}\"", wish.port),
        near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("ports: {}", fmt::join(ports, ", ")));
  }

  /// The unit of an input that drives a port: the port's.
  void TakeUnit(InputLine& line, const std::string& port_unit) {
    const Value* written = Section("input", line.name)->Find("unit");
    if (written != nullptr) {
      CheckUnit("input." + line.name, line.unit, port_unit, written->where());
    } else {
      line.unit = port_unit;
    }
  }

  /// Rewires every reader of slot `old` to slot `now`.
  void Replace(int old, int now) {
    for (const auto* list : {&continuous_, &discrete_}) {
      for (const auto& block : *list) std::replace(block->inputs.begin(), block->inputs.end(), old, now);
    }
    for (auto& [name, slot] : slot_of_) {
      if (slot == old) slot = now;
    }
    for (InputLine& line : rig_->inputs) {
      if (line.command == old) line.command = line.delayed = now;
      if (line.from == old) line.from = now;
    }
  }

  /// Sorts blocks so that each comes after those whose outputs it passes on at the same instant; ties by name. A circle
  /// is a fault: whichever of its members came first would read values of another age than the others do.
  void Order() {
    rig_->blocks = Sorted(continuous_, false);
    rig_->controls = Sorted(discrete_, true);
  }

  static bool PassesOn(const Block& block, int slot, bool discrete) {
    for (std::size_t i = 0; i < block.inputs.size(); ++i) {
      if (block.inputs[i] != slot) continue;
      for (int out = 0; out < block.outputs(); ++out) {
        if (discrete || block.component->FeedsThrough(static_cast<int>(i), out)) return true;
      }
    }
    return false;
  }

  /// Whether two controls are ever due at one instant. Where they are not, time orders them.
  static bool EverTogether(const Block& a, const Block& b) {
    return (a.offset - b.offset) % std::gcd(a.period, b.period) == 0;
  }

  /// Whether `block` must come after `other`. A control that reads itself reads its last tick, whatever the order.
  static bool WaitsFor(const Block& block, const Block& other, bool discrete) {
    if (discrete && (&block == &other || !EverTogether(block, other))) return false;
    for (int out = 0; out < other.outputs(); ++out) {
      if (PassesOn(block, other.first_output + out, discrete)) return true;
    }
    return false;
  }

  std::vector<Block> Sorted(std::vector<std::unique_ptr<Block>>& list, bool discrete) {
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a->name < b->name; });
    const auto first_awaited = [&](const Block& block) {
      return std::find_if(list.begin(), list.end(),
                          [&](const auto& other) { return WaitsFor(block, *other, discrete); });
    };
    std::vector<Block> sorted;
    while (!list.empty()) {
      auto next = std::find_if(list.begin(), list.end(),
                               [&](const auto& block) { return first_awaited(*block) == list.end(); });
      if (next == list.end()) {  // all wait: going from each to one that it waits for ends in a circle
        std::vector<const Block*> walk = {list.front().get()};
        auto again = walk.end();
        while (again == walk.end()) {
          const Block* awaited = first_awaited(*walk.back())->get();
          again = std::find(walk.begin(), walk.end(), awaited);
          if (again == walk.end()) {
            walk.push_back(awaited);
            again = walk.end();
          }
        }
        ReportCircle({again, walk.end()}, discrete);
        next = std::find_if(list.begin(), list.end(), [&](const auto& block) { return block.get() == *again; });
      }
      sorted.push_back(std::move(**next));
      list.erase(next);
    }
    return sorted;
  }

  void ReportCircle(const std::vector<const Block*>& circle, bool discrete) {
    std::string way;
    for (const Block* block : circle) way += block->name + " reads ";
    way += circle.front()->name;
    const Value* table = plan_.root.FindPath(circle.front()->name);
    const SourceSpan& where = table != nullptr ? table->where() : plan_.root.where();
    if (discrete) {
      diagnostics_.Error(where, fmt::format("controls that tick at one instant read one another in a circle: {}", way),
                         "nothing says which of them reads the last tick's value; give one an offset_s, so that they "
                         "tick one after the other");
    } else {
      diagnostics_.Error(where, fmt::format("an algebraic loop: {}", way), "put a lag or a delay into the loop");
    }
  }

  /// Gives every block its place in the frame.
  void Place() {
    for (Block& block : rig_->blocks) {
      const Layout& layout = block.component->layout();
      block.first_state = static_cast<int>(rig_->state_ports.size());
      block.first_mode = rig_->modes;
      block.first_guard = rig_->guards;
      for (Port port : layout.states) {
        port.name = block.name + "." + port.name;
        rig_->state_ports.push_back(std::move(port));
      }
      for (int i = 0; i < layout.modes; ++i) {
        const bool named = static_cast<std::size_t>(i) < layout.mode_names.size();
        rig_->mode_names.push_back(fmt::format(
            "{}.{}", block.name, named ? layout.mode_names[static_cast<std::size_t>(i)] : fmt::to_string(i)));
      }
      rig_->modes += layout.modes;
      rig_->guards += layout.guards;
    }
    for (Block& block : rig_->controls) {
      block.first_state = rig_->control_states;
      block.first_mode = rig_->control_modes;
      rig_->control_states += block.states();
      rig_->control_modes += block.component->layout().modes;
    }
    for (InputLine& line : rig_->inputs) {
      if (line.delayed == line.command) continue;
      line.ring = rig_->rings;
      rig_->rings += line.delay_periods + 1;
    }
    for (OutputLine& line : rig_->outputs) {
      if (line.delay_periods == 0) continue;
      line.ring = rig_->rings;
      rig_->rings += line.delay_periods;
    }
  }

  void CutPeriod() {
    std::vector<double> cuts = {0.0};
    for (const InputLine& line : rig_->inputs) cuts.push_back(line.delay_fraction);
    for (const OutputLine& line : rig_->outputs) cuts.push_back(line.sample_fraction);
    std::sort(cuts.begin(), cuts.end());
    cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      Interval interval;
      interval.begin = cuts[i];
      interval.length = (i + 1 < cuts.size() ? cuts[i + 1] : 1.0) - cuts[i];
      for (std::size_t k = 0; k < rig_->inputs.size(); ++k) {
        const InputLine& line = rig_->inputs[k];
        if (line.ring >= 0 && line.delay_fraction == cuts[i]) interval.switches.push_back(static_cast<int>(k));
      }
      for (std::size_t k = 0; k < rig_->outputs.size(); ++k) {
        const OutputLine& line = rig_->outputs[k];
        if (line.ring >= 0 && line.sample_fraction > 0.0 && line.sample_fraction == cuts[i])
          interval.samples.push_back(static_cast<int>(k));
      }
      rig_->intervals.push_back(std::move(interval));
    }
  }

  struct FromWish {
    std::size_t input;
    std::string signal;
    SourceSpan where;
  };
  struct OfWish {
    std::size_t output;
    Block* first_stage;
    std::string signal;
    SourceSpan where;
  };

  const Plan& plan_;
  const Registry& registry_;
  const Records& records_;
  Diagnostics& diagnostics_;
  std::unique_ptr<Rig> rig_;
  std::vector<std::unique_ptr<Block>> continuous_, discrete_;
  std::map<std::string, int> slot_of_;
  std::map<std::string, std::string> unit_of_;
  std::vector<PortWish> port_wishes_;
  std::vector<FromWish> from_wishes_;
  std::vector<OfWish> of_wishes_;
  std::set<std::string> refused_, signal_names_;
  bool built_all_ = true;
};

}  // namespace

std::unique_ptr<Rig> Rig::Build(const Plan& plan, const Registry& registry, const Records& records,
                                Diagnostics& diagnostics) {
  return RigBuilder(plan, registry, records, diagnostics).Build();
}

}  // namespace dynoproof
