#include "probe/proposal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace dynoproof::probe {
namespace {

constexpr double kNarrowest = 1e-7;  // the default of golden traces, which builds keep by a factor of 75 (ci/spread.py)
constexpr double kBuilds = 10.0;     // times what two solvers are apart
constexpr double kMargin = 0.5;      // of the usual strength: what is proposed halves the limit at least

double RoundedDown(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)));
  return std::stod(fmt::format("{:.0e}", std::floor(value / unit * (1.0 + 1e-12)) * unit));
}

std::string NameOf(const Finding& hole) { return fmt::format("{} at {}", hole.name, hole.place); }

/// How wide the tube of an output may be to see the hole; nothing where a build would leave it.
std::optional<double> WidthFor(const Finding& hole, const std::string& output, double apart) {
  const auto reach = hole.reach.find(output);
  const double floor = std::max(kNarrowest, kBuilds * apart);
  if (reach == hole.reach.end() || !(kMargin * reach->second >= floor)) return std::nullopt;
  return kMargin * reach->second;
}

}  // namespace

std::vector<Proposal> Propose(const std::vector<Finding>& findings, const std::map<std::string, double>& apart) {
  std::vector<const Finding*> left;
  for (const Finding& one : findings) {
    if (one.IsHole()) left.push_back(&one);
  }
  std::vector<Proposal> proposals;
  while (!left.empty()) {
    std::string best;
    std::vector<const Finding*> seen;
    for (const auto& [output, distance] : apart) {
      std::vector<const Finding*> sees;
      for (const Finding* hole : left) {
        if (WidthFor(*hole, output, distance)) sees.push_back(hole);
      }
      if (sees.size() > seen.size()) best = output, seen = std::move(sees);
    }
    if (seen.empty()) break;
    Proposal proposal{best, std::numeric_limits<double>::infinity(), apart.at(best), {}};
    for (const Finding* hole : seen) {
      proposal.relative_width = std::min(proposal.relative_width, *WidthFor(*hole, best, proposal.builds));
      if (std::ranges::count(proposal.sees, NameOf(*hole)) == 0) proposal.sees.push_back(NameOf(*hole));
    }
    proposal.relative_width = std::max(RoundedDown(proposal.relative_width), kNarrowest);
    proposals.push_back(std::move(proposal));
    std::erase_if(left, [&](const Finding* hole) { return std::ranges::count(seen, hole) > 0; });
  }
  return proposals;
}

std::string ToLines(const std::vector<Proposal>& proposals, bool states_golden) {
  std::string text;
  if (!states_golden) text += "# in the scenario, before dynoproof bless\n[[check]]\nkind = \"golden\"\n\n";
  text += "# in its golden tolerances (.golden.toml, or golden/ID.toml)\n";
  for (const Proposal& one : proposals)
    text += fmt::format(
        "[signal.{}]\nrelative_width = {:g}\norigin = \"half of what {} would do at its usual strength; two solvers "
        "are {:.1g} apart\"\n\n",
        one.output, one.relative_width,
        one.sees.size() == 1 ? one.sees.front() : fmt::format("the least of {} errors", one.sees.size()), one.builds);
  return text;
}

}  // namespace dynoproof::probe
