#include "reports/bench_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/html.h"
#include "reports/score_card.h"

namespace dynoproof::reports {
namespace {

using score::Verdict;

Verdict VerdictOf(const Timed& one) { return one.checks.empty() ? Verdict::kInconclusive : score::Combine(one.checks); }

std::string Sentence(const Timed& one) {
  const Timing& timing = one.timing;
  const std::string seen = fmt::format(
      "{} periods of {:g} us: median {:.2f} us, 99.9 % within {:.2f} us, longest {:.2f} us.", timing.sorted_us.size(),
      one.period_us, timing.Quantile(0.5), timing.Quantile(0.999), timing.Quantile(1.0));
  if (one.checks.empty()) return seen + " The scenario states no [budget], so nothing was compared.";
  return seen + " The machine: " + timing.fitness.Text() + ".";
}

/// The share of periods that took longer, over time, both logarithmic: the longest of 20 000 is as visible as the median.
Picture Longer(const Timed& one) {
  Picture picture{.key = "longer",
                  .title = "How many periods took longer",
                  .note = "lines: the limits of [budget], in us",
                  .x = {"time of a period's work", "us", true},
                  .y = {"share of periods that took longer", "1", true}};
  Curve curve{"share", {}, {}, Curve::Style::kHold};
  const std::vector<double>& times = one.timing.sorted_us;
  const auto count = static_cast<double>(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i + 1 < times.size() && times[i + 1] == times[i]) continue;
    curve.x.push_back(times[i]);
    curve.y.push_back((count - static_cast<double>(i)) / count);  // this one among them: the longest has a place, too
  }
  picture.curves.push_back(std::move(curve));
  const Budget& budget = one.budget;
  for (const auto& [at, name] : {std::pair(budget.step_p50_us, "median"), std::pair(budget.step_p999_us, "99.9 %"),
                                 std::pair(budget.step_max_us, "longest")}) {
    if (at > 0.0) picture.marks.push_back({at, fmt::format("{} {:g}", name, at)});
  }
  if (!times.empty()) {  // whole decades: the labels of the axis are those
    picture.x.from = std::pow(10.0, std::floor(std::log10(std::max(times.front(), 1e-3))));
    picture.x.to = std::pow(10.0, std::ceil(std::log10(2.0 * std::max({times.back(), budget.step_max_us, 1.0}))));
  }
  return picture;
}

}  // namespace

std::string BenchPage(const std::vector<Timed>& timed) {
  Verdict all = timed.empty() ? Verdict::kInconclusive : Verdict::kPass;
  std::string body, names, lead;
  for (const Timed& one : timed) {
    const Verdict verdict = VerdictOf(one);
    all = score::Worse(all, verdict);
    names += (names.empty() ? "" : ", ") + one.id;
    const std::string anchor = Anchor(one.id), said = Badge(verdict) + " " + Escape(Sentence(one));
    if (timed.size() == 1) lead = said;
    body += fmt::format("<section id=\"{}\"><h2>{}</h2>\n", anchor, Escape(one.id));
    if (timed.size() > 1) body += fmt::format("<p>{}</p>\n", said);
    if (!one.checks.empty()) body += ScoreCard(one.checks);
    body += Figures("data-" + anchor, {Longer(one)}, 20'000) + "</section>\n";
  }
  const std::string which = timed.size() == 1 ? names : fmt::format("{} scenarios", timed.size());
  if (timed.size() != 1) lead = Badge(all) + " " + Escape(timed.empty() ? "No scenario states a [budget]." : names);
  return Page(fmt::format("bench of {}: {}", which, score::ToString(all)), lead, BuildLine(), body);
}

}  // namespace dynoproof::reports
