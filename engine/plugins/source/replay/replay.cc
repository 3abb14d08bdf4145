#include "plugins/source/replay/replay.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dynoproof::sources {
namespace {

// Samples to either side that make a value. The Blackman window's main lobe then ends 3 / 32 of the sampling rate from
// its middle: content is kept up to 0.8 of half the sampling rate.
constexpr int kReach = 32;
// To which a step is told apart: where between two samples a value lies is known no better than its time, to ten or eleven digits.
constexpr std::int64_t kParts = std::int64_t{1} << 32;
constexpr std::size_t kShares = 16;  // of which the weights are kept

}  // namespace

PluginInfo Replay::Info() {
  return {"source",
          "replay",
          "a recorded signal, held or interpolated",
          "values[i] for times[i] <= t < times[i+1], the straight line between them, or their band-limited signal",
          "definition",
          {}};
}

std::optional<std::string> ProblemOf(const Series& series) {
  const std::vector<double>& times = *series.time;
  const std::vector<double>& values = *series.values;
  if (times.empty() || times.size() != values.size()) {
    return fmt::format("{} times and {} values", times.size(), values.size());
  }
  const auto bad = [](double x) { return !std::isfinite(x); };
  if (std::any_of(times.begin(), times.end(), bad)) return "a time is not finite";
  if (std::any_of(values.begin(), values.end(), bad)) return "a value is not finite";
  const auto fall = std::adjacent_find(times.begin(), times.end(), std::greater_equal<>());
  if (fall == times.end()) return std::nullopt;
  return fmt::format("the times do not rise after {} s (sample {})", *fall, fall - times.begin());
}

std::optional<std::string> UnequalStepsOf(const Series& series) {
  constexpr double kOff = 0.01;  // what a signal at half the sampling rate errs by then: pi/100 of its amplitude
  const std::vector<double>& times = *series.time;
  if (times.size() < 2) return "one sample has no band";
  const double step = (times.back() - times.front()) / (static_cast<double>(times.size()) - 1.0);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double off = (times[i] - times.front()) / step - static_cast<double>(i);
    if (!(std::abs(off) <= kOff))
      return fmt::format("sample {} comes {:.3g} steps beside equal steps of {} s", i, off, step);
  }
  return std::nullopt;
}

void Replay::Params::Check(Faults& faults) const {
  const int ways = (times_s.empty() ? 0 : 1) + (file.empty() ? 0 : 1) + (record.empty() ? 0 : 1);
  if (ways != 1) {
    faults.At("type", "a replay needs exactly one of times_s with values, file with column, and record",
              "times_s = [...], values = [...] or file = \"record.csv\", column = \"T\"");
  }
  if (file.empty() != column.empty()) faults.At("file", "\"file\" and \"column\" belong together");
}

std::unique_ptr<Replay> Replay::Create(const Params& params, const ::dynoproof::Value& table, BuildContext& context) {
  Series series;
  if (params.times_s.empty()) {
    const auto found =
        context.records == nullptr ? Records::const_iterator{} : context.records->find(params.RecordName());
    if (context.records == nullptr || found == context.records->end()) {
      context.diagnostics.Error(table.where(), fmt::format("there is no recorded signal \"{}\"", params.RecordName()),
                                "is the file there, and does it have this column?");
      return nullptr;
    }
    series = found->second;
  } else {
    series = {std::make_shared<const std::vector<double>>(params.times_s),
              std::make_shared<const std::vector<double>>(params.values)};
  }
  if (const std::optional<std::string> problem = ProblemOf(series)) {
    context.diagnostics.Error(table.where(), context.context + ": " + *problem, "rising times, one value each");
    return nullptr;
  }
  if (params.interpolation == "band_limited") {
    if (const std::optional<std::string> problem = UnequalStepsOf(series)) {
      context.diagnostics.Error(table.where(), context.context + ": " + *problem,
                                "\"band_limited\" needs equal steps: interpolation = \"linear\" does not");
      return nullptr;
    }
  }
  return std::make_unique<Replay>(std::move(series), params.interpolation);
}

Replay::Replay(Series series, const std::string& interpolation)
    : series_(std::move(series)),
      between_(interpolation == "linear"         ? Between::kLine
               : interpolation == "band_limited" ? Between::kBandLimited
                                                 : Between::kHold) {
  const std::vector<double>& times = *series_.time;
  if (between_ == Between::kBandLimited) known_.reserve(kShares);
  if (times.size() > 1) steps_per_s_ = (static_cast<double>(times.size()) - 1.0) / (times.back() - times.front());
}

double Replay::Value(double time_s) const {
  const std::vector<double>& times = *series_.time;
  const std::vector<double>& values = *series_.values;
  const double until = time_s + kTimeSlack;
  if (until < times.front()) return values.front();
  // Records mostly have equal steps: then the sample is where they say.
  const double guess = std::clamp((until - times.front()) * steps_per_s_, 0.0, static_cast<double>(times.size() - 1));
  auto i = static_cast<std::size_t>(guess);
  if (times[i] > until || (i + 1 < times.size() && times[i + 1] <= until))
    i = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), until) - times.begin()) - 1;
  if (i + 1 == times.size() || between_ == Between::kHold) return values[i];
  if (between_ == Between::kBandLimited) return BandLimited(time_s);
  const double share = std::clamp((time_s - times[i]) / (times[i + 1] - times[i]), 0.0, 1.0);
  return values[i] + share * (values[i + 1] - values[i]);
}

double Replay::BandLimited(double time_s) const {
  const std::vector<double>& times = *series_.time;
  const std::vector<double>& values = *series_.values;
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  const double position = (time_s - times.front()) / (times.back() - times.front()) * static_cast<double>(last);
  const auto before = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(position), 0, last);
  const std::int64_t share = std::llround((position - static_cast<double>(before)) * static_cast<double>(kParts));
  if (share == 0) return values[static_cast<std::size_t>(before)];
  if (share == kParts) return values[static_cast<std::size_t>(std::min(before + 1, last))];
  const auto& weights = WeightsAt(share).of_sample;
  const std::ptrdiff_t first = before + 1 - kReach;
  if (first >= 0 && before + kReach <= last)
    return weights.dot(Eigen::Map<const Eigen::Matrix<double, 2 * kReach, 1>>(values.data() + first));
  double sum = 0.0;
  for (std::ptrdiff_t i = 0; i < 2 * kReach; ++i) {  // before the first sample and behind the last stand these
    sum += weights[i] * values[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(first + i, 0, last))];
  }
  return sum;
}

const Replay::Weights& Replay::WeightsAt(std::int64_t share) const {
  for (const Weights& known : known_) {
    if (known.share == share) return known;
  }
  if (known_.size() < kShares) known_.emplace_back();
  Weights& made = known_[next_];
  next_ = (next_ + 1) % kShares;
  made.share = share;
  // The distance x to sample before + j is part - j, and sin(pi x) = (-1)^j sin(pi part): up to a factor that all
  // weights have, sinc(x) is (-1)^j / x. The cosine of the window goes on from sample to sample by a rotation.
  constexpr double pi = std::numbers::pi;
  const double part = static_cast<double>(share) / static_cast<double>(kParts);
  const double turn = std::cos(pi / kReach), first = pi * (part + kReach - 1) / kReach;
  double cosine = std::cos(first), previous = std::cos(first + pi / kReach), sign = kReach % 2 == 0 ? -1.0 : 1.0;
  for (int j = 1 - kReach; j <= kReach; ++j) {
    made.of_sample[j + kReach - 1] = sign / (part - j) * (0.34 + cosine * (0.5 + 0.16 * cosine));
    sign = -sign;
    const double next = 2.0 * turn * cosine - previous;
    previous = cosine;
    cosine = next;
  }
  made.of_sample /= made.of_sample.sum();  // a constant stays one
  return made;
}

}  // namespace dynoproof::sources
