// What a solver does for a run: it carries the continuous blocks over one interval, in which every held signal stands
// still. Sampling, controllers and recording are the same for both solvers (simulate.h).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/status.h"
#include "sim/rig.h"

namespace dynoproof {

namespace mechanics {
class Decompositions;
}

/// Corrects the states of a run between ticks by what its outputs miss of a record, as an observer does.
class Correction {
 public:
  virtual ~Correction() = default;
  /// states += gains errors; modes stay. `errors`: one a column of the gains. Allocates nothing.
  virtual void Apply(Frame& frame, std::span<const double> errors) = 0;
};

/// The nominal state, an index into `nominal`, by whose gain a state is corrected: itself; of a body that was split off one, named
/// NAME_x after it, that body's, for the two move as one where their joint is stiff. Nothing where there is none.
std::optional<std::size_t> CorrectedAs(const std::vector<std::string>& nominal, const std::string& state);

class Solver {
 public:
  virtual ~Solver() = default;

  /// States and modes at t = 0 for the signals that are held now.
  virtual Status Start(Frame& frame) = 0;
  /// Goes on from the states, modes and held signals that a frame of the other solver brought, at frame.time.
  virtual Status Resume(Frame& frame) = 0;
  /// Carries the states over interval `index` of the period that begins at frame.time.
  virtual Status Advance(Frame& frame, int index) = 0;
  /// Between ticks: the states as Frame::states of the other solver would have them, and `change` added to them; modes
  /// stay. For who estimates the state of a machine from its measured outputs.
  virtual std::vector<double> States(const Frame& frame) const = 0;
  virtual void Shift(Frame& frame, const std::vector<double>& change) = 0;
  /// `gains`: by error, the change of each state of Rig::state_ports. `taken`: by error, where in the period before it was taken,
  /// an index of Rig::intervals; empty, or -1: now. What the states have made of a change since then, linear, is what is added;
  /// `reference` adds the change itself. The solver outlives the correction.
  virtual std::unique_ptr<Correction> MakeCorrection(const std::vector<std::vector<double>>& gains,
                                                     const std::vector<int>& taken = {}) = 0;
  /// Whether the states move linearly: nothing is in the rig that this solver does not carry exactly.
  virtual bool linear() const = 0;
  /// Writes every continuous signal at the present states, for the instant `time_s`.
  virtual void Evaluate(Frame& frame, double time_s) = 0;

  /// Steps, failed steps, events, ...: part of the result.
  virtual std::map<std::string, std::int64_t> counters() const = 0;
  /// One line on how the plant is carried: "71 pairs, 1 real, condition 3.2".
  virtual std::string Summary() const = 0;
};

/// SUNDIALS: adaptive, events located, restarted wherever a held signal changes.
Result<std::unique_ptr<Solver>> MakeReferenceSolver(const Rig& rig);
/// Fixed work per period: exact modal propagation of the linear part, substeps for the rest.
/// `known`: where the decomposition of its linear part may be known already.
Result<std::unique_ptr<Solver>> MakeRealtimeSolver(const Rig& rig, mechanics::Decompositions* known = nullptr);
/// The one of that name: "reference" or "realtime"; any other name is a failure.
Result<std::unique_ptr<Solver>> MakeSolver(const std::string& name, const Rig& rig);

}  // namespace dynoproof
