#include "diagnosis/data_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/text.h"
#include "base/units.h"
#include "diagnosis/value_check.h"
#include "estimation/data_set.h"
#include "experiment/gaps.h"
#include "identification/suspects.h"
#include "score/fft.h"
#include "score/series.h"
#include "trace/time_base.h"

namespace dynoproof::diagnosis {
namespace {

void CheckTime(const trace::Column& time, std::vector<Finding>& findings) {
  // A gap this long is no lost row any more: what the input did in it nobody knows.
  const std::optional<Unit> unit = ParseUnit(time.unit.empty() ? "s" : time.unit);
  if (!unit || !SameQuantity(*unit, *ParseUnit("s"))) {
    findings.push_back(
        {true, "unit", time.name, fmt::format("is in \"{}\", which is no unit of time", time.unit), 0, 0.0});
    return;
  }
  std::vector<double> stamps;  // behind the end of a shorter raster there are none
  for (const double t : time.values) {
    if (std::isfinite(t)) stamps.push_back(t);
  }
  if (stamps.size() < 2) return;
  std::size_t falls = 0, first_fall = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] < stamps[i - 1] && falls++ == 0) first_fall = i;
  }
  if (falls > 0) {
    findings.push_back({true, "not_rising", time.name,
                        fmt::format("{} time stamps fall, the first in row {} ({} after {})", falls, first_fall,
                                    stamps[first_fall], stamps[first_fall - 1]),
                        falls, stamps[first_fall]});
    return;
  }
  const trace::TimeBase base = trace::TimeBaseOf(stamps, unit->factor);
  if (base.events > 0)
    findings.push_back({false, "event", time.name,
                        fmt::format("{} instants have several rows: the values before and after an event", base.events),
                        base.events, 0.0});
  const double usual_s = base.uniform() ? base.step_s : base.usual_step_s;
  const bool lost = base.longest_gap_s > kMostLost * usual_s;
  const std::string longest = fmt::format(
      "the longest {:.4g} s at {:.6g} s (row {}){}", base.longest_gap_s, base.longest_gap_at_s, base.longest_gap_row,
      lost ? fmt::format(": in more than {} steps nobody knows the input; identify and diagnose take what lies before "
                         "and behind for records of their own",
                         kMostLost)
           : "");
  if (base.uniform() && base.dropped > 0)
    findings.push_back({lost, lost ? "gap" : "dropped", time.name,
                        fmt::format("{} rows are missing of {} in {}, {}", base.dropped,
                                    base.time_s.size() + base.dropped, Counted(base.gaps, "gap"), longest),
                        base.gaps, base.longest_gap_at_s});
  if (base.uniform() || base.time_s.size() < 3) return;
  const double off = base.jitter_s / base.usual_step_s;
  findings.push_back({false, "jitter", time.name,
                      fmt::format("steps differ from {:.6g} s by up to {:.3g} s ({:.2g} %)", base.usual_step_s,
                                  base.jitter_s, 100.0 * off),
                      base.time_s.size(), 0.0});
  if (base.gaps > 0)
    findings.push_back(
        {lost, "gap", time.name, fmt::format("{} gaps, {}", base.gaps, longest), base.gaps, base.longest_gap_at_s});
}

/// Standard deviation.
double Spread(const Eigen::Ref<const Eigen::VectorXd>& a) { return std::sqrt((a.array() - a.mean()).square().mean()); }

/// Correlation of two signals without their means; 0 where one is constant.
double Correlation(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b) {
  const Eigen::VectorXd x = a.array() - a.mean(), y = b.array() - b.mean();
  const double scale = x.norm() * y.norm();
  return scale > 0.0 ? x.dot(y) / scale : 0.0;
}

/// How alike two signals are in each octave: the correlation of its lines as a complex number, of which the real part
/// tells the sign and the size forgives a phase. Octaves without either signal are left out.
std::vector<std::complex<double>> AlikeByOctave(const Eigen::Ref<const Eigen::VectorXd>& a,
                                                const Eigen::Ref<const Eigen::VectorXd>& b) {
  const std::vector<double> x(a.begin(), a.end()), y(b.begin(), b.end());
  const auto p = score::Fft(std::span<const double>(x)), q = score::Fft(std::span<const double>(y));
  constexpr std::size_t kLeast = 8;  // bins: noise alone is then rarely alike by more than kAlike
  std::vector<std::complex<double>> octaves;
  for (std::size_t first = kLeast; 2 * first <= x.size() / 2; first *= 2) {
    std::complex<double> both;
    double of_p = 0.0, of_q = 0.0;
    for (std::size_t k = first; k < 2 * first; ++k) {
      both += p[k] * std::conj(q[k]);
      of_p += std::norm(p[k]);
      of_q += std::norm(q[k]);
    }
    if (of_p > 0.0 && of_q > 0.0) octaves.push_back(both / std::sqrt(of_p * of_q));
  }
  return octaves;
}

constexpr double kAlike = 0.7;

/// Whether two signals are opposite in every octave. A sensor's sign turns all of them, a resonance that is elsewhere
/// than simulated only those around it.
bool TurnedThroughout(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b) {
  const std::vector<std::complex<double>> octaves = AlikeByOctave(a, b);
  return std::none_of(octaves.begin(), octaves.end(), [](const auto& alike) { return alike.real() > kAlike; });
}

/// Whether anything of one signal is in the other: the whole, or an octave of it.
bool Related(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b) {
  const std::vector<std::complex<double>> octaves = AlikeByOctave(a, b);
  return std::abs(Correlation(a, b)) > kAlike ||
         std::any_of(octaves.begin(), octaves.end(), [](const auto& alike) { return std::abs(alike) > kAlike; });
}

}  // namespace

std::vector<Finding> CheckRecord(const trace::Record& record) {
  std::vector<Finding> findings;
  std::vector<bool> is_time(record.columns.size(), false);
  for (const trace::Column& column : record.columns) {
    if (column.time) is_time[*column.time] = true;
  }
  if (record.time) is_time[*record.time] = true;
  for (const trace::NonFinite& bad : record.non_finite) {
    findings.push_back({true, "not_finite", record.columns[bad.column].name,
                        fmt::format("{} values are no numbers, the first in row {}", bad.count, bad.first_row),
                        bad.count, 0.0});
  }
  for (std::size_t i = 0; i < record.columns.size(); ++i) {
    const trace::Column& column = record.columns[i];
    if (column.values.size() < 3) {
      findings.push_back({true, "short", column.name,
                          fmt::format("{} samples; a comparison needs hundreds", column.values.size()),
                          column.values.size(), 0.0});
      continue;
    }
    if (is_time[i]) {
      CheckTime(column, findings);
      continue;
    }
    if (!std::all_of(column.values.begin(), column.values.end(), [](double x) { return std::isfinite(x); })) continue;
    const auto [low, high] = std::minmax_element(column.values.begin(), column.values.end());
    if (*low == *high) {
      findings.push_back(
          {false, "constant", column.name, fmt::format("is {:.6g} throughout", *low), column.values.size(), 0.0});
      continue;
    }
    CheckValues(column, column.time ? &record.columns[*column.time].values : nullptr, findings);
  }
  if (!record.time && !record.columns.empty())
    findings.push_back({false, "no_time", "", "there is no column t or time: a map has to say the rate", 0, 0.0});
  return findings;
}

Result<std::vector<Finding>> CheckAgainst(const EstimationProblem& problem) {
  std::vector<Finding> findings;
  const Result<Eigen::VectorXd> nominal = problem.Predict(problem.Nominal());
  if (!nominal.ok()) return nominal.failure();
  for (const ComparedOutput& channel : problem.channels()) {
    const auto measured = problem.measured().segment(channel.begin, channel.count);
    const auto predicted = nominal->segment(channel.begin, channel.count);
    const auto count = static_cast<std::size_t>(channel.count);
    if (const std::string few = TooFew(count); !few.empty()) {
      findings.push_back({true, "short", channel.name, few, count, 0.0});
      continue;
    }
    const double simulated_spread = Spread(predicted);
    if (!(channel.spread > 1e-12 * channel.nominal)) {
      if (simulated_spread > estimation::kRounding * channel.nominal)
        findings.push_back({true, "constant", channel.name, "is constant, the simulation moves", 0, 0.0});
      continue;
    }
    if (!(simulated_spread > 0.0)) continue;
    const double own = Correlation(measured, predicted);
    // Swapped: clearly more like another output of the same record than like its own, and not of its own size beside
    // the other's; lightly damped signals fall out of step, and then look like any other.
    constexpr double kOfASize = 3.0;
    const auto apart = [&channel](double spread) { return std::abs(std::log(channel.spread / spread)); };
    for (const ComparedOutput& other : problem.channels()) {
      if (other.record != channel.record || other.name == channel.name || other.count != channel.count) continue;
      const auto simulated = nominal->segment(other.begin, other.count);
      const double there = std::abs(Correlation(measured, simulated));
      if (there > 0.7 && there > std::abs(own) + 0.3 &&
          apart(Spread(simulated)) < apart(simulated_spread) + std::log(kOfASize))
        findings.push_back({true, "swapped", channel.name,
                            fmt::format("is like the simulated {} (correlation {:.2f}), not like its own ({:.2f})",
                                        other.name, there, own),
                            0, 0.0});
    }
    if (own < -0.7 && TurnedThroughout(measured, predicted))
      findings.push_back({true, "sign", channel.name,
                          fmt::format("moves against the simulation (correlation {:.2f}): sign = -1 in a map?", own), 0,
                          0.0});
    const double factor = channel.spread / simulated_spread;
    if (std::abs(own) > 0.7) {
      if (const auto unit = identification::CauseOfFactor(factor, channel.unit))
        findings.push_back(
            {true, "unit", channel.name, fmt::format("is {:.4g} times the simulation, {}", factor, *unit), 0, 0.0});
    }
    // Delay: the shift at which the two are most alike, if that is clearly not 0.
    const Eigen::VectorXd x = predicted.array() - predicted.mean(), y = measured.array() - measured.mean();
    const std::size_t most = static_cast<std::size_t>(std::min<Eigen::Index>(500, channel.count / 4));
    const std::vector<double> correlation = score::CrossCorrelation(
        {x.data(), static_cast<std::size_t>(x.size())}, {y.data(), static_cast<std::size_t>(y.size())}, most);
    const auto best = std::max_element(correlation.begin(), correlation.end());
    const auto shift = (best - correlation.begin()) - static_cast<std::ptrdiff_t>(most);
    const double gain = *best / std::max(1e-300, x.norm() * y.norm());
    if (std::abs(shift) >= 2 && gain > 0.8 && gain > own + 0.05)
      findings.push_back({false, "delay", channel.name,
                          fmt::format("is most like the simulation {:.4g} s {} (correlation {:.3f} instead of {:.3f})",
                                      std::abs(static_cast<double>(shift)) * channel.step_s,
                                      shift > 0 ? "later" : "earlier", gain, own),
                          0, 0.0});
  }
  for (const MappedRecord& record : problem.records()) {
    const Value* inputs = problem.plan().root.Find("input");
    for (const std::string& name : inputs != nullptr ? KeysOf(*inputs) : std::vector<std::string>{}) {
      const auto found = record.inputs.find(name);
      if (found == record.inputs.end()) {
        findings.push_back({true, "missing", name,
                            "the record does not have this input: the run would be driven by "
                            "something else than the measurement",
                            0, 0.0});
        continue;
      }
      const Value* nominal_value = inputs->Find(name)->Find("nominal");
      const double nominal_size =
          nominal_value != nullptr && nominal_value->is_number() ? nominal_value->number() : 0.0;
      const double peak = score::Largest(*found->second.values);
      // Against a nominal, only a factor that no experiment explains is suspicious.
      if (nominal_size > 0.0 && peak > 0.0 && (peak > 100.0 * nominal_size || peak < 0.003 * nominal_size))
        findings.push_back({false, "unit", name,
                            fmt::format("reaches {:.4g}, its nominal is {:.4g}: another unit?", peak, nominal_size), 0,
                            0.0});
    }
  }
  return findings;
}

Result<std::vector<Finding>> DistancesOf(const EstimationProblem& problem) {
  // What leaves four fifths of the squares is no account of a signal; one of another size ends at 1, not above.
  constexpr double kFarOff = 0.9;
  const Result<Eigen::VectorXd> nominal = problem.Predict(problem.Nominal());
  if (!nominal.ok()) return nominal.failure();
  std::vector<Finding> findings;
  for (const ComparedOutput& channel : problem.channels()) {
    if (!TooFew(static_cast<std::size_t>(channel.count)).empty() || !(channel.spread > 1e-12 * channel.nominal))
      continue;
    const auto measured = problem.measured().segment(channel.begin, channel.count);
    const auto predicted = nominal->segment(channel.begin, channel.count);
    const double nrmse = std::sqrt((measured - predicted).array().square().mean()) / channel.spread;
    const bool far = nrmse > kFarOff, foreign = far && !Related(measured, predicted);
    const char* meaning = foreign
                              ? ": no octave of its spectrum is like the simulated one. The record has nothing to do "
                                "with this scenario, or another column or input was taken"
                          : far ? ": parts of its spectrum are like the simulated ones; the model does not account for "
                                  "the rest"
                                : "";
    findings.push_back({foreign, "distance", channel.name,
                        fmt::format("is {:.3g} of its own spread off the simulation (NRMSE){}", nrmse, meaning), 0, 0.0,
                        nrmse});
  }
  return findings;
}

}  // namespace dynoproof::diagnosis
