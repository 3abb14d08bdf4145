// Laws between a body and the ground, [plant.load.NAME], in a plant that has no contacts to follow: friction slips wherever
// the body moves, and what it holds at standstill nobody knows.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "model/component.h"
#include "model/law.h"
#include "model/registry.h"

namespace dynoproof {

class SlidingLoads {
 public:
  struct Body {
    std::string name;
    double transition_speed = 0.0;  // v_t: friction is multiplied by tanh(|v|/v_t); 0: it turns its sign at once
    double nominal = 1.0;           // usual force or torque
  };

  SlidingLoads() = default;
  /// Builds the loads, whose states are added to the layout as "load.state", in the keys and units of a motion. Nothing, and
  /// diagnostics, where one is faulty. `plant`: its name, for messages.
  static std::optional<SlidingLoads> Of(const std::vector<std::pair<std::string, Value>>& loads,
                                        const std::vector<Body>& bodies, const char* plant, Motion motion,
                                        BuildContext& context, Layout& layout);

  /// The sum of the torques of a body's loads, by its position and speed; `view`: of the plant.
  double Torque(std::size_t body, double position, double speed, const View& view) const;
  /// Rates of their states.
  void Derivative(std::size_t body, double position, double speed, const View& view, std::span<double> rates) const;
  /// Their states where the body begins there.
  void Start(std::size_t body, double position, double speed, std::span<double> states) const;

 private:
  struct Load {
    std::unique_ptr<Law> law;
    std::size_t body, state;  // offset
    double transition_speed;
    std::size_t states() const { return law->layout().states.size(); }
  };
  static LawView ViewOf(const Load& load, double position, double speed, const View& view);

  std::vector<Load> loads_;
};

}  // namespace dynoproof
