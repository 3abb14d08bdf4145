#include "reports/compare_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "experiment/pictures.h"
#include "reports/html.h"
#include "reports/score_card.h"

namespace dynoproof::reports {

std::string ComparePage(const std::string& a, const std::string& b, const trace::Trace& reference,
                        const trace::Trace& test, const ScenarioResult& judged) {
  const auto part = std::ranges::count_if(
      judged.checks, [](const score::Check& check) { return check.verdict != score::Verdict::kPass; });
  const std::string said = part == 0 ? fmt::format("all {} signals agree", judged.checks.size())
                                     : fmt::format("{} of {} signals do not agree", part, judged.checks.size());
  std::string lead = Badge(judged.verdict) + " " + Escape(fmt::format("A is {}, the reference; B is {}", a, b));
  for (const std::string& note : judged.notes) lead += "<br>Note: " + Escape(note);
  const RunPictures pictures = PicturesOfTraces(reference, test, judged.checks);
  std::string body = "<section id=\"checks\"><h2>Signals</h2>\n" + ScoreCard(judged.checks) +
                     "</section>\n<section id=\"pictures\"><h2>One over the other</h2>\n" +
                     Figures("traces", pictures.pictures, 200'000);
  if (!pictures.constant.empty())
    body +=
        "<p class=\"note\">The same at all times: " + Escape(fmt::format("{}", fmt::join(pictures.constant, ", "))) +
        "</p>\n";
  return Page(fmt::format("{} compared with {}: {}", b, a, said), lead, BuildLine(), body + "</section>\n");
}

}  // namespace dynoproof::reports
