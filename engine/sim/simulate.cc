#include "sim/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/subnormals.h"

namespace dynoproof {

Status Simulation::Start() {
  for (const InputLine& line : rig_.inputs) {
    if (line.source == nullptr) continue;
    line.source->Output({0.0, {}, {}, {}}, {&frame_.signals[line.command], 1});
    frame_.signals[line.delayed] = frame_.signals[line.command];
  }
  if (Status failed = solver_.Start(frame_)) return failed;
  solver_.Evaluate(frame_, 0.0);
  for (const OutputLine& line : rig_.outputs) {
    for (int i = 0; line.ring >= 0 && i < line.delay_periods; ++i) {
      frame_.rings[line.ring + i] = frame_.signals[line.signal];
    }
  }
  return {};
}

void Simulation::TakeSamples() {
  solver_.Evaluate(frame_, rig_.SecondsOf(frame_.time));
  for (const OutputLine& line : rig_.outputs) {
    const double signal = frame_.signals[line.signal];
    if (line.ring < 0) {
      frame_.signals[line.sample] = signal;
      continue;
    }
    double& oldest = frame_.rings[line.ring + frame_.step % line.delay_periods];
    frame_.signals[line.sample] = oldest;
    // A delay of whole periods shows what a sample without delay was, before controls and commands of that tick have changed it.
    if (line.sample_fraction == 0.0) oldest = signal;
  }
}

void Simulation::TickControls() {
  for (const Block& block : rig_.controls) {
    const bool every_tick = block.period == rig_.period && block.offset == 0;  // spares the usual one a division
    if (!every_tick && (frame_.time < block.offset || (frame_.time - block.offset) % block.period != 0)) continue;
    double inputs[kMaxControlInputs];
    const std::size_t count = block.inputs.size();
    for (std::size_t i = 0; i < count; ++i) inputs[i] = frame_.signals[block.inputs[i]];
    const std::span<double> states = std::span(frame_.control_states).subspan(block.first_state, block.states());
    const std::span<int> modes =
        std::span(frame_.control_modes).subspan(block.first_mode, block.component->layout().modes);
    const View view{rig_.SecondsOf(frame_.time), {inputs, count}, states, modes};
    block.component->Tick(view, states, std::span(frame_.signals).subspan(block.first_output, block.outputs()));
  }
}

void Simulation::HoldCommands() {
  const double time_s = rig_.SecondsOf(frame_.time);
  for (const InputLine& line : rig_.inputs) {
    if (line.continuous) continue;
    double& command = frame_.signals[line.command];
    if (line.source != nullptr) {
      line.source->Output({time_s, {}, {}, {}}, {&command, 1});
    } else {
      command = frame_.signals[line.from];
    }
    if (line.ring < 0) continue;
    if (frame_.step == 0) {  // before the run the command was the first one: a control's is known at its first tick
      std::fill_n(frame_.rings.begin() + line.ring, line.delay_periods + 1, command);
      frame_.signals[line.delayed] = command;
    }
    frame_.rings[line.ring + frame_.step % (line.delay_periods + 1)] = command;
  }
}

Status Simulation::CheckFinite() const {
  for (const OutputLine& line : rig_.outputs) {
    if (!std::isfinite(frame_.signals[line.sample])) {
      return Failure{"not a finite number", "output." + line.name, rig_.SecondsOf(frame_.time)};
    }
  }
  for (const InputLine& line : rig_.inputs) {
    if (!std::isfinite(frame_.signals[line.command])) {
      return Failure{"not a finite number", "input." + line.name, rig_.SecondsOf(frame_.time)};
    }
  }
  return {};
}

Status Simulation::Tick() {
  TakeSamples();
  TickControls();
  HoldCommands();
  return CheckFinite();
}

Status Simulation::Integrate() {
  for (int index = 0; index < static_cast<int>(rig_.intervals.size()); ++index) {
    const Interval& interval = rig_.intervals[index];
    if (!interval.samples.empty()) {
      const double offset_s = rig_.SecondsOf(rig_.period) * interval.begin;
      solver_.Evaluate(frame_, rig_.SecondsOf(frame_.time) + offset_s);
      for (const int output : interval.samples) {
        const OutputLine& line = rig_.outputs[output];
        frame_.rings[line.ring + frame_.step % line.delay_periods] = frame_.signals[line.signal];
      }
    }
    for (const int input : interval.switches) {
      // The command of delay_periods ago lies in the ring's next place: the oldest one.
      const InputLine& line = rig_.inputs[input];
      frame_.signals[line.delayed] = frame_.rings[line.ring + (frame_.step + 1) % (line.delay_periods + 1)];
    }
    if (Status failed = solver_.Advance(frame_, index)) return failed;
  }
  frame_.time += rig_.period;
  ++frame_.step;
  return {};
}

void StepTimes::Add(double duration_s) {
  const double bin = kBinsPerDecade * std::log10(std::max(duration_s, kLeast_s) / kLeast_s);
  ++counts[std::min(kBins - 1, static_cast<int>(bin))];
}

Result<Samples> Simulate(const Rig& rig, Solver& solver, const Progress& progress, StepTimes* times) {
  using Clock = std::chrono::steady_clock;
  const FlushSubnormals flush;
  Samples samples;
  const auto rows = static_cast<std::size_t>(rig.steps) + 1;
  samples.time.resize(rows);
  samples.inputs.assign(rig.inputs.size(), std::vector<double>(rows));
  samples.outputs.assign(rig.outputs.size(), std::vector<double>(rows));
  Simulation simulation(rig, solver);
  if (Status failed = simulation.Start()) return *failed;
  const std::int64_t report = std::max<std::int64_t>(1, rig.steps / 200);
  for (std::int64_t step = 0; step <= rig.steps; ++step) {
    const Clock::time_point begin = times != nullptr ? Clock::now() : Clock::time_point();
    if (Status failed = simulation.Tick()) return *failed;
    samples.time[step] = rig.SecondsOf(simulation.frame().time);
    for (std::size_t i = 0; i < samples.inputs.size(); ++i) samples.inputs[i][step] = simulation.InputCommand(i);
    for (std::size_t i = 0; i < samples.outputs.size(); ++i) samples.outputs[i][step] = simulation.OutputSample(i);
    if (step == rig.steps) break;
    if (Status failed = simulation.Integrate()) return *failed;
    if (times != nullptr) times->Add(std::chrono::duration<double>(Clock::now() - begin).count());
    if (progress && step % report == 0 && !progress(static_cast<double>(step) / static_cast<double>(rig.steps))) {
      return Failure{"interrupted", rig.id, rig.SecondsOf(simulation.frame().time)};
    }
  }
  samples.counters = solver.counters();
  samples.solver_summary = solver.Summary();
  return samples;
}

}  // namespace dynoproof
