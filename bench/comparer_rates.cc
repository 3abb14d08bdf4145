// How much the comparison with golden traces sees: every signal of every shipped golden trace, in a run that passes, is
// altered in known ways, and the altered run is compared as `run` compares it. ci/comparer_rates.py calls it.
//
//   comparer_rates GOLDEN RUNS: folders of golden data and of traces of `run`, both <family>/<case>.h5
//
// Prints JSON: {"traces", "signals", "rates": [{"kind", "size", "of", "seen", "total"}]}; sizes in half-widths of the
// tube, or in ranges of the signal. A shift of one sample counts where it changes the signal by more than the tube.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <tuple>

#include "base/random.h"
#include "experiment/golden.h"
#include "experiment/thin.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

constexpr std::uint64_t kSeed = 45;
constexpr int kSpikes = 2;  // of each size in each signal

struct Rate {
  int seen = 0, total = 0;
};
/// By kind, size, and what the size is a multiple of.
using Rates = std::map<std::tuple<std::string, double, std::string>, Rate>;

/// A trace with one signal alone, and what a golden trace tells of what lies between its samples.
trace::Trace Alone(const trace::Trace& trace, const trace::Signal& signal) {
  trace::Trace alone;
  const std::span<const double> time = trace.TimeOf(signal);
  alone.time.assign(time.begin(), time.end());
  alone.signals.push_back(signal);
  for (const std::string& name : StretchNames(signal.name)) {
    const trace::Signal* stretches = trace.Find(name);
    if (stretches == nullptr) continue;
    if (alone.other_times.empty()) {
      const std::span<const double> ends = trace.TimeOf(*stretches);
      alone.other_times.emplace_back(ends.begin(), ends.end());
    }
    alone.signals.push_back(*stretches);
    alone.signals.back().time_base = 1;
  }
  alone.signals[0].time_base = 0;
  return alone;
}

class Signals {
 public:
  Signals(trace::Trace golden, trace::Trace run, SignalTolerance tolerance, Rates& rates)
      : golden_(std::move(golden)), run_(std::move(run)), tolerance_(std::move(tolerance)), rates_(rates) {
    const std::vector<double>& values = Values();
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    range_ = *most - *least;
    largest_ = std::max(std::abs(*least), std::abs(*most));
    width_ = tolerance_.relative_width * golden_.signals[0].nominal;
  }

  bool Passes(const trace::Trace& run) const {
    const auto checks =
        CompareTraces(golden_, run, {{golden_.signals[0].name, tolerance_}}, "golden", ReferenceIs::kThinned);
    return score::Combine(checks) == score::Verdict::kPass;
  }
  bool Sound() const { return Passes(run_); }

  void Alter(std::uint64_t stream) {
    for (const double size : {1.5, 10.0}) {
      Count("offset", size, "half-widths", [&](std::vector<double>& v) {
        for (double& value : v) value += size * width_;
      });
      if (largest_ > 0.0) {
        Count("scale", size, "half-widths", [&](std::vector<double>& v) {
          for (double& value : v) value *= 1.0 + size * width_ / largest_;
        });
      }
    }
    double step = 0.0;
    for (std::size_t i = 0; i + 1 < Values().size(); ++i)
      step = std::max(step, std::abs(Values()[i + 1] - Values()[i]));
    if (step > 1.5 * width_) {
      Count("one sample late", 0.0, "", [](std::vector<double>& v) {
        std::rotate(v.begin(), v.end() - 1, v.end());
        v.front() = v[1];
      });
    }
    const std::vector<std::size_t> kept = Kept();
    for (int i = 0; i < kSpikes; ++i) {
      const std::uint64_t bits = RandomBits(kSeed, stream, static_cast<std::uint64_t>(i));
      for (const double size : {1.5, 10.0})
        Spike("spike at a kept sample", size, "half-widths", kept[bits % kept.size()], size * width_);
      if (kept.size() == Values().size()) continue;
      std::size_t at = bits % Values().size();
      while (std::binary_search(kept.begin(), kept.end(), at)) at = (at + 1) % Values().size();
      for (const double size : {10.0, 100.0, 1000.0})
        Spike("spike between kept samples", size, "half-widths", at, size * width_);
      for (const double size : {0.01, 0.1}) {
        if (range_ > 0.0) Spike("spike between kept samples", size, "ranges", at, size * range_);
      }
    }
  }

 private:
  const std::vector<double>& Values() const { return run_.signals[0].values; }

  /// The run's samples that the golden trace has.
  std::vector<std::size_t> Kept() const {
    std::vector<std::size_t> kept;
    std::size_t i = 0;
    for (const double time : golden_.time) {
      while (i + 1 < run_.time.size() && std::abs(run_.time[i + 1] - time) <= std::abs(run_.time[i] - time)) ++i;
      kept.push_back(i);
    }
    return kept;
  }

  void Spike(const char* kind, double size, const char* of, std::size_t at, double height) {
    Count(kind, size, of, [&](std::vector<double>& v) { v[at] += v[at] < 0.0 ? -height : height; });
  }

  void Count(const char* kind, double size, const char* of, const std::function<void(std::vector<double>&)>& change) {
    trace::Trace altered = run_;
    change(altered.signals[0].values);
    Rate& rate = rates_[{kind, size, of}];
    ++rate.total;
    rate.seen += Passes(altered) ? 0 : 1;
  }

  trace::Trace golden_, run_;
  SignalTolerance tolerance_;
  Rates& rates_;
  double range_ = 0.0, largest_ = 0.0, width_ = 0.0;
};

int Main(const std::filesystem::path& golden_folder, const std::filesystem::path& run_folder) {
  Rates rates;
  std::uint64_t signals = 0;
  int traces = 0;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(golden_folder)) {
    if (entry.path().extension() == ".h5") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    std::filesystem::path toml = file;
    toml.replace_extension(".toml");
    if (!std::filesystem::exists(toml)) continue;  // no golden data: an oracle
    const auto run = trace::ReadTrace(run_folder / std::filesystem::relative(file, golden_folder));
    const auto golden = trace::ReadTrace(file);
    const auto tolerances = ReadTolerances(toml.string());
    for (const std::string& fault :
         {golden.ok() ? "" : golden.failure().ToString(), run.ok() ? "" : run.failure().ToString(),
          tolerances.ok() ? "" : tolerances.failure().ToString()}) {
      if (fault.empty()) continue;
      fmt::print(stderr, "{}: {}\n", file.string(), fault);
      return 2;
    }
    ++traces;
    const SignalTolerances widths = tolerances->For(run->provenance.Text("solver").value_or(""));
    for (const trace::Signal& signal : golden->signals) {
      if (IsOfStretches(*golden, signal)) continue;
      const trace::Signal* of_run = run->Find(signal.name);
      if (of_run == nullptr || !widths.contains(signal.name)) {
        fmt::print(stderr, "{}: \"{}\" is not in the run or has no tolerance\n", file.string(), signal.name);
        return 2;
      }
      Signals one(Alone(*golden, signal), Alone(*run, *of_run), widths.at(signal.name), rates);
      if (!one.Sound()) {
        fmt::print(stderr, "{}: \"{}\" fails as it stands\n", file.string(), signal.name);
        return 1;
      }
      one.Alter(signals++);
    }
  }
  fmt::print("{{\"traces\": {}, \"signals\": {}, \"rates\": [", traces, signals);
  const char* comma = "";
  for (const auto& [key, rate] : rates) {
    const auto& [kind, size, of] = key;
    fmt::print("{}\n  {{\"kind\": \"{}\", \"size\": {}, \"of\": \"{}\", \"seen\": {}, \"total\": {}}}", comma, kind,
               size, of, rate.seen, rate.total);
    comma = ",";
  }
  fmt::print("\n]}}\n");
  return traces > 0 ? 0 : 2;
}

}  // namespace
}  // namespace dynoproof

int main(int count, char** words) {
  if (count != 3) {
    std::fputs("usage: comparer_rates GOLDEN RUNS\n", stderr);
    return 2;
  }
  return dynoproof::Main(words[1], words[2]);
}
