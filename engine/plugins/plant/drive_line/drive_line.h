// A drive line: inertias, soft rotors, shafts, loads and torque entries by name (thesis Sec. 2.2, 2.3), or the same of bodies
// that slide: masses, springs, forces. The names here are those of rotation; model/motion.h has the others.
//
// States: angle of every node but the first relative to the first, angle of the first, speed of every node, then the
// states of the laws. Twists are differences of relative angles, so a line that turns for hours loses no digits.
// Inputs: one torque per [torque.NAME]. Outputs: <shaft>.torque|twist|rate, <load>.torque, <inertia>.angle|speed,
// <rotor>.left|right.angle|speed.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "linear/network.h"
#include "model/component.h"
#include "model/law.h"
#include "model/linear_part.h"
#include "model/motion.h"
#include "model/registry.h"

namespace dynoproof {

class DriveLine : public Component {
 public:
  struct Rotor {
    double inertia_kg_m2 = 0.0, stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0;
    int slices = 100;
    void Visit(auto& v) {
      v.Required("inertia_kg_m2", inertia_kg_m2, Positive(), "inertia of the whole rotor");
      v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, Positive(), "stiffness from end to end (k_im)");
      v.Optional("damping_Nms_per_rad", damping_Nms_per_rad, NonNegative(), "damping from end to end (c_im)");
      v.Optional("slices", slices, Between(2, 1000), "number N of equal slices, (2.94)");
    }
  };
  struct Torque {
    std::vector<std::string> on;
    std::vector<int> slices;
    double gain = 1.0;
    void Visit(auto& v) {
      v.Required("on", on, Any(), "the inertias and rotors it acts on, in proportion to their inertia, (2.91)");
      v.Optional("slices", slices, Between(1, 1000), "first and last slice that it touches, of a rotor");
      v.Optional("gain", gain, Any(), "factor; -1 makes a positive torque brake");
    }
  };
  struct Run {
    std::vector<std::string> inertias;
    void Visit(auto& v) {
      v.Required("inertias", inertias, Any(), "a chain of inertias that may be one distributed rotor");
    }
  };
  struct Params {
    std::string motion = "rotation";
    std::vector<std::pair<std::string, Rotor>> rotor;
    std::vector<std::pair<std::string, double>> inertia;
    std::vector<std::pair<std::string, Value>> shaft, load;
    std::vector<std::pair<std::string, Torque>> torque;
    std::vector<std::pair<std::string, Run>> run;
    double nominal_torque_Nm = 1000.0, initial_speed_rad_per_s = 0.0, initial_angle_rad = 0.0;
    int rotor_modes = 0;
    void Visit(auto& v) {
      v.Optional("motion", motion, std::vector<std::string>{"rotation", "translation"},
                 "translation: bodies slide, with keys of kg, N and m (stiffness_N_per_m, T_c_N) and ports of force, "
                 "position");
      v.Optional("rotor", rotor, Any(),
                 "soft rotors by name: inertia_kg_m2, stiffness_Nm_per_rad, damping_Nms_per_rad, slices (100)");
      v.Optional("inertia", inertia, Positive("kg m^2"), "lumped inertias by name");
      v.Optional("shaft", shaft, Any(),
                 "shafts by name: between = [a, b], law (spring_damper) and its parameters, initial_twist_rad, "
                 "initial_twist_rate_rad_per_s");
      v.Optional("load", load, Any(), "laws to the ground by name: on = inertia or rotor, law and its parameters");
      v.Optional("torque", torque, Any(),
                 "torque entries (inputs) by name: on = [inertias, rotors], slices = [first, last], gain");
      v.Optional("run", run, Any(), "runs of lumps by name: inertias = [...], places for distributed_inertia");
      v.Optional("nominal_torque_Nm", nominal_torque_Nm, Positive(), "usual shaft torque; scales solver tolerances");
      v.Optional("initial_speed_rad_per_s", initial_speed_rad_per_s, Any(),
                 "speed of the line at t = 0, of its first part where shafts have twist rates");
      v.Optional("initial_angle_rad", initial_angle_rad, Any(), "angle of the line's first part at t = 0");
      v.Optional(
          "rotor_modes", rotor_modes, Between(0, 1000),
          "solver realtime: modes that are kept of a part with soft rotors, the last ones for all the faster modes "
          "together; 0: all");
    }
  };

  static PluginInfo Info();
  static PlantTraits Traits();
  /// Null, with diagnostics, when the parts do not make a connected line.
  static std::unique_ptr<DriveLine> Create(const Params& params, const Value& table, BuildContext& context);
  /// Reports what is wrong in shafts, loads and torques when the parameters as such were faulty already.
  static void ReportMore(const Params& params, const Value& table, BuildContext& context);

  void Start(std::span<const double> inputs, std::span<double> states, std::span<int> modes) const override;
  bool FeedsThrough(int in, int out) const override;
  void Output(const View& view, std::span<double> outputs) const override;
  void Derivative(const View& view, std::span<double> rates) const override;
  void Guards(const View& view, std::span<double> values) const override;
  bool IsOfAMode(int guard) const override;
  void OnEvent(const View& view, int guard, std::span<double> states, std::span<int> modes) const override;
  /// Made when it is first asked for: who looks at the network alone does without.
  const LinearPart* linear_part() const override {
    std::call_once(linear_part_made_, [this] { linear_part_ = MakeLinearPart(); });
    return linear_part_.get();
  }
  /// Linearised about rest, laws included.
  const mechanics::Network* network() const override { return &linearised_; }
  std::vector<double> TorqueWeights(int input) const override;
  std::vector<OutputTerm> OutputTerms(int output) const override;

 private:
  friend class DriveLineBuilder;

  /// A law that is linear with states z of its own: z' = A z + b_twist d + b_rate w, T = linear() + c z.
  struct LinearStates {
    Eigen::MatrixXd A;
    Eigen::VectorXd b_twist, b_rate;
    Eigen::RowVectorXd c;
  };
  /// A law that is not just spring and damper. It acts along `weights`: twist = sum w_i phi_i, torque -w_i T on node i.
  struct Element {
    std::string name;
    std::unique_ptr<Law> law;
    SpringDamper linear;  // already in linear_
    std::vector<std::pair<int, double>> weights;
    double mobility = 0.0;                      // sum w_i^2 / I_i
    int state = 0, mode = 0, guard = 0;         // offsets
    std::optional<LinearStates> linear_states;  // goes into the linear part whole; else a channel of it
  };
  /// An output: a sum of network terms, plus what an element transmits beyond its linear part.
  struct Reading {
    std::vector<OutputTerm> terms;
    int element = -1;
  };

  DriveLine() = default;
  /// Derives what the builder's parts imply; the last step of building.
  void Finish();
  std::unique_ptr<LinearPart> MakeLinearPart() const;
  /// Makes the states of laws with linear states part of the system, behind its own; drops the inputs and outputs that
  /// stood for those laws. Returns the scale of each: law's state = scale * system's.
  Eigen::VectorXd TakeUpLinearStates(mechanics::LinearSystem& system) const;
  double Angle(std::span<const double> states, int node) const;
  double Speed(std::span<const double> states, int node) const;
  double Evaluate(const OutputTerm& term, std::span<const double> states) const;
  LawView MakeView(const View& view, const Element& element, double holding) const;
  /// Net torque on each node into `torque` (n); returns by element what it transmits beyond its linear part, and for
  /// the guards the torque that would hold it.
  struct ElementTorque {
    double beyond_linear, holding;
  };
  void Torques(const View& view, std::span<double> torque, std::span<ElementTorque> elements) const;
  /// Lets one element transmit what its law says beside the torques as they are; whether that is anything else than
  /// before.
  bool Transmit(const View& view, std::size_t index, std::span<double> torque, ElementTorque& transmitted) const;

  /// A linear edge as the equation of motion needs it: close together in memory.
  struct Spring {
    int from, to;
    double stiffness, damping;
  };

  mechanics::Network linear_, linearised_;
  std::vector<double> inverse_inertia_;
  std::vector<Spring> springs_;    // of linear_.edges, without those that do nothing
  std::vector<Element> elements_;  // those with linear states first; those that stick last: they hold what is left
  std::vector<std::vector<std::pair<int, double>>> inputs_;  // torque weights of each input
  std::vector<Reading> readings_;
  std::vector<double> initial_angles_;  // of the first node, then of the others relative to it
  std::vector<double> initial_speeds_;
  int rotor_modes_ = 0;  // 0: all
  mutable std::once_flag linear_part_made_;
  mutable std::unique_ptr<LinearPart> linear_part_;
};

}  // namespace dynoproof
