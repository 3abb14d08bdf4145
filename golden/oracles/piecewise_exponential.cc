// A drive line with one shaft with play: between two changes of contact it is linear, so each piece is a matrix
// exponential; the changes are found by bisection over halved steps. The gap is written down here once more, from the
// balance at the end of the shaft: k (d - phi_b) + c (w - w_b) = c_f w_b while free.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <optional>
#include <unsupported/Eigen/MatrixFunctions>

#include "oracles/oracle.h"

namespace dynoproof::oracles {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Precise = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

struct Edge {
  std::string name;
  int from, to;
  double k, c;
};

struct Gap {
  std::string law;
  int from = -1, to = -1;
  double k = 0.0, c = 0.0, alpha = 0.0, c_f = 0.0;
  bool with_state() const { return law == "full_state_backlash"; }
};

struct Line {
  std::vector<std::string> names;
  std::vector<double> inertia;
  std::vector<Edge> edges;
  Gap gap;
  std::map<std::string, int> torques;  // entry -> node
  Vector start;                        // angles, speeds, angle at the gap
  std::string fault;

  int n() const { return static_cast<int>(inertia.size()); }
  int Node(const std::string& name) const {
    for (int i = 0; i < n(); ++i) {
      if (names[i] == name) return i;
    }
    return -1;
  }
};

double NumberOr(const Value& table, const char* key, double fallback) {
  const Value* value = table.Find(key);
  return value != nullptr && value->is_number() ? value->number() : fallback;
}

Line ReadLine(const Value& plant) {
  Line line;
  if (plant.Find("rotor") != nullptr || plant.Find("load") != nullptr)
    line.fault = "rotors and loads are left out here";
  for (const auto& [name, inertia, where] : plant.Find("inertia")->table()) {
    line.names.push_back(name);
    line.inertia.push_back(inertia.number());
  }
  const int n = line.n();
  std::vector<std::array<double, 3>> twists;
  for (const auto& [name, shaft, where] : plant.Find("shaft")->table()) {
    const Value::Array& between = shaft.Find("between")->array();
    const int from = line.Node(between[0].string()), to = line.Node(between[1].string());
    if (from < 0 || to < 0) {
      line.fault = fmt::format("shaft \"{}\" joins ends that are written in another way than by their name", name);
      return line;
    }
    twists.push_back({static_cast<double>(from), static_cast<double>(to), NumberOr(shaft, "initial_twist_rad", 0.0)});
    const Value* law = shaft.Find("law");
    const double k = NumberOr(shaft, "stiffness_Nm_per_rad", 0), c = NumberOr(shaft, "damping_Nms_per_rad", 0);
    if (law == nullptr || law->string() == "spring_damper") {
      line.edges.push_back({name, from, to, k, c});
    } else if (line.gap.from >= 0) {
      line.fault = "more than one shaft with a law of its own";
    } else {
      line.gap = {law->string(),
                  from,
                  to,
                  k,
                  c,
                  NumberOr(shaft, "half_gap_rad", 0),
                  NumberOr(shaft, "contact_free_damping_Nms_per_rad", 0)};
    }
  }
  if (NumberOr(plant, "initial_angle_rad", 0.0) != 0.0) line.fault = "the line is turned at t = 0";
  const Gap& gap = line.gap;
  const bool plane = gap.law == "phase_plane" || gap.law == "dead_zone" || gap.law == "revised_dead_zone";
  if (!gap.with_state() && !plane) line.fault = fmt::format("no piecewise linear law with play (\"{}\")", gap.law);
  for (const auto& [name, torque, where] : plant.Find("torque")->table()) {
    const Value* on = torque.Find("on");
    line.torques[name] = on != nullptr && on->is_string() ? line.Node(on->string()) : -1;
    if (line.torques[name] < 0) line.fault = fmt::format("torque \"{}\" acts on more than one inertia", name);
  }
  line.start = Vector::Zero(2 * n + 1);
  std::vector<bool> known(n);
  known[0] = true;
  for (int pass = 0; pass < n; ++pass) {
    for (const auto& [a, b, twist] : twists) {
      const int from = static_cast<int>(a), to = static_cast<int>(b);
      if (known[from] && !known[to]) line.start[to] = line.start[from] - twist;
      if (known[to] && !known[from]) line.start[from] = line.start[to] + twist;
      known[from] = known[to] = known[from] || known[to];
    }
  }
  line.start.segment(n, n).setConstant(NumberOr(plant, "initial_speed_rad_per_s", 0.0));
  if (gap.from >= 0) {
    line.start[2 * n] = std::clamp(line.start[gap.from] - line.start[gap.to], -gap.alpha, gap.alpha);
  }
  return line;
}

/// Rows over (angles relative to node 0, angle of node 0, speeds, phi_b, 1): the state of one piece.
class Pieces {
 public:
  Pieces(const Line& line, const std::vector<int>& inputs, double step_s)
      : line_(line), n_(line.n()), m_(static_cast<int>(inputs.size())), size_(2 * n_ + 2 + m_) {
    for (int side = -1; side <= 1; ++side) {
      Matrix a = Matrix::Zero(size_, size_);
      for (int i = 1; i < n_; ++i) {
        a(i, n_ + i) = 1.0;
        a(i, n_) = -1.0;
      }
      a(0, n_) = 1.0;
      for (const Edge& edge : line.edges) {
        Eigen::RowVectorXd torque = edge.k * Twist(edge.from, edge.to) + edge.c * Rate(edge.from, edge.to);
        AddTorque(a, edge.from, -torque);
        AddTorque(a, edge.to, torque);
      }
      const Eigen::RowVectorXd torque = GapTorque(side);
      AddTorque(a, line.gap.from, -torque);
      AddTorque(a, line.gap.to, torque);
      if (side == 0 && line.gap.with_state()) a.row(2 * n_) = FreeSpeed();
      for (int j = 0; j < m_; ++j) a(n_ + inputs[j], 2 * n_ + 2 + j) += 1.0 / line.inertia[inputs[j]];
      // Scaled angles: rows and columns of a then have like sizes, and the exponential needs few squarings.
      double scale = 1.0;
      for (const Edge& edge : line.edges) {
        scale = std::max(scale, std::sqrt(edge.k / std::min(line.inertia[edge.from], line.inertia[edge.to])));
      }
      Vector d = Vector::Ones(size_);
      d.head(n_).setConstant(scale);
      d[2 * n_] = scale;
      const Precise balanced = (d.asDiagonal() * a * d.cwiseInverse().asDiagonal()).cast<long double>();
      for (int j = 0; j < kHalvings; ++j) {
        const Precise e = (balanced * std::ldexp(static_cast<long double>(step_s), -j)).eval().exp();
        step_[side + 1].push_back(d.cwiseInverse().asDiagonal() * e.cast<double>() * d.asDiagonal());
      }
    }
  }

  static constexpr int kHalvings = 34;  // a tick of 1e-15 s: finer ones would be lost in the round-off of an angle
  const Matrix& Step(int side, int halving) const { return step_[side + 1][halving]; }
  int size() const { return size_; }

  Eigen::RowVectorXd Twist(int from, int to) const {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(size_);
    if (from > 0) row[from] += 1.0;
    if (to > 0) row[to] -= 1.0;
    return row;
  }
  Eigen::RowVectorXd Rate(int from, int to) const {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(size_);
    row[n_ + from] += 1.0;
    row[n_ + to] -= 1.0;
    return row;
  }
  Eigen::RowVectorXd GapTorque(int side) const {
    const Gap& g = line_.gap;
    if (side == 0) return g.with_state() ? Eigen::RowVectorXd(g.c_f * FreeSpeed()) : Eigen::RowVectorXd::Zero(size_);
    Eigen::RowVectorXd row = g.k * Twist(g.from, g.to) + g.c * Rate(g.from, g.to);
    row[2 * n_ + 1] -= side * g.k * g.alpha;
    return row;
  }

 private:
  Eigen::RowVectorXd FreeSpeed() const {
    const Gap& g = line_.gap;
    Eigen::RowVectorXd row = g.k * Twist(g.from, g.to) + g.c * Rate(g.from, g.to);
    row[2 * n_] -= g.k;
    return row / (g.c + g.c_f);
  }
  void AddTorque(Matrix& a, int node, const Eigen::RowVectorXd& torque) const {
    a.row(n_ + node) += torque / line_.inertia[node];
  }

  const Line& line_;
  int n_, m_, size_;
  std::array<std::vector<Matrix>, 3> step_;
};

/// A contact changes this far beyond its boundary, so that round-off does not undo it [rad].
constexpr double kSlack = 1e-13;

/// > 0 as long as the contact stays as it is.
double Stays(const Line& line, const Pieces& pieces, int side, const Vector& x) {
  const Gap& g = line.gap;
  const int n = line.n();
  const double d = pieces.Twist(g.from, g.to).dot(x), w = pieces.Rate(g.from, g.to).dot(x);
  if (g.with_state()) {
    return kSlack + (side == 0 ? g.alpha - std::abs(x[2 * n]) : side * (d - side * g.alpha + g.c / g.k * w));
  }
  const auto touches = [&](int s) {
    const double twist = s * d, rate = s * w;
    if (g.law == "dead_zone") return twist - g.alpha;
    if (g.law == "phase_plane" && rate > 0.0) {
      const double exponent = -(g.k / g.c) * (twist + g.alpha) / rate - 1.0;
      return twist - g.alpha + g.c / g.k * rate * std::exp(std::min(0.0, exponent));
    }
    return twist - g.alpha + g.c / g.k * rate;
  };
  return kSlack + (side == 0 ? -std::max(touches(1), touches(-1)) : touches(side));
}

}  // namespace

Result<Answer> PiecewiseExponential(const Question& question) {
  const auto refuse = [](const std::string& why) {
    return Failure{.message = "does not apply: " + why, .signal = "oracle piecewise_exponential", .exit_code = 2};
  };
  const Value* plant = question.scenario.Find("plant");
  const Value* type = plant != nullptr ? plant->Find("type") : nullptr;
  if (type == nullptr || type->string() != "drive_line") return refuse("the plant is no drive line");
  for (const char* section : {"part", "control"}) {
    if (question.scenario.Find(section) != nullptr) return refuse(fmt::format("the scenario has [{}]", section));
  }
  for (const char* section : {"inertia", "shaft", "torque"}) {
    if (plant->Find(section) == nullptr) return refuse(fmt::format("the plant has no {}", section));
  }
  const Line line = ReadLine(*plant);
  if (!line.fault.empty()) return refuse(line.fault);
  const int n = line.n();
  std::vector<int> nodes;
  std::vector<std::span<const double>> commands;
  for (const auto& [name, values] : question.inputs) {
    const Value& input = *question.scenario.Find("input")->Find(name);
    const Value* to = input.Find("to");
    if (!to->is_string() || input.Find("actuator") != nullptr)
      return refuse(fmt::format("input \"{}\" has an actuator, or drives more than one port", name));
    nodes.push_back(line.torques.at(to->string().substr(to->string().find('.') + 1)));
    commands.push_back(values);
  }
  for (const std::string& name : question.outputs) {
    if (question.scenario.Find("output")->Find(name)->Find("sensor") != nullptr)
      return refuse(fmt::format("output \"{}\" has a sensor", name));
  }
  if (question.time.empty()) return Answer{};
  const double period_s =
      (question.time.back() - question.time.front()) / static_cast<double>(question.time.size() - 1);
  // Contact may last for less than a period: eight looks at it.
  constexpr int kLooks = 8;
  const Pieces pieces(line, nodes, period_s / kLooks);

  struct Wanted {
    Eigen::RowVectorXd row;
    bool gap_torque;
  };
  std::vector<Wanted> wanted;
  for (const std::string& name : question.outputs) {
    const Value& output = *question.scenario.Find("output")->Find(name);
    const std::string of = output.Find("of")->string();
    const std::size_t first = of.find('.'), last = of.rfind('.');
    const std::string part = of.substr(first + 1, last - first - 1), quantity = of.substr(last + 1);
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(pieces.size());
    const int node = line.Node(part);
    int from = line.gap.from, to = line.gap.to;
    double k = 0.0, c = 0.0;
    bool shaft = node < 0;
    for (const Edge& edge : line.edges) {
      if (edge.name != part) continue;
      from = edge.from;
      to = edge.to;
      k = edge.k;
      c = edge.c;
    }
    if (node >= 0 && quantity == "speed") row[n + node] = 1.0;
    if (node >= 0 && quantity == "angle") {
      row[0] = 1.0;
      if (node > 0) row[node] = 1.0;
    }
    if (shaft && quantity == "twist") row = pieces.Twist(from, to);
    if (shaft && quantity == "rate") row = pieces.Rate(from, to);
    if (shaft && quantity == "torque") row = k * pieces.Twist(from, to) + c * pieces.Rate(from, to);
    wanted.push_back({row, shaft && quantity == "torque" && k == 0.0});
  }

  // The state of the pieces: angles relative to node 0, its own angle first.
  Vector x = Vector::Zero(pieces.size());
  x[0] = line.start[0];
  for (int i = 1; i < n; ++i) x[i] = line.start[i] - line.start[0];
  x.segment(n, n) = line.start.segment(n, n);
  x[2 * n] = line.start[2 * n];
  x[2 * n + 1] = 1.0;
  int side = 0;
  for (const int s : {-1, 1}) {
    const double d = pieces.Twist(line.gap.from, line.gap.to).dot(x);
    if (s * d > line.gap.alpha) side = s;
  }
  Answer answer;
  for (const std::string& name : question.outputs) answer[name].reserve(question.time.size());
  for (std::size_t k = 0; k < question.time.size(); ++k) {
    for (std::size_t r = 0; r < wanted.size(); ++r) {
      answer[question.outputs[r]].push_back(wanted[r].gap_torque ? pieces.GapTorque(side).dot(x)
                                                                 : wanted[r].row.dot(x));
    }
    for (std::size_t j = 0; j < commands.size(); ++j) x[2 * n + 2 + static_cast<Eigen::Index>(j)] = commands[j][k];
    for (int look = 0; look < kLooks; ++look) {
      // A look is 2^kHalvings ticks of its own; `left` counts them down.
      std::uint64_t left = std::uint64_t{1} << (Pieces::kHalvings - 1);
      for (int changes = 0; left > 0; ++changes) {
        if (changes > 1000) return refuse("contact changes without end");
        // The longest steps first, each only if the contact stays: what is left over is the tick of the change.
        for (int j = 0; j < Pieces::kHalvings; ++j) {
          const std::uint64_t ticks = std::uint64_t{1} << (Pieces::kHalvings - 1 - j);
          if (left < ticks) continue;
          const Vector next = pieces.Step(side, j) * x;
          if (Stays(line, pieces, side, next) <= 0.0) continue;
          x = next;
          left -= ticks;
        }
        if (left == 0) break;
        x = (pieces.Step(side, Pieces::kHalvings - 1) * x).eval();  // over the boundary
        --left;
        if (Stays(line, pieces, side, x) > 0.0) continue;
        if (side != 0) {
          side = 0;
        } else {
          const double at = line.gap.with_state() ? x[2 * n] : pieces.Twist(line.gap.from, line.gap.to).dot(x);
          side = at > 0.0 ? 1 : -1;
          if (line.gap.with_state()) x[2 * n] = side * line.gap.alpha;
        }
      }
    }
  }
  return answer;
}

}  // namespace dynoproof::oracles
