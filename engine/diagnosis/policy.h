// The thresholds by which a verdict is decided, each with its unit and where its value comes from.
#pragma once

#include <cstddef>

namespace dynoproof::diagnosis::policy {

/// Deviation of a nuisance parameter from its nominal value that its prior allows [prior standard deviations]. By chance one value
/// lies farther off once in 2000, one of a dozen once in 180.
inline constexpr double kWithinPrior = 3.5;
/// From here on a deviation by itself contradicts the prior [prior standard deviations]: by chance once in 16 000.
inline constexpr double kBeyondPrior = 4.0;
/// Standard deviation to which an output counts as measured, however smooth it is [its spread]. 14
/// bits over a range of which the signal fills a fifth tell 9e-5. Noise of real records, and of the blind suite (from
/// 2e-3), lies far above.
inline constexpr double kResolution = 1e-4;
/// Odds that an effect has to reach after a fair share for each candidate, beside the information criterion's own log n.
inline constexpr double kOdds = 1000.0;
/// Least share of the whitened squares that an effect has to explain: an imperfect noise model brings about less.
inline constexpr double kLeastShare = 1e-3;
/// Least gain of the information criterion, as a share of the least gain of chi2. Parameters of an effect and the
/// freedom of nuisance parameters cost the rest. An F test at 1e-4 over all candidates follows from both: a law of four
/// parameters on 1000 rows, 300 candidates, has p = 2e-6 there.
inline constexpr double kCriterionShare = 0.5;
/// Validation parts, each a fifth of the time, on which an effect has to predict better: more than half of them.
inline constexpr int kBlocks = 5, kBlocksBetter = 3;
/// Difference of -2 log evidence within which two candidates are alike: odds of 150 to 1. Less than one more parameter
/// costs (log n = 11), so that a law and its generalisation are never both in the set.
inline constexpr double kAlike = 10.0;
/// Candidates that an ambiguous verdict names at most (the outside relies on it).
inline constexpr std::size_t kMostAlike = 3;

}  // namespace dynoproof::diagnosis::policy
