// A Plan made ready to run: components built, every port wired to a slot of one signal table, the order of evaluation
// fixed. A rig is const; what changes during a run is the Frame.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/time.h"
#include "linear/aligned_vector.h"
#include "model/plan.h"
#include "model/registry.h"

namespace dynoproof {

inline constexpr std::size_t kMaxControlInputs = 64;

/// One component in its place.
struct Block {
  std::string name;  // "plant", "input.T_airgap.actuator.0", "control.speed"
  std::unique_ptr<Component> component;
  std::vector<int> inputs;  // slot of each input
  int first_output = 0;     // slots of the outputs follow each other
  int first_state = 0;      // in Frame::states, or Frame::control_states for a control
  int first_mode = 0, first_guard = 0;
  Nanoseconds period = 0, offset = 0;  // controls only

  int outputs() const { return static_cast<int>(component->layout().outputs.size()); }
  int states() const { return static_cast<int>(component->layout().states.size()); }
};

/// A driven input: source or control -> held command -> delay -> actuator stages (blocks) -> plant. Which inertias a
/// torque then acts on is the plant's matter (plugins/plant/drive_line: AddTorque).
struct InputLine {
  std::string name, unit, description;
  double nominal = 1.0;
  std::unique_ptr<Component> source;  // null: `from`
  int from = -1;                      // slot of `from = "block.port"`: sampled at each tick unless `continuous`; or -1
  int command = -1;                   // slot; written at ticks unless `continuous`
  int delayed = -1;                   // slot behind the pure delay; equals `command` without one
  bool continuous = false;            // driven by a continuous part: `command` is that part's own slot
  int delay_periods = 0;              // whole periods, and the fraction of one, of the pure delay
  double delay_fraction = 0.0;
  int ring = -1;  // offset in Frame::rings of the last delay_periods + 1 commands
};

/// A recorded output: signal -> sensor stages (blocks) -> sample, taken `delay` earlier than it is shown.
struct OutputLine {
  std::string name, unit, description;
  double nominal = 1.0;
  int signal = -1;  // slot at the end of the chain
  int sample = -1;  // slot that controls read as output.NAME
  /// A sample taken in step k at `sample_fraction`, 0: with those of its tick, shows at tick k + delay_periods.
  int delay_periods = 0;
  double sample_fraction = 0.0;
  int ring = -1;
};

/// Everything that changes during a run; plain numbers, so that save, rewind and compare are copies.
struct Frame {
  Nanoseconds time = 0;
  std::int64_t step = 0;
  std::vector<double> signals;      // every port and line
  std::vector<double> states;       // continuous blocks; those that `realtime` carries in modal coordinates stand still
  mechanics::AlignedVector solver;  // the solver's own: modal coordinates, signs of guards
  std::vector<double> control_states;
  std::vector<double> rings;  // delay lines
  std::vector<int> modes;
  std::vector<int> control_modes;

  friend bool operator==(const Frame&, const Frame&) = default;
};

/// A fixed cut of a period: where delayed inputs switch and shifted samples are taken.
struct Interval {
  double begin = 0.0, length = 1.0;  // fractions of the period
  std::vector<int> switches;         // inputs whose delayed command changes at `begin`
  std::vector<int> samples;          // outputs sampled at `begin`
};

class Rig {
 public:
  /// Builds the plan's blocks; faults become diagnostics and null. Effects must have been applied.
  static std::unique_ptr<Rig> Build(const Plan& plan, const Registry& registry, const Records& records,
                                    Diagnostics& diagnostics);

  std::string id;
  RunSettings run;
  Nanoseconds period = 0;
  double clock_rate = 1.0;      // RunSettings::clock_rate
  std::int64_t steps = 0;       // of the whole run
  std::vector<Block> blocks;    // continuous and stateless, in order of evaluation
  std::vector<Block> controls;  // in data-flow order, ties by name
  std::vector<InputLine> inputs;
  std::vector<OutputLine> outputs;
  std::vector<Interval> intervals;      // of every period, in order
  std::vector<std::string> slots;       // name of each signal
  std::vector<Port> state_ports;        // of Frame::states
  std::vector<std::string> mode_names;  // of Frame::modes
  int modes = 0, guards = 0, control_states = 0, control_modes = 0, rings = 0;

  /// What the clock says, in seconds.
  double SecondsOf(Nanoseconds time) const { return clock_rate * Seconds(time); }
  /// The slot of a signal, or -1.
  int FindSlot(std::string_view name) const;
  const Block* FindBlock(std::string_view name) const;
  /// A frame of the right sizes, zeros throughout.
  Frame MakeFrame() const;
  /// From when on each output shows what a run knows [s]: one that passes on at once what a control commands shows at first
  /// what that did before its first tick, which no run and no record says. 0 for all others.
  std::vector<double> KnownFrom() const;
};

}  // namespace dynoproof
