// A model that is fitted level by level, and how much it leaves.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/levels.h"
#include "estimation/estimator.h"

namespace dynoproof::diagnosis {

/// Coordinates and half of their 95 % intervals.
struct Interval {
  Eigen::VectorXd q, half;
};

/// A model and what it was fitted to at each level.
struct Contestant {
  explicit Contestant(estimation::Hypothesis model) : hypothesis(std::move(model)) {}

  estimation::Hypothesis hypothesis;
  std::vector<estimation::Estimate> levels;  // not fitted, or broken: not ok()
  double share = 0.0;                        // of the null's excess that it removes at a first look
  bool coloured = false;                     // what it leaves is noise by all tests, though more than differences tell
  std::optional<Interval> to_all = {};  // fitted to all of the records (FitToAll), where levels are of their first part

  /// The effect that came last; there is none in the nominal model.
  const Effect& effect() const { return *hypothesis.effects().back().effect; }
  const Place& place() const { return hypothesis.effects().back().place; }
  std::string Name() const { return hypothesis.Name(); }
  bool Holds(std::size_t level) const { return level < levels.size() && levels[level].ok(); }
};

/// Whether a contestant's law has more numbers than another one's at the same place, which it becomes with some of them at nothing.
bool Refines(const Contestant& refined, const Contestant& plain);

/// RMS over what noise alone causes, in the channel where that is most.
double TimesNoise(const estimation::Estimate& estimate);
/// RMS by channel that noise alone causes.
Eigen::VectorXd NoiseAloneOf(const estimation::Estimate& estimate);
/// Whether innovations are no larger than measurement noise makes them, by 1.2 in each channel.
bool IsExact(const std::vector<estimation::ChannelScale>& scales);
bool IsExact(const estimation::Estimate& estimate);
/// Whether a model may be exact where its run is corrected less, or once its fit has ended: what it leaves is near the noise.
bool IsNearTheNoise(const estimation::Estimate& estimate);
/// Whether a level hears noise about as softly as the free run does. Where a correction makes it louder, models pass for exact
/// that the free run tells apart.
bool IsQuiet(const estimation::Estimate& estimate, const estimation::DataSet& data);
/// Whether they are larger by so much that an effect may show: a fifth of the noise's power, or five standard errors.
bool HasExcess(const estimation::Estimate& estimate, const estimation::DataSet& data);
/// Mean over channels of the logarithm of the power beyond what noise alone causes. A channel that shows none beside the noise
/// counts with as much as could be seen there.
double LogExcess(const std::vector<estimation::ChannelScale>& scales, const estimation::DataSet& data);
/// That of a fit.
double LogLeft(const estimation::Estimate& fit, const Levels& levels);
/// That of a model at some coordinates; infinite where its run breaks.
double LogLeftAt(const Eigen::VectorXd& q, const estimation::Hypothesis& model, const Levels& levels,
                 std::size_t level);

/// The share of the null's excess that a model removes at a level where both hold.
double ShareOf(const Contestant& contestant, const Contestant& null, const Levels& levels, std::size_t level);

/// A number on a bound, or an effect whose numbers are all where they do nothing, names nothing. One of several numbers
/// may do nothing: friction that differs with direction may have no viscous part.
bool NamesSomething(const Contestant& one, std::size_t level);

/// How far nominal values are off: the sum of squares of their deviations, in standard deviations of their priors.
double OffNominal(const Contestant& one, std::size_t level);

/// Whether the data of a fit tell a number at all: a standard deviation of its prior, or a factor e, would be seen. Others lie anywhere.
bool Shows(const estimation::Estimate& fit, std::size_t number);

/// Nominal values at the end of what their prior allows, or of how far they were released, where the fit would have gone on: by index, of
/// those that show.
std::vector<std::size_t> NominalValuesOnBounds(const Contestant& one, std::size_t level);

/// An effect of a fitted model that could be left out, and where the other numbers then go, this effect doing nothing.
struct Idle {
  std::size_t effect = 0;
  Eigen::VectorXd q;
};
/// Those without which the criterion would grow by no more than a number removes by chance, along the columns of the fit (Wald's test).
std::vector<Idle> IdleEffects(const Contestant& one, std::size_t level);

/// Weighs rows as a fit has weighed its innovations (estimator.h): over each channel's scale and the root of its correlation time.
void WeighAs(const estimation::Estimate& estimate, const estimation::DataSet& data, Eigen::VectorXd& rows);

/// The contestant whose excess at a level is least; null where none holds there.
const Contestant* LeaderAt(std::span<const Contestant> contestants, const Levels& levels, std::size_t level);

/// The coordinates of an estimate as a start for a hypothesis of the same machine: its own numbers by their names, the rest as
/// the hypothesis starts.
Eigen::VectorXd StartFrom(const estimation::Hypothesis& hypothesis, const estimation::Hypothesis& other,
                          const Eigen::VectorXd& q);
/// The rest as in `start`.
Eigen::VectorXd StartFrom(const estimation::Hypothesis& hypothesis, const estimation::Hypothesis& other,
                          const Eigen::VectorXd& q, Eigen::VectorXd start);

/// Points that a fit with columns of its own may look at: a descent that keeps its columns takes one a step, new columns one for
/// each parameter.
int PointsFor(const estimation::Hypothesis& hypothesis);

/// A hypothesis whose own loop is louder than the null's may not excuse what it leaves with that. Where the null leaves coloured
/// noise, noise alone is that.
estimation::Estimate AsLoudAs(const Contestant& null, std::size_t level, estimation::Estimate estimate);

/// From now on, of all of them, noise alone is at each level at least what this one leaves there, which is noise of some colour.
void CountAsNoise(Contestant one, std::span<Contestant> all);

}  // namespace dynoproof::diagnosis
