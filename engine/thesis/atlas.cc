#include "thesis/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "scenario/find.h"
#include "scenario/load.h"
#include "thesis/drawings.h"

namespace dynoproof {
namespace {

std::string FileOf(const std::string& scenario) {
  return (std::filesystem::path(ScenarioFolder()) / (scenario + ".toml")).string();
}

Result<RunPictures> PicturesOfScenario(const Registry& registry, const std::string& scenario) {
  Diagnostics diagnostics;
  const std::unique_ptr<Prepared> prepared = Prepare(FileOf(scenario), {}, registry, diagnostics);
  if (prepared == nullptr) return Failure{.message = diagnostics.Format(), .signal = scenario, .exit_code = 2};
  return PicturesOf(*prepared);
}

/// "5.19", "B.2" as chapter and number within it; zeros for other words.
std::pair<char, int> Parse(const std::string& number) {
  char chapter = 0;
  int within = 0;
  if (std::sscanf(number.c_str(), "%c.%d", &chapter, &within) != 2) return {0, 0};
  return {chapter, within};
}

/// Leaves the figure's curves in the picture, in the figure's order. Returns the label that the picture does not have.
std::string Keep(const AtlasFigure& figure, Picture& picture) {
  if (figure.curves.empty()) return "";
  std::vector<Curve> kept;
  for (const std::string& label : figure.curves) {
    const auto found = std::find_if(picture.curves.begin(), picture.curves.end(),
                                    [&](const Curve& one) { return one.label == label; });
    if (found == picture.curves.end()) return label;
    kept.push_back(std::move(*found));
    kept.back().shown = true;
  }
  picture.curves = std::move(kept);
  return "";
}

/// The picture of that name; of a signal over time the one that it shares with others of its unit, where it has none alone.
std::vector<Picture>::const_iterator FindPicture(const std::vector<Picture>& pictures, const std::string& key) {
  const auto named = std::ranges::find(pictures, key, &Picture::key);
  static constexpr std::string_view kCourse = "time:";
  if (named != pictures.end() || !key.starts_with(kCourse)) return named;
  return std::ranges::find_if(pictures, [signal = key.substr(kCourse.size())](const Picture& one) {
    return one.key.starts_with(kCourse) && std::ranges::find(one.curves, signal, &Curve::label) != one.curves.end();
  });
}

/// Puts the pictures of a figure's scenario number `i` into their places.
void PutIn(const RunPictures& run, std::size_t i, DrawnFigure& drawn) {
  const AtlasFigure& figure = drawn.figure;
  const std::string& label = figure.labels.empty() ? figure.scenarios[i] : figure.labels[i];
  for (std::size_t k = 0; k < figure.pictures.size(); ++k) {
    const auto found = FindPicture(run.pictures, figure.pictures[k]);
    if (found == run.pictures.end()) {
      drawn.fault = fmt::format("{} has no picture \"{}\"", figure.scenarios[i], figure.pictures[k]);
      continue;
    }
    if (!figure.overlay) {
      Picture& place = drawn.pictures[k * figure.scenarios.size() + i];
      place = *found;
      if (const std::string absent = Keep(figure, place); !absent.empty())
        drawn.fault = fmt::format("\"{}\" of {} has no curve \"{}\"", found->key, figure.scenarios[i], absent);
      if (std::isfinite(figure.from)) place.x.from = figure.from;
      if (std::isfinite(figure.to)) place.x.to = figure.to;
      if (figure.scenarios.size() > 1) place.title = label + ": " + place.title;
      continue;
    }
    Picture& shared = drawn.pictures[k];
    std::vector<Curve> curves = std::move(shared.curves);
    if (curves.empty()) shared = *found;
    for (Curve curve : found->curves) {
      if (curve.style == Curve::Style::kSamples) continue;  // the golden samples of each would only crowd it
      curve.label = fmt::format("{}, {}", label, curve.label);
      curves.push_back(std::move(curve));
    }
    shared.curves = std::move(curves);
  }
}

/// Least and greatest value in sight of the curves that are shown at first; the first above the second where there is none.
std::pair<double, double> InSight(const Picture& picture) {
  std::pair<double, double> range = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Curve& curve : picture.curves) {
    for (std::size_t i = 0; curve.shown && i < curve.y.size(); ++i) {
      const bool inside =
          (!picture.x.from || curve.x[i] >= *picture.x.from) && (!picture.x.to || curve.x[i] <= *picture.x.to);
      if (!inside || !std::isfinite(curve.y[i]) || (picture.y.logarithmic && !(curve.y[i] > 0.0))) continue;
      range = {std::min(range.first, curve.y[i]), std::max(range.second, curve.y[i])};
    }
  }
  return range;
}

/// Pictures of one quantity, of several setups side by side, are compared by eye: they share their ordinate.
void ShareOrdinate(std::span<Picture> pictures) {
  constexpr double kRoom = 0.05;  // of the range, at either end
  std::pair<double, double> all = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Picture& one : pictures) {
    if (one.y.label != pictures[0].y.label || one.y.logarithmic != pictures[0].y.logarithmic || one.y.from) return;
    const auto [least, most] = InSight(one);
    all = {std::min(all.first, least), std::max(all.second, most)};
  }
  if (!(all.first < all.second)) return;
  const bool log = pictures[0].y.logarithmic;
  const double room = kRoom * (log ? std::log(all.second / all.first) : all.second - all.first);
  for (Picture& one : pictures) {
    one.y.from = log ? all.first * std::exp(-room) : all.first - room;
    one.y.to = log ? all.second * std::exp(room) : all.second + room;
  }
}

}  // namespace

std::vector<std::string> NumbersIn(const std::string& place, const std::string& kind) {
  constexpr std::array kKinds = {"Fig", "Table", "Sec", "App", "footnote"};
  std::vector<std::string> numbers;
  std::pair<char, int> last = {0, 0};
  bool wanted = false;
  for (std::size_t at = 0; at < place.size();) {
    // Numbers belong to the last kind of place that was named; an equation, "(2.111)", ends it.
    for (const std::string word : kKinds) {
      if (place.compare(at, word.size(), word) == 0) wanted = word == kind;
    }
    const bool begins = at == 0 || !std::isalnum(static_cast<unsigned char>(place[at - 1]));
    if (place[at] == '(' && begins) wanted = false;
    const std::pair<char, int> found = wanted && begins ? Parse(place.substr(at)) : std::pair<char, int>{0, 0};
    if (found.first == 0) {
      ++at;
      continue;
    }
    const bool range = !numbers.empty() && place[at - 1] == '-' && last.first == found.first;
    for (int n = range ? last.second + 1 : found.second; n <= found.second; ++n) {
      numbers.push_back(fmt::format("{}.{}", found.first, n));
    }
    last = found;
    at = std::min(place.find_first_not_of("0123456789", at + 2), place.size());
  }
  return numbers;
}

bool Names(const std::string& place, const std::string& number) {
  const std::vector<std::string> numbers = NumbersIn(place, "Fig");
  return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
}

std::vector<AtlasFigure> ReadFigures(const std::string& file, Diagnostics& diagnostics) {
  std::vector<AtlasFigure> figures;
  const std::optional<Plan> plan = LoadPlan(file, {}, diagnostics);
  const Value* tables = plan ? plan->root.Find("figure") : nullptr;
  if (tables == nullptr || !tables->is_array()) {
    if (plan) diagnostics.Error({file}, "there is no [[figure]]");
    return figures;
  }
  std::set<std::string> numbers;
  for (const Value& table : tables->array()) {
    AtlasFigure figure;
    figure.where = table.where();
    if (!ReadParams(table, figure, diagnostics, "figure")) continue;
    if (!numbers.insert(figure.number).second)
      diagnostics.Error(figure.where, fmt::format("a second figure {}", figure.number));
    for (const std::string& scenario : figure.scenarios) {
      if (!std::filesystem::exists(FileOf(scenario)))
        diagnostics.Error(figure.where, fmt::format("there is no scenario \"{}\"", scenario), "see: dynoproof list");
    }
    for (const std::string& drawing : figure.drawings) {
      if (!Drawings().contains(drawing))
        diagnostics.Error(figure.where, fmt::format("there is no drawing \"{}\"", drawing));
    }
    if (figure.scenarios.empty() != figure.pictures.empty() || (figure.scenarios.empty() && figure.drawings.empty()))
      diagnostics.Error(figure.where, "needs scenarios with pictures, or drawings");
    if (figure.overlay && (!figure.curves.empty() || std::isfinite(figure.from) || std::isfinite(figure.to)))
      diagnostics.Error(figure.where, "an overlay keeps all curves and its whole abscissa",
                        "leave out curves, from, to");
    if (!figure.labels.empty() && figure.labels.size() != figure.scenarios.size())
      diagnostics.Error(figure.where, "needs as many labels as scenarios, or none");
    figures.push_back(std::move(figure));
  }
  return figures;
}

std::vector<DrawnFigure> Draw(const Registry& registry, const std::vector<AtlasFigure>& figures,
                              const std::function<void(const std::string&, double)>& progress) {
  std::vector<DrawnFigure> drawn;
  std::vector<std::string> scenarios;  // each once, in the order of first need
  for (const AtlasFigure& figure : figures) {
    drawn.push_back({figure});
    drawn.back().pictures.resize(figure.pictures.size() * (figure.overlay ? 1 : figure.scenarios.size()));
    for (const std::string& scenario : figure.scenarios) {
      if (std::find(scenarios.begin(), scenarios.end(), scenario) == scenarios.end()) scenarios.push_back(scenario);
    }
  }
  for (std::size_t n = 0; n < scenarios.size(); ++n) {
    if (progress) progress(scenarios[n], static_cast<double>(n) / static_cast<double>(scenarios.size()));
    const Result<RunPictures> run = PicturesOfScenario(registry, scenarios[n]);
    for (DrawnFigure& one : drawn) {
      const auto at = std::find(one.figure.scenarios.begin(), one.figure.scenarios.end(), scenarios[n]);
      if (at == one.figure.scenarios.end()) continue;
      if (run.ok()) {
        PutIn(*run, static_cast<std::size_t>(at - one.figure.scenarios.begin()), one);
      } else {
        one.fault = run.failure().ToString();
      }
    }
  }
  for (DrawnFigure& one : drawn) {
    const std::size_t setups = one.figure.scenarios.size();
    for (std::size_t k = 0; !one.figure.overlay && setups > 1 && k < one.figure.pictures.size(); ++k)
      ShareOrdinate(std::span(one.pictures).subspan(k * setups, setups));
    for (const std::string& name : one.figure.drawings) {
      Result<Picture> drawing = Drawings().at(name)(registry);
      if (drawing.ok()) {
        one.pictures.push_back(std::move(*drawing));
      } else {
        one.fault = drawing.failure().ToString();
      }
    }
  }
  return drawn;
}

}  // namespace dynoproof
