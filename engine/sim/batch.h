// Variants of a linear rig simulated side by side (mechanics/batch_propagator.h). The same course as Simulate() with
// solver `realtime` gives, up to round-off; what a variant gives depends on no other.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "linear/batch_propagator.h"
#include "sim/linear_group.h"
#include "sim/simulate.h"

namespace dynoproof {

/// A rig taken apart for a batch: its linear part in modal coordinates, every output a row of it, every input a source.
class BatchMember {
 public:
  /// Fails where the rig has more than that: laws, controllers, actuators or sensors that are not linear, delays,
  /// another solver, a larger modal block. Says what. Keeps a reference to the rig.
  static Result<BatchMember> Create(const Rig& rig);

  const Rig& rig() const { return *rig_; }
  int pairs() const { return form_.layout.pairs; }

 private:
  friend Result<std::vector<Samples>> SimulateBatch(std::span<const BatchMember* const> members,
                                                    std::span<const int> outputs, bool same_inputs);
  const Rig* rig_ = nullptr;
  mechanics::ModalForm form_;
  Eigen::VectorXd x_, p_;           // at the start
  std::vector<int> input_of_read_;  // for each input of the form the rig's
  std::vector<int> row_of_output_;  // for each output of the rig the form's
};

/// Runs 1 to BatchPropagator::kLanes members of one duration and period. Only the outputs asked for (by number, rising)
/// have samples; a course that is not finite has NaN. `same_inputs`: the sources are the same in all of them, so that
/// they are evaluated once.
Result<std::vector<Samples>> SimulateBatch(std::span<const BatchMember* const> members, std::span<const int> outputs,
                                           bool same_inputs);

}  // namespace dynoproof
