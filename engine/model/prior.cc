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

/// What is said of one number.
struct Stated {
  std::string path;
  const Value* value;
  bool per_record = false;
};

/// Whether a table is one of a prior, and not one of numbers.
bool IsPrior(const Value& table) {
  const Value *spread = table.Find("spread"), *per_record = table.Find("per_record");
  return (spread != nullptr && !spread->is_table()) || (per_record != nullptr && !per_record->is_table());
}

/// Keys with dots and tables in tables say the same.
void Collect(const Value& table, const std::string& before, std::vector<Stated>& found) {
  for (const Value::Entry& entry : table.table()) {
    const std::string path = before.empty() ? entry.key : before + "." + entry.key;
    if (!entry.value.is_table()) {
      found.push_back({path, &entry.value});
    } else if (IsPrior(entry.value)) {
      const Value* per_record = entry.value.Find("per_record");
      found.push_back({path, &entry.value, per_record != nullptr && per_record->is_bool() && per_record->boolean()});
    } else {
      Collect(entry.value, path, found);
    }
  }
}

std::vector<Stated> StatedPriors(const Plan& plan) {
  std::vector<Stated> found;
  const Value* table = plan.root.Find("prior");
  if (table != nullptr && table->is_table()) Collect(*table, "", found);
  return found;
}

/// "2 %", alone or as the `spread` of a table; empty where that is no text.
std::string TextOf(const Stated& one) {
  return one.value->is_string() ? one.value->string() : one.value->is_table() ? one.value->TextOr("spread") : "";
}

/// The faults of a prior that is a table.
void CheckTable(const Stated& one, Diagnostics& diagnostics) {
  for (const Value::Entry& entry : one.value->table()) {
    if (entry.key == "per_record" && !entry.value.is_bool())
      diagnostics.Error(entry.where, fmt::format("per_record of \"{}\" is neither true nor false", one.path));
    if (entry.key != "spread" && entry.key != "per_record")
      diagnostics.Error(entry.where, fmt::format("unknown key \"{}\" in the prior of \"{}\"", entry.key, one.path),
                        "known keys: spread, per_record");
  }
  if (one.per_record && !TextOf(one).ends_with("%"))
    diagnostics.Error(one.value->where(),
                      fmt::format("how much \"{}\" differs from record to record is not said", one.path),
                      "write { spread = \"5 %\", per_record = true }: without a share there is no common value");
}

}  // namespace

void CheckPriors(const Plan& plan, Diagnostics& diagnostics) {
  SectionTable(plan, "prior", "write [prior] with \"path.to.number\" = \"2 %\"", diagnostics);
  for (const Stated& one : StatedPriors(plan)) {
    const Value* number = plan.root.FindPath(one.path);
    if (number == nullptr || !number->is_number()) {
      diagnostics.Error(one.value->where(), fmt::format("there is no number \"{}\" in the scenario", one.path),
                        "dynoproof describe SCENARIO lists them");
    } else if (number->number() == 0.0 && TextOf(one).ends_with("%")) {
      diagnostics.Error(one.value->where(), fmt::format("\"{}\" is 0, and a share of it says nothing", one.path),
                        "write a number that it may be");
    }
    if (one.value->is_table()) CheckTable(one, diagnostics);
    if (!one.per_record && !SpreadOf(TextOf(one)))
      diagnostics.Error(
          one.value->where(), fmt::format("the prior of \"{}\" is none", one.path),
          "write \"2 %\" (above 0, up to 100 %), \"fitted\" or \"free\"; or a table of spread and per_record");
  }
}

std::vector<NuisanceParameter> NuisancesWithPriors(const PlantTraits& plant, const Plan& plan) {
  std::vector<NuisanceParameter> all = plant.nuisances ? plant.nuisances(plan) : std::vector<NuisanceParameter>();
  for (const Stated& one : StatedPriors(plan)) {
    const std::optional<double> spread = SpreadOf(TextOf(one));
    if (!spread || one.per_record) continue;
    const auto own = std::ranges::find(all, one.path, &NuisanceParameter::path);
    if (own == all.end()) {
      all.push_back({one.path, true, *spread, "stated in [prior]"});
    } else if (!own->initial) {
      *own = {one.path, true, *spread, "stated in [prior]"};
    }
  }
  return all;
}

std::vector<NumberThatDiffers> NumbersThatDiffer(const Plan& plan) {
  std::vector<NumberThatDiffers> numbers;
  for (const Stated& one : StatedPriors(plan)) {
    const std::optional<double> spread = one.per_record ? SpreadOf(TextOf(one)) : std::nullopt;
    if (spread) numbers.push_back({one.path, *spread});
  }
  return numbers;
}

bool PriorIsStated(const Plan& plan, const std::string& path) {
  return std::ranges::any_of(StatedPriors(plan),
                             [&](const Stated& one) { return one.path == path && !one.per_record; });
}

}  // namespace dynoproof
