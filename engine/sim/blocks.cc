#include "sim/blocks.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace dynoproof {
namespace {

constexpr std::size_t kFewInputs = 16;

/// Gathers a block's inputs; on the stack unless there are unusually many.
class Inputs {
 public:
  Inputs(const Block& block, std::span<const double> signals) {
    const std::size_t count = block.inputs.size();
    if (count > kFewInputs) many_ = std::make_unique<double[]>(count);
    double* const data = many_ != nullptr ? many_.get() : few_;
    for (std::size_t i = 0; i < count; ++i) data[i] = signals[block.inputs[i]];
    values_ = {data, count};
  }
  std::span<const double> values() const { return values_; }

 private:
  double few_[kFewInputs];
  std::unique_ptr<double[]> many_;
  std::span<const double> values_;
};

View ViewOf(const Block& block, double time_s, const Inputs& inputs, std::span<const double> states,
            std::span<const int> modes) {
  return {time_s, inputs.values(), states.subspan(block.first_state, block.states()),
          modes.subspan(block.first_mode, block.component->layout().modes)};
}

}  // namespace

void EvaluateBlock(const Block& block, double time_s, std::span<const double> states, std::span<const int> modes,
                   std::span<double> signals) {
  const Inputs inputs(block, signals);
  block.component->Output(ViewOf(block, time_s, inputs, states, modes),
                          signals.subspan(block.first_output, block.outputs()));
}

void EvaluateRates(const Block& block, double time_s, std::span<const double> states, std::span<const int> modes,
                   std::span<const double> signals, std::span<double> rates) {
  const Inputs inputs(block, signals);
  block.component->Derivative(ViewOf(block, time_s, inputs, states, modes),
                              rates.subspan(block.first_state, block.states()));
}

void EvaluateBlocks(const Rig& rig, double time_s, std::span<const double> states, std::span<const int> modes,
                    std::span<double> signals) {
  for (const Block& block : rig.blocks) EvaluateBlock(block, time_s, states, modes, signals);
}

void EvaluateGuards(const Block& block, double time_s, std::span<const double> states, std::span<const int> modes,
                    std::span<const double> signals, std::span<double> values) {
  const Inputs inputs(block, signals);
  block.component->Guards(ViewOf(block, time_s, inputs, states, modes),
                          values.subspan(block.first_guard, block.component->layout().guards));
}

void ApplyEvent(const Block& block, int guard, double time_s, std::span<double> states, std::span<int> modes,
                std::span<const double> signals) {
  const Inputs inputs(block, signals);
  block.component->OnEvent(ViewOf(block, time_s, inputs, states, modes), guard,
                           states.subspan(block.first_state, block.states()),
                           modes.subspan(block.first_mode, block.component->layout().modes));
}

std::vector<int> BlocksWithMemory(const Rig& rig) {
  std::vector<int> indices;
  for (std::size_t i = 0; i < rig.blocks.size(); ++i) {
    const Layout& layout = rig.blocks[i].component->layout();
    if (layout.modes > 0 && layout.guards == 0) indices.push_back(static_cast<int>(i));
  }
  return indices;
}

std::vector<bool> FeedsDynamics(const Rig& rig) {
  const auto reads = [](const Block& reader, const Block& writer) {
    return std::any_of(reader.inputs.begin(), reader.inputs.end(), [&writer](int slot) {
      return slot >= writer.first_output && slot < writer.first_output + writer.outputs();
    });
  };
  const std::size_t count = rig.blocks.size();
  std::vector<bool> feeds(count);
  // Blocks are in order of evaluation, but states close circles: repeat until nothing changes.
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count && !feeds[i]; ++j) {
        if (!reads(rig.blocks[j], rig.blocks[i]) || (rig.blocks[j].states() == 0 && !feeds[j])) continue;
        feeds[i] = changed = true;
      }
    }
  }
  return feeds;
}

void StartBlocks(const Rig& rig, Frame& frame) {
  // A block may start from its inputs and its inputs from another block's start: two passes settle every chain that
  // has no circle, since blocks are in order of evaluation.
  for (int pass = 0; pass < 2; ++pass) {
    for (const Block& block : rig.blocks) {
      const std::span<double> states = std::span(frame.states).subspan(block.first_state, block.states());
      const std::span<int> modes = std::span(frame.modes).subspan(block.first_mode, block.component->layout().modes);
      std::fill(states.begin(), states.end(), 0.0);
      std::fill(modes.begin(), modes.end(), 0);
      block.component->Start(Inputs(block, frame.signals).values(), states, modes);
      EvaluateBlock(block, 0.0, frame.states, frame.modes, frame.signals);
    }
  }
}

}  // namespace dynoproof
