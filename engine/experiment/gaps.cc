#include "experiment/gaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

namespace dynoproof {
namespace {

struct Span {
  double from_s, to_s;
};

/// Where inputs are known, in order.
std::vector<Span> KnownSpans(const MappedRecord& record) {
  std::vector<Span> gaps;
  for (const auto& [name, series] : record.inputs) {
    const auto step = record.step_s.find(name);
    if (step == record.step_s.end()) continue;
    const std::vector<double>& t = *series.time;
    for (std::size_t i = 1; i < t.size(); ++i) {
      if (t[i] - t[i - 1] > (kMostLost + 1.5) * step->second) gaps.push_back({t[i - 1], t[i]});
    }
  }
  std::ranges::sort(gaps, {}, &Span::from_s);
  std::vector<Span> known;
  double from_s = 0.0;
  for (const Span& gap : gaps) {
    if (gap.from_s > from_s) known.push_back({from_s, gap.from_s});
    from_s = std::max(from_s, gap.to_s);
  }
  known.push_back({from_s, record.end_s});
  return known;
}

/// The samples of a span; its beginning becomes 0 s. Instants of a uniform base (`step_s` above 0) stay multiples of that step.
Series Cut(const Series& series, const Span& span, double step_s) {
  const double slack = 1e-9 * (1.0 + span.to_s);
  std::vector<double> time, values;
  for (std::size_t i = 0; i < series.time->size(); ++i) {
    const double t = (*series.time)[i];
    if (t < span.from_s - slack || t > span.to_s + slack) continue;
    const double own = t - span.from_s;
    const double on_grid = step_s > 0.0 ? std::round(own / step_s) * step_s : own;
    time.push_back(std::abs(on_grid - own) < 1e-6 * step_s ? on_grid : own);
    values.push_back((*series.values)[i]);
  }
  return {std::make_shared<const std::vector<double>>(std::move(time)),
          std::make_shared<const std::vector<double>>(std::move(values))};
}

}  // namespace

std::vector<MappedRecord> PartsBetweenGaps(MappedRecord record) {
  const std::vector<Span> spans = KnownSpans(record);
  std::vector<MappedRecord> parts;
  if (spans.size() == 1 && spans[0].from_s == 0.0) return {std::move(record)};
  for (const Span& span : spans) {
    MappedRecord part = record;
    part.end_s = span.to_s - span.from_s;
    std::string few;
    for (auto* signals : {&part.inputs, &part.outputs}) {
      for (auto& [name, series] : *signals) {
        const auto step = record.step_s.find(name);
        series = Cut(series, span, step == record.step_s.end() ? 0.0 : step->second);
        if (few.empty()) few = TooFew(series.time->size());
      }
    }
    if (!few.empty()) continue;
    part.notes = {
        fmt::format("part from {:.6g} to {:.6g} s, a record of its own: behind a gap of more than {} rows nobody knows "
                    "what the inputs have done",
                    span.from_s, span.to_s, kMostLost)};
    parts.push_back(std::move(part));
  }
  if (parts.empty()) return {std::move(record)};
  parts.front().notes.insert(parts.front().notes.begin(), record.notes.begin(), record.notes.end());
  return parts;
}

}  // namespace dynoproof
