// The data of a diagnosis in two parts: those that models are fitted to, and those that judge them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "diagnosis/contest.h"
#include "diagnosis/settle.h"

namespace dynoproof::diagnosis {

inline constexpr double kFittedShare = 0.7;          // of records without a hold-out of their own
inline constexpr Eigen::Index kComparedRows = 4000;  // of a channel

/// How much of each record a search simulates [s]: policy::kSearchedSteps, and more where these hold few samples.
double SearchedUntil(const Plan& plan, const std::vector<MappedRecord>& records);

struct Parts {
  std::unique_ptr<Levels> training, held_out;
  std::vector<MappedRecord> fitted;  // all of what models are fitted to; a search looks at its first part
};

/// Without a hold-out the last part of each record is that. Records in motion are led in by their samples, unless the plan
/// holds starts (FitStarts()) that suit them as well: what noise makes of a start that is found in a short lead-in stays in the
/// free run behind it. Fails where the plan cannot be run.
Result<Parts> Split(const Plan& plan, const std::vector<MappedRecord>& data, const std::vector<MappedRecord>& holdout,
                    const Registry& registry);

/// A line with the fewest modes of its soft rotors whose free run no record tells from its own: a search decomposes it anew for each
/// of some thousand sets of numbers, and a rotor of a hundred slices costs ten times its simulation then.
Plan WithFewerModes(const Plan& plan, const Levels& levels);

/// The plan with the fewest substeps (`[run.realtime]`) whose free run no record tells from its own. A linear plan keeps its
/// substeps: they are for the nonlinear laws that an effect may add.
Plan InFewerSubsteps(const Plan& plan, const Levels& levels, const Registry& registry);

/// What a plan leaves beyond the noise at each level of a data set; nothing where its run breaks.
HeldOut LeftOf(const Plan& plan, const Levels& levels);

/// Of each contestant, as it is fitted at each level, over what the plan as given leaves. `own`: these are other records, which
/// start elsewhere than those of the fits.
std::vector<HeldOut> HeldOutOf(const Contest& contest, const Levels& held_out, const HeldOut& given, bool own);

/// By level, the least of all, the plan as given (0) among them.
std::vector<double> LeastOf(const std::vector<std::vector<HeldOut>>& passes, std::size_t levels);

}  // namespace dynoproof::diagnosis
