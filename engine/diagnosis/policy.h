// The thresholds by which a verdict is decided, each with its unit and where its value comes from.
#pragma once

#include <cstddef>

namespace dynoproof::diagnosis::policy {

/// Candidates that an ambiguous verdict names at most (the outside relies on it).
inline constexpr std::size_t kMostAlike = 3;

/// Each memory over the one before, and the last one over the record's length: on the heavy-duty line with all nominal values
/// free a fit goes from 0.2 s to the free run of 0.7 s in a false minimum of 1.6 times the noise, over 1 and 4 s to the truth, and
/// in the frozen case 2802/40 over 24 and 120 s. Beyond the record's length they are asked only where they are needed.
inline constexpr double kLonger = 5.0, kLongest = 200.0;
/// Behind a gap, what the plan leaves with the shorter memory [of the spreads] from which on it is asked with one five times shorter first.
inline constexpr double kOutOfSight = 0.2;
/// The longest memory that counts as corrected [of the record].
inline constexpr double kMostOfRecord = 1.0 / 3.0;
/// RMS over what noise alone causes up to which a model counts as exact.
inline constexpr double kNoiseSize = 1.2;
/// RMS of the free run over the noise, in the channel where that is most, up to which the plan as given is not asked about at all: a record's
/// own noise leaves 1, a trace of the same plan that is fed back 0 to 0.02.
inline constexpr double kFarBelowNoise = 0.1;
/// Power beyond the noise's at which an effect may show [of the noise's power; standard errors].
inline constexpr double kExcess = 0.2, kExcessErrors = 5.0;
/// RMS over what noise alone causes that a null leaves at a level, over that of its free run, from which on the record corrects away from itself what
/// needs no correction: 1700 behind a gap whose gain was not made for it. Corrections that serve leave less than the free run.
inline constexpr double kAmplifies = 10.0;
/// How well the power of noise is known [of itself]: sixth differences of white noise tell it to that.
inline constexpr double kNoiseKnown = 0.02;
/// Candidates that are fitted at a first look, of the some hundred whose one or two runs beside the null promise most.
inline constexpr std::size_t kLookedAtMost = 40;
/// What one number removes by chance of the squares of noise [its variance]: of a hundred candidates less than one removes more
/// than three standard deviations. And those that are fitted though all are below.
inline constexpr double kByChance = 9.0;
inline constexpr std::size_t kLookedAtLeast = 3;
/// Points that such a fit looks at: a stiffness that was a tenth off came from a start on the wrong side in 24.
inline constexpr int kLookedAtPoints = 24;
/// Candidates that are carried from a first look through all levels: on top of the nominal model, and of one that has causes.
inline constexpr std::size_t kCarried = 10, kCarriedOnTop = 5;
/// Single effects on top of which a second one is tried: an assumption. In the frozen pair 2807/20 one of the two causes removed
/// the eighth largest share. Each effect takes some hundred runs.
inline constexpr std::size_t kBases = 8;
/// Points that the fit of a candidate at a level looks at: steps, and sets of columns. Causes that were right took some twenty
/// steps and two sets on the heavy-duty line, models that went along a valley four hundred points. Of two coupled drives with four
/// numbers 25 points were too few to find the right one, 60 were enough.
inline constexpr int kSteps = 60, kColumns = 3;
/// The same of a fit with other models' columns.
inline constexpr int kRoughPoints = 30;
/// Noise that a level makes of a record's, over that, up to which a model that is exact there may rule out others.
inline constexpr double kQuiet = 1.5;
/// Share of the excess under the priors that nominal values remove which are let go, from which on a thorough search asks whether they
/// remove all: two and three inertias a tenth off removed 92 and 99 %. And its steps, with columns of their own each: those took 31.
inline constexpr double kNumbersAlone = 0.8;
inline constexpr int kThoroughSteps = 40;
/// Numbers far from their priors of which up to three are looked for that are wrong: of eight, 92 sets.
inline constexpr std::size_t kMostChanges = 8;
/// Power beyond the noise over the least of all at a level, from which on a fit is left as other models' columns gave it: models
/// within twice the least may be a cause.
inline constexpr double kFarBehind = 3.0;
/// A fit ends where its next step would lower the excess by less than this share: at a first look, and on the way through the
/// levels. Models are told apart by shares of some hundredths.
inline constexpr double kLookedAt = 1e-2, kCarriedTo = 1e-3;
/// The fit of a cause that is told ends where a step would lower the criterion by less than this: its numbers then lie within a tenth of a standard
/// deviation of the minimum.
inline constexpr double kNamedTo = 0.01;
/// Where one candidate removes the one share of the excess, those that have removed no more than the other are not followed:
/// a cause that leaves 95 % where another leaves half is none, whatever comes.
inline constexpr double kMost = 0.5, kLittle = 0.05;
/// Cosine of two candidates' columns from which on a record does not tell them apart: it would take 25 times the data.
inline constexpr double kAlike = 0.98;
/// Steps of a run that a search simulates: 1.2 s at 10 kHz are some 500 periods of a line's first mode.
inline constexpr double kSearchedSteps = 12'000.0;
/// Samples that a search has in any case, where a scenario makes many steps between two: 500 of a motor that was held at 3100 angles left
/// the order of its cogging known to 3 %. And the steps that it simulates for them at most.
inline constexpr double kSearchedSamples = 2'000.0, kMostSearchedSteps = 120'000.0;
/// A signal that stays within this share of its spread in a whole record stands still: of that no model's error is told.
inline constexpr double kStill = 0.01;
/// Distance of two predictions of a channel, over all of its rows, which no test sees [standard deviations of the noise].
inline constexpr double kUnseen = 0.1;
/// Modes of soft rotors that a search keeps, the fewest that no test sees: of three rotors of 70 and 100 slices 20 were 0.005, 0.03 and 0.07
/// standard deviations of the noise off.
inline constexpr int kRotorModes[] = {20, 28};
/// RMS over the noise up to which a second cause is looked for under the priors: a pair may leave nothing but noise there.
inline constexpr double kNearEnough = 30.0;
/// Squares of deviations from priors that one of two models that predict alike needs more than the other to be implausible
/// beside it [standard deviations squared]: four deviations of one number, odds of 1 to 3000.
inline constexpr double kImplausible = 16.0;
/// Twice the logarithm of the likelihood up to which a start of its own accounts for a record as well as a cause does: what a number
/// that does nothing gains in one of twenty.
inline constexpr double kAsWell = 3.8;
/// Least share of the null's excess that a cause removes, on training data.
inline constexpr double kShare = 0.2;
/// The same on data that took no part, corrected and in the free run: with priors, and with nominal values released.
inline constexpr double kHeldOutPrior = 0.1, kHeldOutReleased = 0.5;
/// Least share on data that took no part that a main cause explains: most of it.
inline constexpr double kMainCause = 0.5;
/// The same of one that leaves nothing but noise, but more than that on data that took no part. Of 43 right ones of six plants each left
/// nothing but noise there, too; one with a hold-out in motion, whose start is known by some samples alone, explained 0.86, a wrong one 0.67.
inline constexpr double kBornOut = 0.8;
/// The same of one that leaves nothing but noise, but with a nominal value on its bound: that can account for the rest alone.
/// Behind a gap three right ones of 0.979, 0.992 and 0.997 had light bodies and dampings pushed, which impacts hardly show.
inline constexpr double kNearlyAll = 0.9;
/// Share of what the plan as given leaves on data that took no part, from which on a null that removes it, too, leaves them
/// nothing to tell the two apart by.
inline constexpr double kBothPredict = 0.9;
/// Excess on data that took no part, over the least of all models, up to which a cause may be one; within a family the
/// law with the fewest numbers within this of the best stands for it.
inline constexpr double kMarginBest = 2.0, kMarginFamily = 1.5;
/// A tone in what a model leaves is hum where it stands so many times above everything further off than this [Hz], and leaves at most this
/// share of itself once it is taken off, as a resonance does not that is driven over some width.
inline constexpr double kHumAbove = 5.0, kBesideHum_hz = 5.0, kHumLeaves = 1.0 / 3.0;
/// Its two halves differ by at most this share of it, as the ringing of a mode does not; and the largest share of an output's spread:
/// what is larger is the machine. In an inexact world a mode at 1560 Hz was two thirds of a torque.
inline constexpr double kHumUnsteady = 0.3, kMostHumShare = 0.2;
/// Drifts of several sensors are taken off the records where beside them some model leaves at most this share of what the best one leaves
/// without, and at least two of them are so large [RMS over the output's noise]; at this share, before the nominal values are let go, where no
/// pair of causes leaves nothing but noise. Three worlds of which sensors warmed up left 0.05, 0.12 and 0.35, and in the frozen pair
/// 2807/9 a slow input's dead zone looked like drifts that left 0.002.
inline constexpr double kDriftsLeave = 0.5, kDriftShows = 0.5, kDriftsAlone = 0.1;
/// RMS beyond the noise that a model leaves with another course of inputs between their samples, over what the best one leaves with the guess:
/// right ones of lines with friction left 0.017 to 0.058, the best of wrong ones 0.69.
inline constexpr double kOtherCourse = 0.5;
/// Least share that a cause may have at a level, and at one with a memory on data that took no part: below it makes things worse there.
inline constexpr double kHarm = -0.05;

}  // namespace dynoproof::diagnosis::policy
