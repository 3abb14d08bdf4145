#include "plugins/source/replay/replay.h"

#include <algorithm>
#include <cmath>

namespace dynoproof::sources {

PluginInfo Replay::Info() {
  return {"source",
          "replay",
          "a recorded signal, held or interpolated",
          "values[i] for times[i] <= t < times[i+1], or the straight line between them",
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
  return std::make_unique<Replay>(std::move(series), params.interpolation == "linear");
}

double Replay::Value(double time_s) const {
  const std::vector<double>& times = *series_.time;
  const std::vector<double>& values = *series_.values;
  const auto next = std::upper_bound(times.begin(), times.end(), time_s + kTimeSlack);
  if (next == times.begin()) return values.front();
  const std::size_t i = next - times.begin() - 1;
  if (next == times.end() || !linear_) return values[i];
  const double share = std::clamp((time_s - times[i]) / (times[i + 1] - times[i]), 0.0, 1.0);
  return values[i] + share * (values[i + 1] - values[i]);
}

}  // namespace dynoproof::sources
