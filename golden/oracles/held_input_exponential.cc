#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "oracles/oracle.h"

namespace dynoproof::oracles {
namespace {

using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// The drive line as M phi'' + C phi' + K phi = W u, written down once more from the scenario's tables.
struct Line {
  std::vector<long double> inertia;
  Matrix K, C, W;
  struct Shaft {
    int from, to;
    double k, c;
    int oil = -1;
  };
  /// What the oil of a hydrodynamic coupling adds to its spring's torque: z' = stiffness w - decay z.
  struct Oil {
    int from, to;
    long double stiffness, decay;
  };
  std::vector<Oil> oils;
  std::map<std::string, Shaft> shafts;
  std::map<std::string, std::pair<int, int>> bodies;  // first and last node
  std::string fault;
};

double Number(const Value& table, const char* key, double fallback) {
  const Value* value = table.Find(key);
  return value != nullptr && value->is_number() ? value->number() : fallback;
}

std::vector<std::string> Names(const Value& value) {
  std::vector<std::string> names;
  if (value.is_string()) return {value.string()};
  for (const Value& item : value.array()) names.push_back(item.string());
  return names;
}

const Value& Section(const Value& table, const char* key) {
  static const Value empty;
  const Value* found = table.Find(key);
  return found != nullptr ? *found : empty;
}

void AddSpring(Line& line, int a, int b, long double k, long double c) {
  line.K(a, a) += k;
  line.C(a, a) += c;
  if (b < 0) return;
  line.K(b, b) += k;
  line.K(a, b) -= k;
  line.K(b, a) -= k;
  line.C(b, b) += c;
  line.C(a, b) -= c;
  line.C(b, a) -= c;
}

int End(const Line& line, std::string name, bool first) {
  bool right = first;
  for (const auto& [suffix, is_right] : {std::pair<std::string, bool>{".left", false}, {".right", true}}) {
    if (!name.ends_with(suffix)) continue;
    name.resize(name.size() - suffix.size());
    right = is_right;
  }
  const auto& [left_end, right_end] = line.bodies.at(name);
  return right ? right_end : left_end;
}

Line ReadLine(const Value& scenario, const std::vector<std::string>& inputs) {
  Line line;
  const Value& plant = Section(scenario, "plant");
  if (Number(plant, "initial_speed_rad_per_s", 0.0) != 0.0) line.fault = "the line turns at t = 0";
  if (Number(plant, "initial_angle_rad", 0.0) != 0.0) line.fault = "the line is turned at t = 0";
  for (const auto& [name, rotor, where] : Section(plant, "rotor").table()) {
    const int slices = static_cast<int>(Number(rotor, "slices", 100));
    line.bodies[name] = {static_cast<int>(line.inertia.size()), static_cast<int>(line.inertia.size()) + slices - 1};
    for (int i = 0; i < slices; ++i)
      line.inertia.push_back(static_cast<long double>(Number(rotor, "inertia_kg_m2", 0)) / slices);
  }
  for (const auto& [name, inertia, where] : Section(plant, "inertia").table()) {
    line.bodies[name] = {static_cast<int>(line.inertia.size()), static_cast<int>(line.inertia.size())};
    line.inertia.push_back(inertia.number());
  }
  const auto n = static_cast<Eigen::Index>(line.inertia.size());
  line.K = line.C = Matrix::Zero(n, n);
  line.W = Matrix::Zero(n, static_cast<Eigen::Index>(inputs.size()));
  for (const auto& [name, rotor, where] : Section(plant, "rotor").table()) {
    const auto [first, last] = line.bodies[name];
    const long double parts = last - first;
    for (int i = first; i < last; ++i) {
      AddSpring(line, i, i + 1, parts * Number(rotor, "stiffness_Nm_per_rad", 0),
                parts * Number(rotor, "damping_Nms_per_rad", 0));
    }
  }
  for (const auto& [name, shaft, where] : Section(plant, "shaft").table()) {
    const Value* law = shaft.Find("law");
    const std::string law_name = law != nullptr ? law->string() : "spring_damper";
    const bool oil = law_name == "oil_coupling";
    if (!oil && law_name != "spring_damper" && law_name != "kelvin_voigt") {
      line.fault = fmt::format("shaft \"{}\" has the law {}", name, law_name);
      continue;
    }
    if (Number(shaft, "initial_twist_rad", 0.0) != 0.0) line.fault = fmt::format("shaft \"{}\" starts twisted", name);
    if (Number(shaft, "drift", 0.0) != 0.0) line.fault = fmt::format("shaft \"{}\" changes with time", name);
    const std::vector<std::string> between = Names(*shaft.Find("between"));
    Line::Shaft one{End(line, between[0], true), End(line, between[1], false), Number(shaft, "stiffness_Nm_per_rad", 0),
                    Number(shaft, "damping_Nms_per_rad", 0)};
    if (oil) {
      one.oil = static_cast<int>(line.oils.size());
      line.oils.push_back(
          {one.from, one.to,
           static_cast<long double>(Number(shaft, "k_p_m3", 0)) * Number(shaft, "kappa_w_Pa_per_rad", 0),
           Number(shaft, "kappa_p_per_s", 0)});
    }
    AddSpring(line, one.from, one.to, one.k, one.c);
    line.shafts[name] = one;
  }
  for (const auto& [name, load, where] : Section(plant, "load").table()) {
    if (load.Find("law")->string() != "viscous") {
      line.fault = fmt::format("load \"{}\" has the law {}", name, load.Find("law")->string());
      continue;
    }
    const auto [first, last] = line.bodies.at(load.Find("on")->string());
    for (int i = first; i <= last; ++i)
      AddSpring(line, i, -1, 0.0L, static_cast<long double>(Number(load, "b_Nms_per_rad", 0)) / (last - first + 1));
  }
  for (std::size_t j = 0; j < inputs.size(); ++j) {
    const Value& input = *Section(scenario, "input").Find(inputs[j]);
    if (input.Find("actuator") != nullptr && !input.Find("actuator")->array().empty()) {
      line.fault = fmt::format("input \"{}\" has an actuator", inputs[j]);
    }
    for (const std::string& port : Names(*input.Find("to"))) {
      const Value* torque = Section(plant, "torque").Find(port.substr(port.find('.') + 1));
      if (torque == nullptr) {
        line.fault = fmt::format("input \"{}\" drives no torque entry of the plant", inputs[j]);
        continue;
      }
      std::vector<int> nodes;
      for (const std::string& name : Names(*torque->Find("on"))) {
        auto [first, last] = line.bodies.at(name);
        if (const Value* slices = torque->Find("slices")) {
          last = first + static_cast<int>(slices->array()[1].integer()) - 1;
          first += static_cast<int>(slices->array()[0].integer()) - 1;
        }
        for (int i = first; i <= last; ++i) nodes.push_back(i);
      }
      long double sum = 0.0L;
      for (const int node : nodes) sum += line.inertia[node];
      for (const int node : nodes) line.W(node, j) += Number(*torque, "gain", 1.0) * line.inertia[node] / sum;
    }
  }
  return line;
}

/// The row over (angle of node 0, angles of the others relative to it, speeds, torques of oils) of "plant.k4.torque",
/// "plant.I1.left.speed", ...; a fault when it is none of these.
Eigen::VectorXd OutputRow(const Line& line, const std::string& of, std::string& fault) {
  const auto n = static_cast<Eigen::Index>(line.inertia.size());
  Eigen::VectorXd row = Eigen::VectorXd::Zero(2 * n + static_cast<Eigen::Index>(line.oils.size()));
  const std::size_t first = of.find('.'), last = of.rfind('.');
  const std::string name = last > first ? of.substr(first + 1, last - first - 1) : "", quantity = of.substr(last + 1);
  if (const auto shaft = line.shafts.find(name); shaft != line.shafts.end()) {
    const double k = quantity == "torque" ? shaft->second.k : quantity == "twist" ? 1.0 : 0.0;
    const double c = quantity == "torque" ? shaft->second.c : quantity == "rate" ? 1.0 : 0.0;
    if (shaft->second.from > 0) row[shaft->second.from] = k;
    if (shaft->second.to > 0) row[shaft->second.to] = -k;
    row[n + shaft->second.from] = c;
    row[n + shaft->second.to] = -c;
    if (shaft->second.oil >= 0 && quantity == "torque") row[2 * n + shaft->second.oil] = 1.0;
  } else if (line.bodies.contains(name.substr(0, name.find('.')))) {
    row[(quantity == "speed" ? n : 0) + End(line, name, false)] = 1.0;
    if (quantity == "angle") row[0] = 1.0;
  } else {
    fault = fmt::format("\"{}\" is no signal of the drive line", of);
  }
  return row;
}

}  // namespace

Result<Answer> HeldInputExponential(const Question& question) {
  const auto refuse = [](const std::string& why) {
    return Failure{.message = "does not apply: " + why, .signal = "oracle held_input_exponential", .exit_code = 2};
  };
  const Value& plant = Section(question.scenario, "plant");
  const Value* type = plant.Find("type");
  if (type == nullptr || type->string() != "drive_line") return refuse("the plant is no drive line");
  for (const char* section : {"part", "control"}) {
    if (question.scenario.Find(section) != nullptr) return refuse(fmt::format("the scenario has [{}]", section));
  }
  std::vector<std::string> names;
  for (const auto& [name, values] : question.inputs) names.push_back(name);
  const Line line = ReadLine(question.scenario, names);
  if (!line.fault.empty()) return refuse(line.fault);
  const auto n = static_cast<Eigen::Index>(line.inertia.size()), m = line.W.cols();
  const auto oils = static_cast<Eigen::Index>(line.oils.size()), states = 2 * n + oils;
  std::vector<Eigen::VectorXd> rows;
  for (const std::string& name : question.outputs) {
    const Value& output = *Section(question.scenario, "output").Find(name);
    if (output.Find("sensor") != nullptr) return refuse(fmt::format("output \"{}\" has a sensor", name));
    std::string fault;
    rows.push_back(OutputRow(line, output.Find("of")->string(), fault));
    if (!fault.empty()) return refuse(fault);
  }
  if (question.time.empty()) return Answer{};

  // State (scale angles, w): with scale near the fastest frequency the matrix is balanced and needs few squarings. The
  // angles are relative to node 0, so that the turning of the whole line costs the twists no digits; nothing holds the
  // line to the ground (K 1 = 0), so the angle of node 0 acts on nothing.
  Eigen::Matrix<long double, Eigen::Dynamic, 1> inverse(n);
  for (Eigen::Index i = 0; i < n; ++i) inverse[i] = 1.0L / line.inertia[i];
  long double scale = 1.0L;
  for (Eigen::Index i = 0; i < n; ++i) scale = std::max(scale, std::sqrt(2.0L * line.K(i, i) * inverse[i]));
  const long double period = question.time.size() > 1 ? (question.time.back() - question.time.front()) /
                                                            static_cast<long double>(question.time.size() - 1)
                                                      : 1.0L;
  Matrix generator = Matrix::Zero(states + m, states + m);
  generator.block(0, n, n, n).diagonal().setConstant(scale);
  generator.block(1, n, n - 1, 1).setConstant(-scale);
  generator.block(n, 1, n, n - 1) = -(inverse.asDiagonal() * line.K).rightCols(n - 1) / scale;
  generator.block(n, n, n, n) = -(inverse.asDiagonal() * line.C);
  generator.block(n, states, n, m) = inverse.asDiagonal() * line.W;
  std::vector<long double> unit;  // of each oil's torque: what a speed of 1 rad/s and its inertia would make of it
  for (Eigen::Index j = 0; j < oils; ++j) {
    const Line::Oil& oil = line.oils[j];
    unit.push_back(std::sqrt(oil.stiffness * std::min(line.inertia[oil.from], line.inertia[oil.to])));
    generator(2 * n + j, 2 * n + j) = -oil.decay;
    generator(2 * n + j, n + oil.from) = oil.stiffness / unit[j];
    generator(2 * n + j, n + oil.to) = -oil.stiffness / unit[j];
    generator(n + oil.from, 2 * n + j) = -unit[j] * inverse[oil.from];
    generator(n + oil.to, 2 * n + j) = unit[j] * inverse[oil.to];
  }
  const Matrix exponential = (generator * period).eval().exp();
  const Eigen::MatrixXd step = exponential.topRows(states).cast<double>();

  const std::size_t ticks = question.time.size();
  Answer answer;
  std::vector<std::vector<double>*> columns;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r].head(n) /= static_cast<double>(scale);
    for (Eigen::Index j = 0; j < oils; ++j) rows[r][2 * n + j] *= static_cast<double>(unit[j]);
    columns.push_back(&answer[question.outputs[r]]);
    columns.back()->reserve(ticks);
  }
  Eigen::VectorXd extended = Eigen::VectorXd::Zero(states + m), next(states);
  for (std::size_t k = 0; k < ticks; ++k) {
    for (std::size_t r = 0; r < rows.size(); ++r) columns[r]->push_back(rows[r].dot(extended.head(states)));
    for (Eigen::Index j = 0; j < m; ++j) extended[states + j] = question.inputs.at(names[j])[k];
    next.noalias() = step * extended;
    extended.head(states) = next;
  }
  return answer;
}

const std::map<std::string, Oracle, std::less<>>& All() {
  static const std::map<std::string, Oracle, std::less<>> oracles = {{"held_input_exponential", HeldInputExponential},
                                                                     {"piecewise_exponential", PiecewiseExponential},
                                                                     {"pressure_extrapolation", PressureExtrapolation}};
  return oracles;
}

}  // namespace dynoproof::oracles
