// Evaluation of blocks one after the other; shared by both solvers.
#pragma once

#include <span>
#include <vector>

#include "sim/rig.h"

namespace dynoproof {

/// Writes the outputs of all blocks, in order, from `states`; used by `reference` and by tests.
void EvaluateBlocks(const Rig& rig, double time_s, std::span<const double> states, std::span<const int> modes,
                    std::span<double> signals);
/// The same for one block.
void EvaluateBlock(const Block& block, double time_s, std::span<const double> states, std::span<const int> modes,
                   std::span<double> signals);
/// The rates of one block's states, into their place among `rates`.
void EvaluateRates(const Block& block, double time_s, std::span<const double> states, std::span<const int> modes,
                   std::span<const double> signals, std::span<double> rates);
/// One block's guards, into their place among `values`; and what the event of one of them changes.
void EvaluateGuards(const Block& block, double time_s, std::span<const double> states, std::span<const int> modes,
                    std::span<const double> signals, std::span<double> values);
/// `guard` = kEndOfInterval: blocks with modes and no guards, whose memory of what was moves on when an interval ends.
inline constexpr int kEndOfInterval = -1;
std::vector<int> BlocksWithMemory(const Rig& rig);
void ApplyEvent(const Block& block, int guard, double time_s, std::span<double> states, std::span<int> modes,
                std::span<const double> signals);
/// By block: true when a block with states reads its outputs, directly or through stateless ones.
std::vector<bool> FeedsDynamics(const Rig& rig);
/// Starts every block in order: its states, modes and outputs for the signals that are held now.
void StartBlocks(const Rig& rig, Frame& frame);

}  // namespace dynoproof
