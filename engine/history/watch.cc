#include "history/watch.h"

#include <algorithm>
#include <limits>

namespace dynoproof::history {
namespace {

Finding::Kind KindOf(Sense sense, double before, double after) {
  if (sense == Sense::kNeither) return Finding::Kind::kChanged;
  return (after > before) == (sense == Sense::kLessIsBetter) ? Finding::Kind::kWorse : Finding::Kind::kBetter;
}

bool IsTiming(const std::string& series) {
  return !series.starts_with("score/") && !series.starts_with("figure/") && !series.starts_with("coverage/");
}

}  // namespace

std::string ToString(Finding::Kind kind) {
  switch (kind) {
    case Finding::Kind::kWorse:
      return "worse";
    case Finding::Kind::kBetter:
      return "better";
    case Finding::Kind::kMissing:
      return "missing";
    default:
      return "changed";
  }
}

Watch Look(const History& history, const WatchOptions& options) {
  Watch watch;
  const std::size_t nights = history.nights.size();
  const auto scattering =
      std::count_if(history.series.begin(), history.series.end(), [](const Series& series) { return series.scatters; });
  score::NoiseOptions noise;
  noise.alpha = options.alpha / static_cast<double>(std::max<std::ptrdiff_t>(1, scattering));
  bool worse_score = false, worse_timing = false;
  for (std::size_t s = 0; s < history.series.size(); ++s) {
    const Series& series = history.series[s];
    std::vector<double> values;
    std::vector<std::size_t> at;  // night of each value
    for (std::size_t i = 0; i < series.values.size(); ++i) {
      if (!series.values[i]) continue;
      values.push_back(*series.values[i]);
      at.push_back(series.nights[i]);
    }
    const std::size_t since = at.empty() ? 0 : at.back() + 1;
    // A benchmark that never gave a time is missing, too; a score or a figure may be one that has no number.
    const bool known = !at.empty() || series.scatters;
    const bool goes_on = !series.nights.empty() && series.nights.back() + 1 == nights;
    if (known && since < nights && (goes_on || since + options.recent >= nights)) {
      const double before = values.empty() ? std::numeric_limits<double>::quiet_NaN() : values.back();
      watch.findings.push_back(
          {Finding::Kind::kMissing, s, since, before, std::numeric_limits<double>::quiet_NaN(), 0.0, true});
      worse_score = true;
    }
    noise.relevant = series.relevant;
    const bool enough = series.scatters ? score::CanDecide(values.size(), noise) : values.size() > 1;
    ++(enough ? watch.compared : watch.too_short);
    if (!enough) continue;
    const std::vector<score::LevelChange> changes =
        series.scatters ? score::NoisyChanges(values, noise) : score::ExactChanges(values, series.relevant);
    for (std::size_t c = 0; c < changes.size(); ++c) {
      const score::LevelChange& change = changes[c];
      Finding finding{KindOf(series.sense, change.before, change.after),
                      s,
                      at[change.at],
                      change.before,
                      change.after,
                      change.p,
                      false};
      // Only the level that still holds matters: what was mended since is history.
      finding.recent = c + 1 == changes.size() && finding.night + options.recent >= nights;
      if (finding.recent && finding.kind == Finding::Kind::kWorse) {
        (IsTiming(series.name) ? worse_timing : worse_score) = true;
      }
      watch.findings.push_back(finding);
    }
  }
  std::stable_sort(watch.findings.begin(), watch.findings.end(), [](const Finding& a, const Finding& b) {
    const auto rank = [](const Finding& f) {
      const bool bad = f.kind == Finding::Kind::kWorse || f.kind == Finding::Kind::kMissing;
      return (f.recent ? 0 : 2) + (bad ? 0 : 1);
    };
    return rank(a) < rank(b);
  });
  watch.exit_code = worse_score ? 1 : worse_timing ? 5 : watch.compared > 0 ? 0 : 4;
  return watch;
}

}  // namespace dynoproof::history
