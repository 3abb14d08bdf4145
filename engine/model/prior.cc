#include "model/prior.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "model/section.h"

namespace dynoproof {
namespace {

// A number that was fitted has swallowed what the model lacked, whatever that was: a factor of 1.6 either way is usual then.
constexpr double kFittedSpread = 0.5;

/// The spread that a text states; nothing: it states none.
std::optional<double> SpreadOf(std::string_view text) {
  if (text == "free") return kNoPrior;
  if (text == "fitted") return kFittedSpread;
  double percent = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), percent);
  std::string_view rest = text.substr(static_cast<std::size_t>(end - text.data()));
  rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  constexpr double kMost = 100.0;
  if (error != std::errc() || rest != "%" || !(percent > 0.0 && percent <= kMost)) return std::nullopt;
  return percent / 100.0;
}

struct Stated {
  std::string path;
  const Value* value;
};

/// Keys with dots and tables in tables say the same.
void Collect(const Value& table, const std::string& before, std::vector<Stated>& found) {
  for (const Value::Entry& entry : table.table()) {
    const std::string path = before.empty() ? entry.key : before + "." + entry.key;
    if (entry.value.is_table()) {
      Collect(entry.value, path, found);
    } else {
      found.push_back({path, &entry.value});
    }
  }
}

std::vector<Stated> StatedPriors(const Plan& plan) {
  std::vector<Stated> found;
  const Value* table = plan.root.Find("prior");
  if (table != nullptr && table->is_table()) Collect(*table, "", found);
  return found;
}

}  // namespace

void CheckPriors(const Plan& plan, Diagnostics& diagnostics) {
  SectionTable(plan, "prior", "write [prior] with \"path.to.number\" = \"2 %\"", diagnostics);
  for (const Stated& one : StatedPriors(plan)) {
    const Value* number = plan.root.FindPath(one.path);
    if (number == nullptr || !number->is_number()) {
      diagnostics.Error(one.value->where(), fmt::format("there is no number \"{}\" in the scenario", one.path),
                        "dynoproof describe SCENARIO lists them");
    } else if (number->number() == 0.0 && one.value->is_string() && one.value->string().ends_with("%")) {
      diagnostics.Error(one.value->where(), fmt::format("\"{}\" is 0, and a share of it says nothing", one.path),
                        "write a number that it may be");
    }
    if (!one.value->is_string() || !SpreadOf(one.value->string()))
      diagnostics.Error(one.value->where(), fmt::format("the prior of \"{}\" is none", one.path),
                        "write \"2 %\" (above 0, up to 100 %), \"fitted\" or \"free\"");
  }
}

std::vector<NuisanceParameter> NuisancesWithPriors(const PlantTraits& plant, const Plan& plan) {
  std::vector<NuisanceParameter> all = plant.nuisances ? plant.nuisances(plan) : std::vector<NuisanceParameter>();
  for (const Stated& one : StatedPriors(plan)) {
    const std::optional<double> spread = one.value->is_string() ? SpreadOf(one.value->string()) : std::nullopt;
    if (!spread) continue;
    const auto own = std::ranges::find(all, one.path, &NuisanceParameter::path);
    if (own == all.end()) {
      all.push_back({one.path, true, *spread, "stated in [prior]"});
    } else if (!own->initial) {
      *own = {one.path, true, *spread, "stated in [prior]"};
    }
  }
  return all;
}

bool PriorIsStated(const Plan& plan, const std::string& path) {
  return std::ranges::any_of(StatedPriors(plan), [&](const Stated& one) { return one.path == path; });
}

}  // namespace dynoproof
