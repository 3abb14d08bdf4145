#include "plugins/plant/drive_line/drive_line.h"

#include <cassert>
#include <cmath>

#include "linear/energy_coordinates.h"

namespace dynoproof {

using mechanics::kGround;

PluginInfo DriveLine::Info() {
  return {"plant",
          "drive_line",
          "inertias, soft rotors, shafts and loads joined to a (branched) drive line",
          "I_i dw_i/dt = sum of torques; a shaft transmits T = k (phi_a - phi_b) + c (w_a - w_b) or what its law says",
          "thesis (2.8)-(2.12), (2.94), Figs. 2.12, 2.26, 2.31",
          {}};
}

double DriveLine::Angle(std::span<const double> states, int node) const {
  const int n = linear_.size();
  return states[n - 1] + (node == 0 ? 0.0 : states[node - 1]);
}

double DriveLine::Speed(std::span<const double> states, int node) const { return states[linear_.size() + node]; }

double DriveLine::Evaluate(const OutputTerm& term, std::span<const double> states) const {
  using enum OutputTerm::Kind;
  if (term.kind == kAngle) return Angle(states, term.index);
  if (term.kind == kSpeed) return Speed(states, term.index);
  const mechanics::Edge& edge = linear_.edges[term.index];
  const auto relative = [states](int node) { return node == 0 ? 0.0 : states[node - 1]; };
  const double twist = edge.to == kGround ? Angle(states, edge.from) : relative(edge.from) - relative(edge.to);
  const double rate = Speed(states, edge.from) - (edge.to == kGround ? 0.0 : Speed(states, edge.to));
  if (term.kind == kTwist) return twist;
  if (term.kind == kRate) return rate;
  return edge.stiffness * twist + edge.damping * rate;
}

LawView DriveLine::MakeView(const View& view, const Element& element, double holding) const {
  double twist = 0.0, rate = 0.0, sum = 0.0;
  for (const auto& [node, weight] : element.weights) {
    twist += weight * (node == 0 ? 0.0 : view.states[node - 1]);
    rate += weight * Speed(view.states, node);
    sum += weight;
  }
  // Between two nodes the common angle cancels; it is left out instead of being subtracted from itself.
  if (element.weights.size() != 2 || sum != 0.0) twist += sum * view.states[linear_.size() - 1];
  const Layout& own = element.law->layout();
  return {view.time_s,
          twist,
          rate,
          holding,
          view.states.subspan(element.state, own.states.size()),
          view.modes.subspan(element.mode, own.modes)};
}

void DriveLine::Torques(const View& view, std::span<double> torque, std::span<ElementTorque> elements) const {
  std::fill(torque.begin(), torque.end(), 0.0);
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    for (const auto& [node, weight] : inputs_[i]) torque[node] += weight * view.inputs[i];
  }
  const int n = linear_.size();
  const double* angle = view.states.data() - 1;  // of node i >= 1, relative to node 0
  const double* speed = view.states.data() + n;
  for (const Spring& spring : springs_) {
    const double from = spring.from == 0 ? 0.0 : angle[spring.from];
    if (spring.to == kGround) {
      torque[spring.from] -= spring.stiffness * (from + view.states[n - 1]) + spring.damping * speed[spring.from];
      continue;
    }
    const double to = spring.to == 0 ? 0.0 : angle[spring.to];
    const double transmitted =
        spring.stiffness * (from - to) + spring.damping * (speed[spring.from] - speed[spring.to]);
    torque[spring.from] -= transmitted;
    torque[spring.to] += transmitted;
  }
  int sticks = 0;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    elements[e] = {};
    Transmit(view, e, torque, elements[e]);
    sticks += elements_[e].law->sticks() ? 1 : 0;
  }
  // What one stick holds depends on what the others hold: they are asked in turn until none changes, which is Gauss and
  // Seidel's method for a positive definite matrix, projected onto what each can hold at most.
  constexpr int kMostRounds = 1000;
  for (int round = 0; sticks > 1 && round < kMostRounds; ++round) {
    bool changed = false;
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      if (elements_[e].law->sticks()) changed = Transmit(view, e, torque, elements[e]) || changed;
    }
    if (!changed) break;
  }
}

bool DriveLine::Transmit(const View& view, std::size_t index, std::span<double> torque,
                         ElementTorque& transmitted) const {
  constexpr double kRoundOff = 1e-13;
  const Element& element = elements_[index];
  double holding = 0.0;
  if (element.law->sticks()) {
    for (const auto& [node, weight] : element.weights) holding += weight * torque[node] / linear_.nodes[node].inertia;
    holding = holding / element.mobility + transmitted.beyond_linear;  // as if it transmitted nothing yet
  }
  const LawView law_view = MakeView(view, element, holding);
  const double now = element.law->Torque(law_view) - element.linear.stiffness * law_view.twist -
                     element.linear.damping * law_view.rate;
  transmitted.holding = holding;
  const double more = now - transmitted.beyond_linear;
  if (std::abs(more) <= kRoundOff * (std::abs(now) + std::abs(holding))) return false;
  for (const auto& [node, weight] : element.weights) torque[node] -= weight * more;
  transmitted.beyond_linear = now;
  return true;
}

namespace {

/// Scratch memory of the calling thread: components are const, and the reference solver may take its time once.
template <class T>
std::span<T> Scratch(std::size_t size) {
  thread_local std::vector<T> memory;
  if (memory.size() < size) memory.resize(size);
  return {memory.data(), size};
}

}  // namespace

void DriveLine::Start(std::span<const double>, std::span<double> states, std::span<int> modes) const {
  const int n = linear_.size();
  for (int i = 1; i < n; ++i) states[i - 1] = initial_angles_[i];
  states[n - 1] = initial_angles_[0];
  for (int i = 0; i < n; ++i) states[n + i] = initial_speeds_[i];
  for (const Element& element : elements_) {
    const LawView view = MakeView({0.0, {}, states, modes}, element, 0.0);
    const Layout& own = element.law->layout();
    element.law->Start(view.twist, view.rate, states.subspan(element.state, own.states.size()),
                       modes.subspan(element.mode, own.modes));
  }
}

bool DriveLine::FeedsThrough(int, int out) const {
  const int element = readings_[out].element;
  return element >= 0 && elements_[element].law->sticks();
}

void DriveLine::Output(const View& view, std::span<double> outputs) const {
  const std::span<ElementTorque> elements = Scratch<ElementTorque>(elements_.size());
  if (!elements_.empty()) Torques(view, Scratch<double>(linear_.nodes.size()), elements);
  for (std::size_t i = 0; i < readings_.size(); ++i) {
    double sum = readings_[i].element < 0 ? 0.0 : elements[readings_[i].element].beyond_linear;
    for (const OutputTerm& term : readings_[i].terms) sum += Evaluate(term, view.states);
    outputs[i] = sum;
  }
}

void DriveLine::Derivative(const View& view, std::span<double> rates) const {
  const int n = linear_.size();
  const std::span<double> torque = rates.subspan(n, n);
  const std::span<ElementTorque> elements = Scratch<ElementTorque>(elements_.size());
  Torques(view, torque, elements);
  for (int i = 0; i < n; ++i) torque[i] *= inverse_inertia_[i];
  for (int i = 1; i < n; ++i) rates[i - 1] = view.states[n + i] - view.states[n];
  rates[n - 1] = view.states[n];
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    const std::size_t own = element.law->layout().states.size();
    if (own > 0)
      element.law->Derivative(MakeView(view, element, elements[e].holding), rates.subspan(element.state, own));
  }
}

void DriveLine::Guards(const View& view, std::span<double> values) const {
  const std::span<ElementTorque> elements = Scratch<ElementTorque>(elements_.size());
  Torques(view, Scratch<double>(linear_.nodes.size()), elements);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    const int own = element.law->layout().guards;
    if (own > 0) element.law->Guards(MakeView(view, element, elements[e].holding), values.subspan(element.guard, own));
  }
}

bool DriveLine::IsOfAMode(int guard) const {
  for (const Element& element : elements_) {
    const Layout& own = element.law->layout();
    if (guard >= element.guard && guard < element.guard + own.guards) return own.modes > 0;
  }
  return false;
}

void DriveLine::OnEvent(const View& view, int guard, std::span<double> states, std::span<int> modes) const {
  const std::span<ElementTorque> elements = Scratch<ElementTorque>(elements_.size());
  Torques(view, Scratch<double>(linear_.nodes.size()), elements);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    const Layout& own = element.law->layout();
    const int local = guard - element.guard;
    if (local < 0 || local >= own.guards) continue;
    element.law->OnEvent(MakeView(view, element, elements[e].holding), local,
                         states.subspan(element.state, own.states.size()), modes.subspan(element.mode, own.modes));
  }
}

std::vector<double> DriveLine::TorqueWeights(int input) const {
  std::vector<double> weights(linear_.nodes.size(), 0.0);
  for (const auto& [node, weight] : inputs_[input]) weights[node] += weight;
  return weights;
}

std::vector<OutputTerm> DriveLine::OutputTerms(int output) const { return readings_[output].terms; }

void DriveLine::Finish() {
  for (const mechanics::Node& node : linear_.nodes) inverse_inertia_.push_back(1.0 / node.inertia);
  for (const mechanics::Edge& edge : linear_.edges) {
    if (edge.stiffness != 0.0 || edge.damping != 0.0) {
      springs_.push_back({edge.from, edge.to, edge.stiffness, edge.damping});
    }
  }
}

std::unique_ptr<LinearPart> DriveLine::MakeLinearPart() const {
  const int n = linear_.size();
  const int inputs = static_cast<int>(inputs_.size()), elements = static_cast<int>(elements_.size());
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(n, inputs + elements);
  for (int i = 0; i < inputs; ++i) {
    for (const auto& [node, weight] : inputs_[i]) weights(node, i) += weight;
  }
  for (int e = 0; e < elements; ++e) {
    for (const auto& [node, weight] : elements_[e].weights) weights(node, inputs + e) -= weight;
  }
  mechanics::Kept kept{rotor_modes_, Eigen::MatrixXd(n, 2)};
  kept.shapes << Eigen::Map<const Eigen::VectorXd>(initial_angles_.data(), n),
      Eigen::Map<const Eigen::VectorXd>(initial_speeds_.data(), n);
  kept.shapes(0, 0) = 0.0;  // the angle of all, which the others are relative to
  auto built = mechanics::EnergyCoordinates::Build(linear_, weights, kept);
  assert(built.ok());  // the builder has checked all numbers
  const mechanics::EnergyCoordinates& coordinates = *built;

  const auto zero = [&coordinates] {
    return mechanics::OutputRow{Eigen::RowVectorXd::Zero(coordinates.states()),
                                Eigen::RowVectorXd::Zero(coordinates.integrators())};
  };
  std::vector<mechanics::OutputRow> rows;
  for (const Reading& reading : readings_) {
    mechanics::OutputRow sum = zero();
    for (const OutputTerm& term : reading.terms) {
      using enum OutputTerm::Kind;
      const mechanics::OutputRow row = term.kind == kAngle   ? coordinates.Angle(term.index)
                                       : term.kind == kSpeed ? coordinates.Speed(term.index)
                                       : term.kind == kTwist ? coordinates.EdgeTwist(term.index)
                                       : term.kind == kRate  ? coordinates.EdgeTwistRate(term.index)
                                                             : coordinates.EdgeTorque(term.index);
      sum.c += row.c;
      sum.e += row.e;
    }
    rows.push_back(std::move(sum));
  }
  for (const Element& element : elements_) {
    const auto& w = element.weights;
    if (w.size() == 2 && w[0].second == -w[1].second) {  // a shaft: no rigid angle of its own part in the twist
      rows.push_back(coordinates.Twist(w[0].first, w[1].first));
      rows.push_back(coordinates.TwistRate(w[0].first, w[1].first));
      continue;
    }
    mechanics::OutputRow twist = zero(), rate = zero();
    for (const auto& [node, weight] : w) {
      const mechanics::OutputRow angle = coordinates.Angle(node), speed = coordinates.Speed(node);
      twist.c += weight * angle.c;
      twist.e += weight * angle.e;
      rate.c += weight * speed.c;
      rate.e += weight * speed.e;
    }
    rows.push_back(std::move(twist));
    rows.push_back(std::move(rate));
  }

  auto made = std::make_unique<LinearPart>();
  LinearPart& part = *made;
  part.system = coordinates.System(rows);
  const Eigen::VectorXd scale = TakeUpLinearStates(part.system);
  const int own = static_cast<int>(scale.size()), mechanical = coordinates.states();
  const int taken = static_cast<int>(readings_.size());
  int first_channel = 0;
  for (const Element& element : elements_) {
    if (element.linear_states) {
      ++first_channel;
      continue;
    }
    part.channels.push_back({element.law.get(), element.state, element.mode, element.mobility, element.linear});
  }
  for (int r = 0; r < taken; ++r) {
    if (readings_[r].element >= first_channel) part.system.D(r, inputs + readings_[r].element - first_channel) = 1.0;
  }

  // s = (relative angles, angle of node 0, speeds, own states) <-> (x, p), column by column; own states differ by
  // scale.
  part.x_from_state.setZero(mechanical + own, 2 * n + own);
  part.p_from_state.setZero(coordinates.integrators(), 2 * n + own);
  part.state_from_x.setZero(2 * n + own, mechanical + own);
  part.state_from_p.setZero(2 * n + own, coordinates.integrators());
  part.x_from_state.bottomRightCorner(own, own) = scale.cwiseInverse().asDiagonal();
  part.state_from_x.bottomRightCorner(own, own) = scale.asDiagonal();
  // One column a state: the angle of node j + 1 beside node 0's, then that of all, then the speeds.
  Eigen::MatrixXd angles = Eigen::MatrixXd::Zero(n, 2 * n), speeds = angles, x, p;
  angles.bottomLeftCorner(n - 1, n - 1).setIdentity();
  angles.col(n - 1).setOnes();
  speeds.rightCols(n).setIdentity();
  coordinates.FromPhysical(angles, speeds, x, p);
  part.x_from_state.topLeftCorner(mechanical, 2 * n) = x;
  part.p_from_state.leftCols(2 * n) = p;
  // And back: one column a coordinate of x, then of p.
  const int integrators = coordinates.integrators();
  x.setZero(mechanical, mechanical + integrators);
  p.setZero(integrators, mechanical + integrators);
  x.leftCols(mechanical).setIdentity();
  p.rightCols(integrators).setIdentity();
  coordinates.ToPhysical(x, p, angles, speeds);
  Eigen::MatrixXd states(2 * n, x.cols());
  states.topRows(n - 1) = angles.bottomRows(n - 1).rowwise() - angles.row(0);
  states.row(n - 1) = angles.row(0);
  states.bottomRows(n) = speeds;
  part.state_from_x.topLeftCorner(2 * n, mechanical) = states.leftCols(mechanical);
  part.state_from_p.topRows(2 * n) = states.rightCols(integrators);
  return made;
}

Eigen::VectorXd DriveLine::TakeUpLinearStates(mechanics::LinearSystem& system) const {
  const mechanics::LinearSystem bare = system;
  const int inputs = static_cast<int>(inputs_.size()), readings = static_cast<int>(readings_.size());
  int taken = 0, own = 0;
  for (const Element& element : elements_) {
    if (!element.linear_states) break;
    ++taken;
    own += static_cast<int>(element.linear_states->c.size());
  }
  const int n = bare.states(), channels = static_cast<int>(elements_.size()) - taken;
  const int rows = readings + 2 * channels;
  system.A.setZero(n + own, n + own);
  system.A.topLeftCorner(n, n) = bare.A;
  system.B.setZero(n + own, inputs + channels);
  system.B.topLeftCorner(n, inputs) = bare.B.leftCols(inputs);
  system.B.topRightCorner(n, channels) = bare.B.rightCols(channels);
  system.P.setZero(bare.integrators(), n + own);
  system.P.leftCols(n) = bare.P;
  system.C.setZero(rows, n + own);
  system.C.topLeftCorner(readings, n) = bare.C.topRows(readings);
  system.C.bottomLeftCorner(2 * channels, n) = bare.C.bottomRows(2 * channels);
  system.E.resize(rows, bare.integrators());
  system.E << bare.E.topRows(readings), bare.E.bottomRows(2 * channels);
  system.D.setZero(rows, inputs + channels);
  Eigen::VectorXd scale(own);
  for (int e = 0, at = n; e < taken; ++e) {
    const LinearStates& z = *elements_[e].linear_states;
    const auto count = static_cast<int>(z.c.size());
    // z = s z~ with s^2 = |b_rate / c| weighs what the rate does to a state as what the state does to the rate: the
    // squares are energies as those of x.
    Eigen::VectorXd s(count);
    for (int j = 0; j < count; ++j) {
      const bool both = z.b_rate[j] != 0.0 && z.c[j] != 0.0;
      s[j] = both ? std::sqrt(std::abs(z.b_rate[j] / z.c[j])) : elements_[e].law->layout().states[j].nominal;
    }
    const Eigen::RowVectorXd c = z.c * s.asDiagonal();
    const int twist = readings + 2 * e;
    system.A.block(at, at, count, count) = s.cwiseInverse().asDiagonal() * z.A * s.asDiagonal();
    system.A.block(at, 0, count, n) =
        s.cwiseInverse().asDiagonal() * (z.b_twist * bare.C.row(twist) + z.b_rate * bare.C.row(twist + 1));
    system.A.block(0, at, n, count) = bare.B.col(inputs + e) * c;
    for (int r = 0; r < readings; ++r) {
      if (readings_[r].element == e) system.C.block(r, at, 1, count) = c;
    }
    scale.segment(at - n, count) = s;
    at += count;
  }
  return scale;
}

}  // namespace dynoproof
