// From the named parts of a [plant] table to nodes, edges and elements. Every fault of the table is reported.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "plugins/plant/drive_line/drive_line.h"

namespace dynoproof {

using mechanics::kGround;

class DriveLineBuilder {
 public:
  DriveLineBuilder(const DriveLine::Params& params, const Value& table, BuildContext& context)
      : params_(params), table_(table), context_(context), motion_(context.motion), line_(new DriveLine) {}

  /// Reads every part; without any inertia there is nothing that the others could be joined to.
  void AddAll() {
    AddNodes();
    if (bodies_.empty()) return;
    for (const auto& [name, shaft] : params_.shaft) AddShaft(name, shaft);
    for (const auto& [name, load] : params_.load) AddLoad(name, load);
    for (const auto& [name, torque] : params_.torque) AddTorque(name, torque);
    CheckRuns();
  }

  std::unique_ptr<DriveLine> Build() {
    const int before = context_.diagnostics.error_count();
    AddAll();
    if (bodies_.empty())
      Fault(table_.where(), "the drive line has no inertia", "add [plant.inertia] or [plant.rotor.NAME]");
    if (context_.diagnostics.error_count() == before) CheckConnected();
    if (context_.diagnostics.error_count() == before) CheckRates();
    if (context_.diagnostics.error_count() != before) return nullptr;
    AddInitialState();
    if (context_.diagnostics.error_count() != before) return nullptr;
    AddStates();
    AddOutputs();
    line_->rotor_modes_ = params_.rotor_modes;
    line_->Finish();
    return std::move(line_);
  }

 private:
  struct InitialTwist {
    int from, to;
    double twist_rad, rate_rad_per_s;
    const Value* table;  // of the shaft; null: within a rotor
  };

  /// The nodes of one named inertia or rotor, left to right.
  struct Body {
    int first, count;
  };

  const SourceSpan& Where(const char* section, const std::string& name, const char* key = nullptr) const {
    const Value* value = table_.Find(section)->Find(name);
    const Value* inner = key == nullptr ? nullptr : value->Find(key);
    return inner != nullptr ? inner->where() : value->where();
  }
  void Fault(const SourceSpan& where, const std::string& message, const std::string& hint) {
    context_.diagnostics.Error(where, message, hint, "dynoproof describe drive_line");
  }

  void AddNodes() {
    for (const auto& [name, rotor] : params_.rotor) {
      bodies_[name] = {line_->linear_.size(), rotor.slices};
      AddSoftRotor(line_->linear_,
                   {name, rotor.inertia_kg_m2, rotor.stiffness_Nm_per_rad, rotor.damping_Nms_per_rad, rotor.slices});
    }
    for (const auto& [name, inertia] : params_.inertia) {
      if (bodies_.contains(name)) {
        Fault(Where("inertia", name), fmt::format("\"{}\" is a rotor already", name),
              fmt::format("its inertia is plant.rotor.{}.{}; another body needs another name", name,
                          NameIn(motion_, "inertia_kg_m2")));
        continue;
      }
      bodies_[name] = {line_->linear_.size(), 1};
      line_->linear_.nodes.push_back({name, inertia});
    }
    line_->linearised_ = line_->linear_;
  }

  const Body* FindBody(const std::string& name, const SourceSpan& where) {
    const auto it = bodies_.find(name);
    if (it != bodies_.end()) return &it->second;
    std::vector<std::string> names;
    for (const auto& [known, body] : bodies_) names.push_back(known);
    const std::optional<std::string> near = Closest(name, names);
    Fault(where, fmt::format("there is no inertia or rotor \"{}\"", name),
          near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("known: {}", fmt::join(names, ", ")));
    return nullptr;
  }

  /// A shaft's end: a rotor is joined at its right end when it comes first, at its left end when it comes second, or
  /// where "NAME.left", "NAME.right" say.
  int FindEnd(const std::string& text, bool first, const SourceSpan& where) {
    const bool left = text.ends_with(".left"), right = text.ends_with(".right");
    const std::string name = left ? text.substr(0, text.size() - 5) : right ? text.substr(0, text.size() - 6) : text;
    const Body* body = FindBody(name, where);
    if (body == nullptr) return kGround;
    return right || (first && !left) ? body->first + body->count - 1 : body->first;
  }

  /// The first node of the rotor or inertia that a node belongs to.
  int BodyOf(int node) const {
    for (const auto& [name, body] : bodies_) {
      if (node >= body.first && node < body.first + body.count) return body.first;
    }
    return node;
  }

  /// Builds the law that a shaft or load table names; its own keys are read by the law.
  std::unique_ptr<Law> MakeLaw(const std::string& name, const Value& table, std::vector<std::string> known,
                               const char* fallback) {
    const Value* law = table.Find("law");
    if (law != nullptr && !law->is_string()) {
      Fault(law->where(), "\"law\" is " + law->KindName(), "write a string");
      return nullptr;
    }
    if (law == nullptr && fallback == nullptr) {
      Fault(table.where(), fmt::format("\"{}\" names no law", name), "add law = \"viscous\", \"coulomb\", ...");
      return nullptr;
    }
    known.emplace_back("law");
    BuildContext context{context_.registry, context_.diagnostics,      name,    std::move(known), context_.period_s,
                         context_.seed,     params_.nominal_torque_Nm, nullptr, motion_};
    const std::string kind = law != nullptr ? law->string() : fallback;
    std::unique_ptr<Law> made = context_.registry.MakeLaw(kind, table, context);
    if (made == nullptr) return nullptr;
    const std::string fault = FaultOf(*made, motion_);
    if (fault.empty()) return made;
    Fault(law != nullptr ? law->where() : table.where(), fmt::format("law \"{}\" of \"{}\" {}", kind, name, fault),
          "mend the law or its parameters");
    return nullptr;
  }

  /// A sentence that names the fault of a law's torque near rest; empty: there is none. A law that says that it is linear is never asked during a run, so
  /// nobody would see that it gives no number or another torque; one that never gives a number helps nobody.
  static std::string FaultOf(const Law& law, Motion motion) {
    if (law.is_linear() && !law.layout().states.empty()) {
      const std::optional<DriveLine::LinearStates> found = FindLinearStates(law);
      const bool numbers =
          found->A.allFinite() && found->b_twist.allFinite() && found->b_rate.allFinite() && found->c.allFinite();
      return numbers ? "" : "says that it is linear, but not all its rates and torques are numbers";
    }
    constexpr double kSmall = 0x1p-10;
    bool any_number = false;
    std::string fault;
    for (const auto& [twist, rate] : {std::pair(0.0, 0.0), std::pair(kSmall, 0.0), std::pair(0.0, kSmall)}) {
      std::vector<double> states(law.layout().states.size());
      std::vector<int> modes(static_cast<std::size_t>(law.layout().modes));
      law.Start(twist, rate, states, modes);
      const double torque = law.Torque({0.0, twist, rate, 0.0, states, modes});
      any_number = any_number || std::isfinite(torque);
      fault = fmt::format("gives a {} of {} at a {} of {} {} and a rate of {} {}", NameIn(motion, "torque"), torque,
                          NameIn(motion, "twist"), twist, UnitIn(motion, "rad"), rate, UnitIn(motion, "rad/s"));
      if (!law.is_linear()) continue;
      const SpringDamper linear = law.linear();
      const double expected = linear.stiffness * twist + linear.damping * rate;
      // Also a torque that is no number is not near.
      if (!(std::abs(torque - expected) <= 1e-6 * std::abs(expected)))
        return fmt::format("{}, and says that it is linear with {}", fault, expected);
    }
    return any_number ? "" : fault;
  }

  /// Adds one edge with that law's linear parts, or `share` of them.
  int AddEdge(const std::string& name, int from, int to, SpringDamper linear, SpringDamper linearised, double share) {
    line_->linear_.edges.push_back({name, from, to, linear.stiffness * share, linear.damping * share});
    line_->linearised_.edges.push_back({name, from, to, linearised.stiffness * share, linearised.damping * share});
    return static_cast<int>(line_->linear_.edges.size()) - 1;
  }

  void AddElement(const std::string& name, std::unique_ptr<Law> law, SpringDamper linear,
                  std::vector<std::pair<int, double>> weights) {
    double mobility = 0.0;
    for (const auto& [node, weight] : weights) mobility += weight * weight / line_->linear_.nodes[node].inertia;
    std::optional<DriveLine::LinearStates> states = FindLinearStates(*law);
    // A state that feels the twist of something that turns freely feels a rigid angle, which is no state of the system.
    const bool held = weights.size() == 2 && weights[0].second == -weights[1].second && linear.stiffness > 0.0;
    if (states && !held && !states->b_twist.isZero(0.0)) states.reset();
    line_->elements_.push_back(
        {name, std::move(law), linear, std::move(weights), mobility, 0, 0, 0, std::move(states)});
  }

  bool IsTable(const char* section, const std::string& name, const Value& table) {
    if (table.is_table()) return true;
    Fault(table.where(), fmt::format("{}.{} is {}", section, name, table.KindName()), "write a table");
    return false;
  }

  void AddShaft(const std::string& name, const Value& table) {
    if (!IsTable("shaft", name, table)) return;
    const Value* between = table.Find("between");
    const bool pair = between != nullptr && between->is_array() && between->array().size() == 2 &&
                      between->array()[0].is_string() && between->array()[1].is_string();
    const std::string twist_key = KeyIn(motion_, table, "initial_twist_rad"),
                      rate_key = KeyIn(motion_, table, "initial_twist_rate_rad_per_s");
    std::unique_ptr<Law> law = MakeLaw(name, table, {"between", twist_key, rate_key}, "spring_damper");
    if (!pair) {
      Fault(between != nullptr ? between->where() : table.where(),
            fmt::format("shaft \"{}\" does not say what it joins", name), "write between = [\"I1\", \"I2\"]");
      return;
    }
    const int from = FindEnd(between->array()[0].string(), true, between->array()[0].where());
    const int to = FindEnd(between->array()[1].string(), false, between->array()[1].where());
    if (from == kGround || to == kGround || law == nullptr) return;
    if (BodyOf(from) == BodyOf(to)) {
      Fault(between->where(), fmt::format("shaft \"{}\" joins \"{}\" to itself", name, between->array()[0].string()),
            "name two inertias");
      return;
    }
    const std::optional<double> twist = InitialValue(name, table, twist_key);
    const std::optional<double> rate = InitialValue(name, table, rate_key);
    if (!twist || !rate) return;
    initial_twists_.push_back({from, to, *twist, *rate, &table});
    const SpringDamper linear = law->linear();
    const int edge = AddEdge(name, from, to, linear, law->linearised(), 1.0);
    named_edges_.push_back({name, {edge}, true, IsSpringDamper(*law)});
    if (!IsSpringDamper(*law)) AddElement(name, std::move(law), linear, {{from, 1.0}, {to, -1.0}});
  }

  void AddLoad(const std::string& name, const Value& table) {
    if (!IsTable("load", name, table)) return;
    if (std::any_of(params_.shaft.begin(), params_.shaft.end(),
                    [&name](const auto& shaft) { return shaft.first == name; })) {
      Fault(table.where(), fmt::format("\"{}\" is a shaft already", name),
            "rename one: both would be " + name + "." + NameIn(motion_, "torque"));
    }
    const Value* on = table.Find("on");
    std::unique_ptr<Law> law = MakeLaw(name, table, {"on"}, nullptr);
    if (on == nullptr || !on->is_string()) {
      Fault(on != nullptr ? on->where() : table.where(), fmt::format("load \"{}\" does not say where it acts", name),
            "write on = \"I5\"");
      return;
    }
    const Body* body = FindBody(on->string(), on->where());
    if (body == nullptr || law == nullptr) return;
    // On a rotor a linear law is spread over the slices; a nonlinear one acts on all of them by their mean speed.
    const bool linear = IsSpringDamper(*law);
    const double share = 1.0 / body->count;
    const SpringDamper taken = linear || body->count == 1 ? law->linear() : SpringDamper{};
    NamedEdges named{name, {}, false, linear};
    std::vector<std::pair<int, double>> weights;
    for (int i = body->first; i < body->first + body->count; ++i) {
      named.edges.push_back(AddEdge(name, i, kGround, taken, law->linearised(), share));
      weights.emplace_back(i, share);
    }
    named_edges_.push_back(std::move(named));
    if (!linear) AddElement(name, std::move(law), taken, std::move(weights));
  }

  /// A spring and damper and nothing else: edges of the network hold all of it.
  static bool IsSpringDamper(const Law& law) { return law.is_linear() && law.layout().states.empty(); }

  /// The matrices of a law that is linear with states of its own, column by column as it answers to one argument at a
  /// time; nothing for any other law.
  static std::optional<DriveLine::LinearStates> FindLinearStates(const Law& law) {
    const auto n = static_cast<Eigen::Index>(law.layout().states.size());
    if (!law.is_linear() || n == 0) return std::nullopt;
    const auto view = [n](double twist, double rate, const Eigen::VectorXd& z) {
      return LawView{0.0, twist, rate, 0.0, {z.data(), static_cast<std::size_t>(n)}, {}};
    };
    const auto rates = [&](double twist, double rate, const Eigen::VectorXd& z) {
      Eigen::VectorXd answer = Eigen::VectorXd::Zero(n);
      law.Derivative(view(twist, rate, z), {answer.data(), static_cast<std::size_t>(n)});
      return answer;
    };
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(n);
    DriveLine::LinearStates found{Eigen::MatrixXd(n, n), rates(1.0, 0.0, none), rates(0.0, 1.0, none),
                                  Eigen::RowVectorXd(n)};
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::VectorXd one = Eigen::VectorXd::Unit(n, j);
      found.A.col(j) = rates(0.0, 0.0, one);
      found.c[j] = law.Torque(view(0.0, 0.0, one));
    }
    return found;
  }

  void AddTorque(const std::string& name, const DriveLine::Torque& torque) {
    std::vector<std::pair<int, double>> weights;
    if (torque.on.empty())
      Fault(Where("torque", name, "on"), fmt::format("torque \"{}\" acts on nothing", name), "write on = \"I1\"");
    for (const std::string& target : torque.on) {
      if (std::count(torque.on.begin(), torque.on.end(), target) > 1) {
        Fault(Where("torque", name, "on"), fmt::format("torque \"{}\" names \"{}\" twice", name, target),
              "once is enough");
        return;
      }
      const Body* body = FindBody(target, Where("torque", name, "on"));
      if (body == nullptr) return;
      int first = 1, last = body->count;
      if (!torque.slices.empty()) {
        if (body->count == 1 || torque.slices.size() != 2 || torque.slices[0] > torque.slices[1] ||
            torque.slices[1] > body->count) {
          Fault(Where("torque", name, "slices"), fmt::format("\"{}\" has no such slices", target),
                body->count == 1 ? "only a rotor has slices" : fmt::format("first and last of 1 ... {}", body->count));
          return;
        }
        first = torque.slices[0];
        last = torque.slices[1];
      }
      for (int i = first; i <= last; ++i) {
        const int node = body->first + i - 1;
        weights.emplace_back(node, line_->linear_.nodes[node].inertia);
      }
    }
    double sum = 0.0;
    for (const auto& [node, inertia] : weights) sum += inertia;
    for (auto& [node, weight] : weights) weight *= torque.gain / sum;
    line_->layout_.inputs.push_back(
        {name, UnitIn(motion_, "N m"), NameIn(motion_, "torque") + " entry", params_.nominal_torque_Nm});
    line_->inputs_.push_back(std::move(weights));
  }

  void CheckRuns() {
    for (const auto& [name, run] : params_.run) {
      for (const std::string& inertia : run.inertias) FindBody(inertia, Where("run", name, "inertias"));
    }
  }

  /// Every node must hang on every other by shafts, whatever their law: a lone inertia is a typing error.
  void CheckConnected() {
    mechanics::Network shafts = line_->linear_;
    for (mechanics::Edge& edge : shafts.edges) edge.stiffness = 1.0;
    const std::vector<int> part = shafts.Parts();
    for (const auto& [name, body] : bodies_) {
      if (part[body.first] == part[0]) continue;
      const bool rotor = body.count > 1;
      Fault(Where(rotor ? "rotor" : "inertia", name),
            fmt::format("no shaft joins \"{}\" to the rest of the line", name),
            "add [plant.shaft.NAME] with between = [...]");
      return;
    }
  }

  /// Numbers that are valid each by itself can make rates of which a number holds no square: infinities would follow.
  void CheckRates() {
    constexpr double kMost = 1e150;
    const auto place = [&](const std::string& name) -> const SourceSpan& {
      for (const char* section : {"inertia", "shaft", "load", "rotor"}) {
        const Value* table = table_.Find(section);
        if (table != nullptr && table->Find(name) != nullptr) return table->Find(name)->where();
      }
      return table_.where();
    };
    const std::vector<mechanics::Node>& nodes = line_->linear_.nodes;
    for (const mechanics::Node& node : nodes) {
      if (1.0 / node.inertia <= kMost) continue;
      Fault(place(node.name),
            fmt::format("\"{}\" has an inertia of {} {}, too small to compute with", node.name, node.inertia,
                        UnitIn(motion_, "kg m^2")),
            "is the unit right?");
      return;
    }
    for (const mechanics::Network* network : {&line_->linear_, &line_->linearised_}) {
      for (const mechanics::Edge& edge : network->edges) {
        for (const int end : {edge.from, edge.to}) {
          if (end == kGround) continue;
          const double stiff = std::abs(edge.stiffness) / nodes[end].inertia,
                       damped = std::abs(edge.damping) / nodes[end].inertia;
          if (stiff <= kMost && damped <= kMost) continue;
          Fault(place(edge.name),
                fmt::format("\"{}\" has a {} too large to compute with beside the inertia of \"{}\", {} {}", edge.name,
                            damped <= kMost ? "stiffness" : "damping", nodes[end].name, nodes[end].inertia,
                            UnitIn(motion_, "kg m^2")),
                "are the units right?");
          return;
        }
      }
    }
  }

  /// What a shaft starts with, 0 where nothing is written; none, with a diagnostic, for what is no finite number.
  std::optional<double> InitialValue(const std::string& shaft, const Value& table, const std::string& key) {
    const Value* value = table.Find(key);
    if (value == nullptr) return 0.0;
    if (value->is_number() && std::isfinite(value->number())) return value->number();
    Fault(value->where(), fmt::format("{} of shaft \"{}\" is no finite number", key, shaft),
          fmt::format("the {} at t = 0 in {}, its rate in {}", NameIn(motion_, "twist"), UnitIn(motion_, "rad"),
                      UnitIn(motion_, "rad/s")));
    return std::nullopt;
  }

  /// From the twists and their rates at t = 0 to angles and speeds relative to node 0; slices of a rotor start without
  /// twist.
  void AddInitialState() {
    for (const auto& [name, body] : bodies_) {
      for (int i = body.first + 1; i < body.first + body.count; ++i)
        initial_twists_.push_back({i - 1, i, 0.0, 0.0, nullptr});
    }
    line_->initial_angles_ = FromDifferences(&InitialTwist::twist_rad, "initial_twist_rad");
    line_->initial_angles_[0] = params_.initial_angle_rad;
    line_->initial_speeds_ = FromDifferences(&InitialTwist::rate_rad_per_s, "initial_twist_rate_rad_per_s");
    for (double& speed : line_->initial_speeds_) speed += params_.initial_speed_rad_per_s;
  }

  /// The value of each node, 0 at node 0, from the differences over shafts. Those that close a circle must agree with the
  /// others.
  std::vector<double> FromDifferences(double InitialTwist::*difference, const char* key) {
    std::vector<double> values(line_->linear_.size(), std::numeric_limits<double>::quiet_NaN());
    values[0] = 0.0;
    for (bool changed = true; changed;) {
      changed = false;
      for (const InitialTwist& one : initial_twists_) {
        const bool from_known = !std::isnan(values[one.from]), to_known = !std::isnan(values[one.to]);
        if (from_known == to_known) continue;
        if (from_known) values[one.to] = values[one.from] - one.*difference;
        if (to_known) values[one.from] = values[one.to] + one.*difference;
        changed = true;
      }
    }
    for (const InitialTwist& one : initial_twists_) {
      const double seen = values[one.from] - values[one.to];
      // A difference of values is no more exact than these.
      const double size = std::abs(seen) + std::abs(one.*difference) + 1e-3 * std::abs(values[one.from]);
      if (one.table == nullptr || std::abs(seen - one.*difference) <= 1e-9 * size) continue;
      Fault(one.table->where(), fmt::format("{} does not fit the other shafts of the circle", NameIn(motion_, key)),
            "they add up to zero around a circle");
    }
    return values;
  }

  void AddState(const std::string& node, const char* name, const char* unit, const std::string& what, double nominal) {
    line_->layout_.states.push_back({node + "." + NameIn(motion_, name), UnitIn(motion_, unit), what, nominal});
  }

  void AddStates() {
    Layout& layout = line_->layout_;
    const auto& nodes = line_->linear_.nodes;
    // A usual twist at a node: that of its stiffest shaft under the usual torque; a usual speed: the same oscillating
    // at the node's own frequency. Solver tolerances scale with them.
    std::vector<double> stiffness(nodes.size(), 0.0);
    for (const mechanics::Edge& edge : line_->linearised_.edges) {
      stiffness[edge.from] = std::max(stiffness[edge.from], edge.stiffness);
      if (edge.to != kGround) stiffness[edge.to] = std::max(stiffness[edge.to], edge.stiffness);
    }
    const auto twist = [&](int i) { return params_.nominal_torque_Nm / (stiffness[i] > 0.0 ? stiffness[i] : 1e4); };
    const int n = line_->linear_.size();
    for (int i = 1; i < n; ++i) {
      AddState(nodes[i].name, "relative_angle", "rad", "relative to " + nodes[0].name, twist(i));
    }
    AddState(nodes[0].name, "angle", "rad", "absolute", twist(0));
    for (int i = 0; i < n; ++i) {
      const double frequency = std::sqrt((stiffness[i] > 0.0 ? stiffness[i] : 1e4) / nodes[i].inertia);
      AddState(nodes[i].name, "speed", "rad/s", "speed", twist(i) * frequency);
    }
    std::stable_sort(line_->elements_.begin(), line_->elements_.end(), [](const auto& a, const auto& b) {
      const auto rank = [](const DriveLine::Element& one) { return one.linear_states ? 0 : one.law->sticks() ? 2 : 1; };
      return rank(a) < rank(b);
    });
    for (DriveLine::Element& element : line_->elements_) {
      element.state = static_cast<int>(layout.states.size());
      element.mode = layout.modes;
      element.guard = layout.guards;
      for (const Port& state : element.law->layout().states) {
        layout.states.push_back(state);
        layout.states.back().name = element.name + "." + NameIn(motion_, state.name);
        layout.states.back().unit = UnitIn(motion_, state.unit);
      }
      for (int i = 0; i < element.law->layout().modes; ++i)
        layout.mode_names.push_back(fmt::format("{}.{}", element.name, i));
      layout.modes += element.law->layout().modes;
      layout.guards += element.law->layout().guards;
    }
  }

  /// An output of a part, all of one kind.
  void AddOutput(const std::string& part, OutputTerm::Kind kind, const std::vector<int>& indices, int element = -1) {
    struct Quantity {
      const char *name, *unit;
      double nominal;
    };
    static const std::map<OutputTerm::Kind, Quantity> quantities = {
        {OutputTerm::Kind::kTorque, {"torque", "N m", 1.0}},
        {OutputTerm::Kind::kTwist, {"twist", "rad", 1e-4}},
        {OutputTerm::Kind::kRate, {"rate", "rad/s", 1.0}},
        {OutputTerm::Kind::kAngle, {"angle", "rad", 1.0}},
        {OutputTerm::Kind::kSpeed, {"speed", "rad/s", 1.0}}};
    const Quantity& quantity = quantities.at(kind);
    const std::string name = part + "." + NameIn(motion_, quantity.name);
    const bool torque = kind == OutputTerm::Kind::kTorque;
    line_->layout_.outputs.push_back(
        {name, UnitIn(motion_, quantity.unit), name, torque ? params_.nominal_torque_Nm : quantity.nominal});
    DriveLine::Reading reading{{}, element};
    for (const int index : indices) reading.terms.push_back({kind, index});
    line_->readings_.push_back(std::move(reading));
  }

  void AddOutputs() {
    for (const NamedEdges& named : named_edges_) {
      const auto& elements = line_->elements_;
      const auto it = std::find_if(elements.begin(), elements.end(),
                                   [&named](const DriveLine::Element& element) { return element.name == named.name; });
      const int element = named.linear ? -1 : static_cast<int>(it - elements.begin());
      AddOutput(named.name, OutputTerm::Kind::kTorque, named.edges, element);
      if (!named.shaft) continue;
      AddOutput(named.name, OutputTerm::Kind::kTwist, named.edges);
      AddOutput(named.name, OutputTerm::Kind::kRate, named.edges);
    }
    for (const auto& [name, body] : bodies_) {
      const auto ends = body.count == 1
                            ? std::vector<std::pair<std::string, int>>{{name, body.first}}
                            : std::vector<std::pair<std::string, int>>{{name + ".left", body.first},
                                                                       {name + ".right", body.first + body.count - 1}};
      for (const auto& [end, node] : ends) {
        AddOutput(end, OutputTerm::Kind::kSpeed, {node});
        AddOutput(end, OutputTerm::Kind::kAngle, {node});
      }
    }
  }

  struct NamedEdges {
    std::string name;
    std::vector<int> edges;
    bool shaft, linear;
  };

  const DriveLine::Params& params_;
  const Value& table_;
  BuildContext& context_;
  Motion motion_;
  std::unique_ptr<DriveLine> line_;
  std::map<std::string, Body> bodies_;
  std::vector<NamedEdges> named_edges_;
  std::vector<InitialTwist> initial_twists_;
};

void DriveLine::ReportMore(const Params& params, const Value& table, BuildContext& context) {
  DriveLineBuilder(params, table, context).AddAll();
}

std::unique_ptr<DriveLine> DriveLine::Create(const Params& params, const Value& table, BuildContext& context) {
  return DriveLineBuilder(params, table, context).Build();
}

}  // namespace dynoproof
