#include "thesis/studies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiment/analysis.h"
#include "experiment/prepare.h"
#include "scenario/find.h"
#include "scenario/load.h"
#include "thesis/coupling_studies.h"
#include "thesis/descriptions.h"
#include "thesis/distributed.h"
#include "thesis/eigen_derivatives.h"
#include "thesis/machine_studies.h"
#include "thesis/parametrisation.h"
#include "thesis/pressure_studies.h"
#include "thesis/speed_loop.h"
#include "thesis/studies_backlash.h"
#include "thesis/studies_formulas.h"
#include "thesis/studies_identification.h"
#include "thesis/studies_printed.h"
#include "thesis/studies_runs.h"
#include "thesis/studies_slips.h"
#include "thesis/study_parameters.h"
#include "thesis/suppression_studies.h"
#include "thesis/two_mass.h"

namespace dynoproof {
namespace {

/// The scenario that the claim names, built and analysed.
struct Subject {
  std::unique_ptr<Prepared> prepared;
  LinearAnalysis analysis;
};
Result<Subject> Load(const Registry& registry, const Value& parameters) {
  const Value* id = parameters.Find("scenario");
  if (id == nullptr || !id->is_string()) return BadStudy("needs a \"scenario\"");
  Diagnostics diagnostics;
  Subject subject;
  for (const std::string& file : FindScenarios(id->string(), diagnostics)) {
    subject.prepared = Prepare(file, {}, registry, diagnostics);
  }
  if (subject.prepared == nullptr) return BadStudy(diagnostics.Format());
  const std::optional<AnalysisSettings> settings =
      ReadAnalysis(subject.prepared->plan, *subject.prepared->rig, diagnostics);
  if (!settings) return BadStudy("the scenario has no [analysis]");
  Result<LinearAnalysis> analysis = Analyse(*subject.prepared->rig, *settings);
  if (!analysis.ok()) return analysis.failure();
  subject.analysis = std::move(*analysis);
  return subject;
}

/// The n-th item (from 1) of a list.
template <class T>
Result<T> Pick(const std::vector<T>& list, const Value& parameters, const char* key) {
  const Result<double> number = Number(parameters, key);
  if (!number.ok()) return number.failure();
  if (*number < 1 || *number > static_cast<double>(list.size())) {
    return BadStudy(fmt::format("{} {} of {}", key, *number, list.size()));
  }
  return list[static_cast<std::size_t>(*number) - 1];
}

/// Undamped eigenfrequency `mode` (1: the lowest elastic one).
Result<Figure> ModeFrequency(const Registry& registry, const Value& parameters) {
  const Result<Subject> subject = Load(registry, parameters);
  if (!subject.ok()) return subject.failure();
  std::vector<double> elastic;
  for (const mechanics::Mode& mode : subject->analysis.modal.modes) {
    if (mode.frequency_hz > 0.0) elastic.push_back(mode.frequency_hz);
  }
  const Result<double> frequency = Pick(elastic, parameters, "mode");
  return frequency.ok() ? Result<Figure>(Figure{*frequency, "Hz"}) : frequency.failure();
}

/// Undamped eigenfrequencies of a scenario's line, the rigid-body mode first; nothing else of it is analysed.
Result<Eigen::VectorXd> FrequenciesOf(const Registry& registry, const std::string& id) {
  Diagnostics diagnostics;
  const std::vector<std::string> files = FindScenarios(id, diagnostics);
  const std::unique_ptr<Prepared> prepared = files.size() == 1 ? Prepare(files[0], {}, registry, diagnostics) : nullptr;
  if (prepared == nullptr) return BadStudy(diagnostics.Format());
  const mechanics::Network* network = prepared->rig->FindBlock("plant")->component->network();
  if (network == nullptr) return BadStudy(fmt::format("{} has no drive line", id));
  return mechanics::UndampedFrequencies(*network);
}

/// Largest relative distance of the first `modes` elastic eigenfrequencies from those of another scenario, `beside`.
Result<Figure> PredictionGap(const Registry& registry, const Value& parameters) {
  const auto ours = FrequenciesOf(registry, parameters.TextOr("scenario"));
  const auto theirs = FrequenciesOf(registry, parameters.TextOr("beside"));
  const Result<double> modes = Number(parameters, "modes");
  if (!ours.ok()) return ours.failure();
  if (!theirs.ok()) return theirs.failure();
  if (!modes.ok()) return modes.failure();
  const auto count = static_cast<Eigen::Index>(*modes);
  if (count < 1 || count >= std::min(ours->size(), theirs->size())) return BadStudy("there are not that many modes");
  const Eigen::ArrayXd ratio = ours->segment(1, count).array() / theirs->segment(1, count).array();
  return Figure{(ratio - 1.0).abs().maxCoeff(), "1"};
}

std::vector<double> OscillatoryZeros(const Subject& subject) {
  std::vector<double> frequencies;
  for (const mechanics::Zero& zero : subject.analysis.zeros.zeros) {
    if (zero.oscillatory) frequencies.push_back(zero.frequency_hz);
  }
  return frequencies;
}

/// Frequency of the oscillatory transfer zero number `zero`.
Result<Figure> ZeroFrequency(const Registry& registry, const Value& parameters) {
  const Result<Subject> subject = Load(registry, parameters);
  if (!subject.ok()) return subject.failure();
  const Result<double> frequency = Pick(OscillatoryZeros(*subject), parameters, "zero");
  return frequency.ok() ? Result<Figure>(Figure{*frequency, "Hz"}) : frequency.failure();
}

/// How many oscillatory transfer zeros there are.
Result<Figure> ZeroCount(const Registry& registry, const Value& parameters) {
  const Result<Subject> subject = Load(registry, parameters);
  if (!subject.ok()) return subject.failure();
  return Figure{static_cast<double>(OscillatoryZeros(*subject).size()), "1"};
}

/// Of the practical resonance `resonance`: its gain over that of the largest.
Result<Figure> RelativeHeight(const Registry& registry, const Value& parameters) {
  const Result<Subject> subject = Load(registry, parameters);
  if (!subject.ok()) return subject.failure();
  const Result<mechanics::Resonance> one = Pick(subject->analysis.resonances, parameters, "resonance");
  if (!one.ok()) return one.failure();
  double largest = 0.0;
  for (const mechanics::Resonance& each : subject->analysis.resonances) largest = std::max(largest, each.gain);
  return Figure{one->gain / largest, "1"};
}

/// Largest distance between a practical resonance up to `below_Hz` and the nearest eigenfrequency, relative.
Result<Figure> ResonanceShift(const Registry& registry, const Value& parameters) {
  const Result<Subject> subject = Load(registry, parameters);
  if (!subject.ok()) return subject.failure();
  const Result<double> below = Number(parameters, "below_Hz");
  if (!below.ok()) return below.failure();
  double worst = 0.0;
  for (const mechanics::Resonance& resonance : subject->analysis.resonances) {
    if (resonance.frequency_hz > *below) continue;
    double nearest = INFINITY;
    for (const mechanics::Mode& mode : subject->analysis.modal.modes) {
      nearest = std::min(nearest, std::abs(mode.frequency_hz - resonance.frequency_hz));
    }
    worst = std::max(worst, nearest / resonance.frequency_hz);
  }
  return Figure{worst, "1"};
}

/// How many eigenfrequencies do not fall when the last inertia grows, by (2.59) on the chain.
Result<Figure> RisingWithLastInertia(const Registry& registry, const Value& parameters) {
  const Result<Subject> subject = Load(registry, parameters);
  if (!subject.ok()) return subject.failure();
  const Result<mechanics::Chain> chain = mechanics::ChainOf(*subject->analysis.network);
  if (!chain.ok()) return chain.failure();
  const Eigen::VectorXd derivative = mechanics::LastInertiaDerivative(*chain, mechanics::SolveReduced(*chain));
  // lambda = -nu^2 must rise for the frequency to fall.
  return Figure{static_cast<double>((derivative.array() <= 0.0).count()), "1"};
}

/// The rotor with an oscillator at its end, from I_1, k_im, I_5, k_4.
struct RotorWithOscillator {
  double inertia, stiffness;
  mechanics::Oscillator oscillator;
};
Result<RotorWithOscillator> ReadRotor(const Value& parameters) {
  double values[4];
  const char* keys[4] = {"I_1", "k_im", "I_5", "k_4"};
  for (int i = 0; i < 4; ++i) {
    const Result<double> number = Number(parameters, keys[i]);
    if (!number.ok()) return number.failure();
    values[i] = *number;
  }
  return RotorWithOscillator{values[0], values[1], {values[3], values[2]}};
}

/// The frequency number `mode` of the claim, the first where it names none.
Result<Figure> Chosen(const Result<std::vector<double>>& frequencies, const Value& parameters) {
  if (!frequencies.ok()) return frequencies.failure();
  const double mode = parameters.NumberOr("mode", 1.0);
  if (mode < 1.0 || mode > static_cast<double>(frequencies->size()))
    return BadStudy(fmt::format("mode {} of {}", mode, frequencies->size()));
  return Figure{(*frequencies)[static_cast<std::size_t>(mode) - 1], "Hz"};
}

/// An eigenfrequency of the distributed rotor with an oscillator, exact transcendental equation.
Result<Figure> RotorExact(const Registry&, const Value& parameters) {
  const Result<RotorWithOscillator> rotor = ReadRotor(parameters);
  if (!rotor.ok()) return rotor.failure();
  return Chosen(
      mechanics::ExactEigenfrequencies({rotor->inertia, rotor->stiffness, 0.0, 0.0, {rotor->oscillator}}, 2000.0),
      parameters);
}

/// The same by the heuristic (B.4).
Result<Figure> RotorHeuristic(const Registry&, const Value& parameters) {
  const Result<RotorWithOscillator> rotor = ReadRotor(parameters);
  if (!rotor.ok()) return rotor.failure();
  return Chosen(mechanics::HeuristicEigenfrequencies(rotor->inertia, rotor->stiffness, rotor->oscillator, 2000.0),
                parameters);
}

/// The same by (2.111), the oscillator's inertia pinned to the rotor.
Result<Figure> RotorPlain(const Registry&, const Value& parameters) {
  const Result<RotorWithOscillator> rotor = ReadRotor(parameters);
  if (!rotor.ok()) return rotor.failure();
  return Chosen(mechanics::SpatialEigenfrequencies(rotor->inertia, rotor->stiffness, rotor->oscillator.inertia, 2000.0),
                parameters);
}

/// The same with the rotor cut into `slices`.
Result<Figure> RotorSliced(const Registry&, const Value& parameters) {
  const Result<RotorWithOscillator> rotor = ReadRotor(parameters);
  const Result<double> slices = Number(parameters, "slices");
  if (!rotor.ok()) return rotor.failure();
  if (!slices.ok()) return slices.failure();
  const auto all = mechanics::UndampedFrequencies(
      mechanics::Sliced({rotor->inertia, rotor->stiffness, 0.0, 0.0, {rotor->oscillator}}, static_cast<int>(*slices)));
  if (!all.ok()) return all.failure();
  for (const double frequency : *all) {
    if (frequency > 0.0) return Figure{frequency, "Hz"};
  }
  return BadStudy("no elastic mode");
}

/// How far the heuristic formula is below the rotor in slices.
Result<Figure> RotorFormulaGap(const Registry& registry, const Value& parameters) {
  const Result<Figure> sliced = RotorSliced(registry, parameters), formula = RotorHeuristic(registry, parameters);
  if (!sliced.ok()) return sliced;
  if (!formula.ok()) return formula;
  return Figure{sliced->value - formula->value, "Hz"};
}

/// Measured order with which the sliced rotor approaches the exact one.
Result<Figure> SliceOrder(const Registry&, const Value& parameters) {
  const Result<RotorWithOscillator> rotor = ReadRotor(parameters);
  if (!rotor.ok()) return rotor.failure();
  const auto convergence = mechanics::MeasureSliceConvergence(
      {rotor->inertia, rotor->stiffness, 0.0, 0.0, {rotor->oscillator}}, 1, {50, 100, 200, 400});
  if (!convergence.ok()) return convergence.failure();
  return Figure{convergence->order.back(), "1"};
}

/// (2.111) against the exact equation with the inertia pinned to the rotor's end: largest relative difference.
Result<Figure> SpatialAgainstExact(const Registry&, const Value& parameters) {
  const Result<RotorWithOscillator> rotor = ReadRotor(parameters);
  if (!rotor.ok()) return rotor.failure();
  const auto spatial =
      mechanics::SpatialEigenfrequencies(rotor->inertia, rotor->stiffness, rotor->oscillator.inertia, 5000.0);
  const auto exact =
      mechanics::ExactEigenfrequencies({rotor->inertia, rotor->stiffness, 0.0, rotor->oscillator.inertia, {}}, 5000.0);
  if (!spatial.ok()) return spatial.failure();
  if (!exact.ok()) return exact.failure();
  if (spatial->size() != exact->size()) return BadStudy("different numbers of roots");
  double worst = 0.0;
  for (std::size_t i = 0; i < exact->size(); ++i) worst = std::max(worst, std::abs((*spatial)[i] / (*exact)[i] - 1.0));
  return Figure{worst, "1"};
}

/// A loop with plausible numbers, for the identities (2.5), (2.6).
mechanics::SpeedLoop SampleLoop() { return {{4.8, 0.2, 6e6, 30.0}, 50.0, 400.0, 0.4, 1e-3}; }

/// Largest relative difference of the closed loop (2.5) from its blocks, with P_2 as it is right or as printed.
Result<Figure> ClosedLoopIdentity(const Registry&, const Value& parameters) {
  const Value* printed = parameters.Find("as_printed");
  const bool wrong = printed != nullptr && printed->is_bool() && printed->boolean();
  const mechanics::SpeedLoop loop = SampleLoop();
  const mechanics::ClosedLoop closed = mechanics::CloseLoop(loop);
  double worst = 0.0;
  for (double f = 0.1; f < 3000.0; f *= 1.3) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
    const std::complex<double> polynomial =
        mechanics::Evaluate(closed.numerator, s) / mechanics::Evaluate(closed.denominator, s);
    std::complex<double> blocks = mechanics::ClosedLoopTransfer(loop, s);
    if (wrong) {
      const auto& [I1, I2, k, c] = loop.plant;
      const std::complex<double> denominator = s * s + c * (1 / I1 + 1 / I2) * s + k * (1 / I1 + 1 / I2);
      const std::complex<double> p1 = (c * s + k) / I1 / denominator, p2 = (s + (c * s + k) / I2) / I1 / denominator;
      const std::complex<double> actuator = 1.0 / (1.0 + s * loop.tau_a), control = loop.k_P + loop.k_I / s;
      blocks = p2 * actuator * control / (1.0 - loop.k_V * actuator * p1 + actuator * control * p2);
    }
    worst = std::max(worst, std::abs(blocks - polynomial) / std::abs(polynomial));
  }
  return Figure{worst, "1"};
}

/// 1 when (2.5) is unstable with k_V at `factor` times the bound (2.6), else 0.
Result<Figure> UnstableAtBound(const Registry&, const Value& parameters) {
  const Result<double> factor = Number(parameters, "factor");
  if (!factor.ok()) return factor.failure();
  mechanics::SpeedLoop loop = SampleLoop();
  loop.k_V = *factor * mechanics::FeedthroughBound(loop);
  const auto roots = mechanics::PolynomialRoots(mechanics::CloseLoop(loop).denominator);
  if (!roots.ok()) return roots.failure();
  return Figure{roots->real().maxCoeff() > 0.0 ? 1.0 : 0.0, "1"};
}

/// Both tuples (2.65), (2.66) put back into (2.64): largest relative error of the resonances.
Result<Figure> ThreeMassRoundTrip(const Registry&, const Value&) {
  const double I1 = 2.0, I2 = 5.0, I3 = 0.7, nu1 = 300.0, nu2 = 900.0;
  const mechanics::ThreeMassSolution solution = mechanics::ThreeMassStiffnesses(I1, I2, I3, nu1, nu2);
  if (!solution.first || !solution.second) return BadStudy("no solution");
  double worst = 0.0;
  for (const mechanics::ThreeMassSprings& springs : {*solution.first, *solution.second}) {
    mechanics::Network network;
    network.nodes = {{"I1", I1}, {"I2", I2}, {"I3", I3}};
    network.edges = {{"k1", 0, 1, springs.k1, 0.0}, {"k2", 1, 2, springs.k2, 0.0}};
    const auto frequencies = mechanics::UndampedFrequencies(network);
    if (!frequencies.ok()) return frequencies.failure();
    worst = std::max(worst, std::abs((*frequencies)[1] * 2.0 * std::numbers::pi / nu1 - 1.0));
    worst = std::max(worst, std::abs((*frequencies)[2] * 2.0 * std::numbers::pi / nu2 - 1.0));
  }
  return Figure{worst, "1"};
}

/// How many solutions (2.90) has for a rotor that possesses one by construction.
Result<Figure> ZeroEquationSolutions(const Registry&, const Value&) {
  // I1 = 3, I2 = 1.5, I3 = 0.4 with k1 = 2e6, k2 = 1e6, input on I2.
  mechanics::Network network;
  network.nodes = {{"I1", 3.0}, {"I2", 1.5}, {"I3", 0.4}};
  network.edges = {{"k1", 0, 1, 2e6, 0.0}, {"k2", 1, 2, 1e6, 0.0}};
  const auto frequencies = mechanics::UndampedFrequencies(network);
  if (!frequencies.ok()) return frequencies.failure();
  const double turn = 2.0 * std::numbers::pi;
  const auto solutions = mechanics::SplitRotorFromZero(turn * (*frequencies)[1], turn * (*frequencies)[2],
                                                       mechanics::CounterOscillatorZero(2e6, 3.0), 4.5, 0.4);
  const bool contains = std::any_of(solutions.begin(), solutions.end(), [](const mechanics::SplitRotor& one) {
    return std::abs(one.k1 / 2e6 - 1.0) < 1e-9 && std::abs(one.I2 / 1.5 - 1.0) < 1e-9;
  });
  if (!contains) return BadStudy("the rotor it was made from is not among the solutions");
  return Figure{static_cast<double>(solutions.size()), "1"};
}

/// Two-mass oscillator: practical resonance of the twist (2.17) against the eigenfrequency (2.14), relative distance.
Result<Figure> TwoMassDistance(const Registry&, const Value&) {
  const mechanics::TwoMass plant = {4.8, 0.2, 6e6, 125.0};
  return Figure{1.0 - *mechanics::TwistResonance(plant) / *mechanics::DampedFrequency(plant), "1"};
}

}  // namespace

const std::map<std::string, Study, std::less<>>& Studies() {
  static const std::map<std::string, Study, std::less<>> studies = {
      {"backlash_impact", BacklashImpact},
      {"backlash_laws", BacklashLaws},
      {"backlash_rigid_mass", BacklashRigidMass},
      {"closed_loop_identity", ClosedLoopIdentity},
      {"coupling_chamber_angle", CouplingChamberAngle},
      {"coupling_closed_loop", CouplingClosedLoop},
      {"coupling_frequency", CouplingFrequency},
      {"coupling_lever", CouplingLever},
      {"coupling_reynolds", CouplingReynolds},
      {"coupling_rivals", CouplingRivals},
      {"coupling_steady", CouplingSteady},
      {"mode_frequency", ModeFrequency},
      {"prediction_gap", PredictionGap},
      {"unstable_at_bound", UnstableAtBound},
      {"relative_height", RelativeHeight},
      {"resonance_shift", ResonanceShift},
      {"rising_with_last_inertia", RisingWithLastInertia},
      {"rotor_exact", RotorExact},
      {"rotor_formula_gap", RotorFormulaGap},
      {"rotor_in_thirds", RotorInThirds},
      {"rotor_heuristic", RotorHeuristic},
      {"rotor_plain", RotorPlain},
      {"rotor_sliced", RotorSliced},
      {"scenario_figure", ScenarioFigure},
      {"slice_order", SliceOrder},
      {"spatial_against_exact", SpatialAgainstExact},
      {"three_mass_round_trip", ThreeMassRoundTrip},
      {"two_mass_distance", TwoMassDistance},
      {"zero_count", ZeroCount},
      {"zero_equation_solutions", ZeroEquationSolutions},
      {"zero_frequency", ZeroFrequency},
  };
  static const std::map<std::string, Study, std::less<>> all = [] {
    auto merged = SuppressionStudies();
    merged.merge(PressureStudies());
    merged.merge(PrintedStudies());
    merged.merge(MachineStudies());
    merged.merge(FormulaStudies());
    merged.merge(SlipStudies());
    merged.merge(IdentificationStudies());
    merged.insert(studies.begin(), studies.end());
    return merged;
  }();
  return all;
}

}  // namespace dynoproof
