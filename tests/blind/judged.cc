#include "tests/blind/judged.h"

#include <algorithm>
#include <set>
#include <vector>

#include "model/effect.h"
#include "score/series.h"

namespace dynoproof::blind {
namespace {

using nlohmann::json;
using Names = std::set<std::string>;

/// Causes that a set names together: "a@b + c@d".
Names TogetherIn(const std::string& names) {
  constexpr std::string_view kAnd = " + ";
  Names causes;
  for (std::size_t from = 0; from <= names.size();) {
    const std::size_t to = std::min(names.find(kAnd, from), names.size());
    causes.insert(names.substr(from, to - from));
    from = to + kAnd.size();
  }
  return causes;
}

std::string NameOf(const std::string& effect, const std::string& at) { return effect + "@" + at; }

Names CausesOf(const Case& hidden) {
  Names truth;
  for (const Cause& cause : hidden.causes) truth.insert(NameOf(cause.effect, cause.at));
  return truth;
}

/// Names with those of the truth's own family called as the truth is, and without what stands for what is inexact.
Names AsTruth(const Case& hidden, const Names& names) {
  const Names truth = CausesOf(hidden);
  Names left;
  for (const std::string& name : names) {
    const std::size_t at = name.find('@');
    const bool of_the_family = hidden.any_friction && truth.size() == 1 && name.substr(0, at).ends_with("_friction") &&
                               !name.starts_with("viscous") && name.substr(at + 1) == hidden.causes[0].at;
    if (of_the_family)
      left.insert(*truth.begin());
    else if (truth.contains(name) || !hidden.near.contains(name.substr(at + 1)))
      left.insert(name);
  }
  return left;
}

}  // namespace

std::string Judged(const Case& hidden, const json& result) {
  const std::string verdict = result.value("verdict", "broken");
  if (verdict == "broken") return "broken";
  if (hidden.kind == "unknown") return verdict == "effect_found" || verdict == "no_effect" ? "wrong" : "abstained";
  const bool inexact = !hidden.inexact.empty();
  const Names truth = CausesOf(hidden);
  if (verdict == "effect_found" || (inexact && verdict == "main_cause")) {
    Names named;
    for (const json& one : result["effects"])
      named.insert(NameOf(one["name"].get<std::string>(), one["at"].get<std::string>()));
    const Names left = AsTruth(hidden, named);
    if (truth.empty()) return left.empty() ? "near" : "false alarm";
    return left == truth ? "right" : "wrong";
  }
  if (verdict == "ambiguous") {
    bool near = inexact;
    for (const json& set : result["ambiguous_with"]) {
      for (const json& one : set) {
        const Names left = AsTruth(hidden, TogetherIn(one.get<std::string>()));
        if (!truth.empty() && left == truth) return "in the set";
        near = near && left.empty();
      }
    }
    return !truth.empty() ? "wrong" : near ? "near" : "false alarm";
  }
  if (truth.empty()) return verdict == "no_effect" ? "right" : verdict == "unexplained" ? "abstained" : "false alarm";
  return verdict == "no_effect" ? "missed" : "abstained";
}

std::pair<int, int> Covered(const Case& hidden, const json& result, const Registry& registry) {
  std::pair<int, int> inside;
  for (const Cause& cause : hidden.causes) {
    for (const json& found : result["effects"]) {
      if (found["name"] != cause.effect || found["at"] != cause.at) continue;
      const Effect& effect = *registry.FindEffect(cause.effect);
      for (std::size_t i = 0; i < cause.parameters.size(); ++i, ++inside.second) {
        const json& ci = found["parameters"][effect.info().parameters[i].name]["ci95"];
        inside.first +=
            cause.parameters[i] >= ci[0].get<double>() && cause.parameters[i] <= ci[1].get<double>() ? 1 : 0;
      }
    }
  }
  return inside;
}

bool AtNoise(const Case& hidden, const json& result, const Columns& columns, const Columns& clean) {
  for (const auto& [name, values] : columns.outputs) {
    const std::vector<double> held(
        values.begin() + static_cast<std::ptrdiff_t>(0.7 * static_cast<double>(values.size())), values.end());
    const double error = result["gain"]["holdout"][name]["nrmse_after"].get<double>() * score::StandardDeviation(held);
    if (!(error <= 1.1 * hidden.noise * score::StandardDeviation(clean.outputs.at(name)))) return false;
  }
  return true;
}

std::string TruthOf(const Case& hidden) {
  std::string text;
  for (const Cause& cause : hidden.causes) text += (text.empty() ? "" : " + ") + NameOf(cause.effect, cause.at);
  return !text.empty() ? text : !hidden.unknown.empty() ? hidden.unknown : hidden.kind;
}

}  // namespace dynoproof::blind
