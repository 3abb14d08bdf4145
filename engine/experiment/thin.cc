#include "experiment/thin.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "score/series.h"

namespace dynoproof {
namespace {

constexpr std::size_t kWhole = 4000;  // a time base of fewer samples is kept as it is
/// Kept samples in a stretch. More would tell less of a lone sample, fewer would leave less room for samples, which tell why a
/// run is off.
constexpr std::size_t kInStretch = 8;

std::size_t NextPrime(std::size_t n) {
  for (;; ++n) {
    bool prime = n > 1;
    for (std::size_t d = 2; d * d <= n && prime; ++d) prime = n % d != 0;
    if (prime) return n;
  }
}

std::vector<double> EveryNth(std::span<const double> stamps, std::size_t n) {
  std::vector<double> kept;
  for (std::size_t i = 0; i < stamps.size(); i += n) kept.push_back(stamps[i]);
  return kept;
}

bool StaysWhole(std::span<const double> stamps) { return stamps.size() < kWhole; }

/// Size of a data set without its numbers, and of a compressed number, in an HDF5 file: golden/pressure has 0.67 kB and 4 to 6 bytes.
constexpr std::size_t kBytesOfSet = 700, kBytesOfNumber = 6;

/// Sets of numbers in the file, stretches included.
std::size_t SetsOf(const trace::Trace& trace) {
  return trace.signals.size() * (1 + StretchNames("").size()) + 2 * (1 + trace.other_times.size());
}

/// Numbers of the trace if all samples were kept, stretches included.
std::size_t NumbersOf(const trace::Trace& trace) {
  std::size_t numbers = trace.time.size();
  for (const std::vector<double>& time : trace.other_times) numbers += time.size();
  for (const trace::Signal& signal : trace.signals) {
    numbers += signal.values.size();
    if (!StaysWhole(trace.TimeOf(signal))) numbers += StretchNames("").size() * signal.values.size() / kInStretch;
  }
  return numbers;
}

}  // namespace

std::optional<std::vector<double>> SamplesAt(std::span<const double> kept, std::span<const double> time_s,
                                             std::span<const double> values) {
  std::vector<double> samples;
  const double slack = kStampSlack * score::MedianStep(time_s);
  for (const double stamp : kept) {
    const auto it = std::lower_bound(time_s.begin(), time_s.end(), stamp - slack);
    if (it == time_s.end() || *it > stamp + slack) return std::nullopt;
    samples.push_back(values[it - time_s.begin()]);
  }
  return samples;
}

std::optional<Stretches> StretchesOf(std::span<const double> ends, std::span<const double> time_s,
                                     std::span<const double> values) {
  const double slack = kStampSlack * score::MedianStep(time_s);
  Stretches stretches;
  std::size_t i = 0;  // the first sample of the stretch
  for (const double end : ends) {
    const std::size_t first = i;
    while (i < time_s.size() && time_s[i] <= end + slack) ++i;
    // The first stretch is one sample: what comes before it belongs to no run of the same stamps.
    if (i == first || time_s[i - 1] < end - slack || (first == 0 && i > 1)) return std::nullopt;
    const std::span<const double> own = values.subspan(first, i - first);
    const auto [least, greatest] = std::minmax_element(own.begin(), own.end());
    stretches.least.push_back(*least);
    stretches.greatest.push_back(*greatest);
    stretches.mean.push_back(std::accumulate(own.begin(), own.end(), 0.0) / static_cast<double>(own.size()));
    stretches.least_s.push_back(time_s[first + (least - own.begin())]);
    stretches.greatest_s.push_back(time_s[first + (greatest - own.begin())]);
  }
  if (i != time_s.size()) return std::nullopt;
  return stretches;
}

std::array<std::string, 3> StretchNames(std::string_view name) {
  const std::string of(name);
  return {of + " (least)", of + " (greatest)", of + " (mean)"};
}

bool IsOfStretches(const trace::Trace& thin, const trace::Signal& signal) {
  const std::size_t bracket = signal.name.rfind(" (");
  if (bracket == std::string::npos) return false;
  const std::string of = signal.name.substr(0, bracket);
  const auto names = StretchNames(of);
  return thin.Find(of) != nullptr && std::find(names.begin(), names.end(), signal.name) != names.end();
}

trace::Trace Thin(const trace::Trace& trace, std::size_t most_bytes) {
  // Of very many signals a tenth of the size is left to the numbers.
  const std::size_t beside = std::min(kBytesOfSet * SetsOf(trace), most_bytes - most_bytes / 10);
  const std::size_t room = most_bytes - beside;
  const std::size_t least = (kBytesOfNumber * NumbersOf(trace) + room - 1) / room;
  // A prime step never falls into step with a period of the signal or of a controller.
  const std::size_t step = least <= 1 ? 1 : NextPrime(least);
  trace::Trace thin = trace;
  thin.signals.clear();
  std::vector<std::size_t> stretches_of(trace.other_times.size() + 1);  // by time base; 0: it is whole
  for (std::size_t base = 0; base <= trace.other_times.size(); ++base) {
    std::vector<double>& stamps = base == 0 ? thin.time : thin.other_times[base - 1];
    if (step == 1 || StaysWhole(stamps)) continue;
    const double last = stamps.back();
    stamps = EveryNth(stamps, step);
    std::vector<double> ends = EveryNth(stamps, kInStretch);
    if (ends.back() < last) ends.push_back(last);  // behind which nothing is left over
    thin.other_times.push_back(std::move(ends));
    stretches_of[base] = thin.other_times.size();
  }
  for (const trace::Signal& signal : trace.signals) {
    thin.signals.push_back(signal);
    const std::size_t own = stretches_of[signal.time_base];
    if (own == 0) continue;
    const std::span<const double> all = trace.TimeOf(signal);
    std::optional<std::vector<double>> samples = SamplesAt(thin.TimeOf(signal), all, signal.values);
    std::optional<Stretches> of = StretchesOf(thin.other_times[own - 1], all, signal.values);
    if (!samples || !of) continue;  // its stamps do not rise: that is for the writer to say
    thin.signals.back().values = *std::move(samples);
    const auto names = StretchNames(signal.name);
    std::vector<double>* const values[] = {&of->least, &of->greatest, &of->mean};
    for (std::size_t k = 0; k < names.size(); ++k) {
      trace::Signal one = signal;
      one.name = names[k];
      one.description = "of all samples from behind one stamp up to the next";
      one.values = std::move(*values[k]);
      one.time_base = own;
      thin.signals.push_back(std::move(one));
    }
  }
  return thin;
}

}  // namespace dynoproof
