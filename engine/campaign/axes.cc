#include "campaign/axes.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "base/text.h"

namespace dynoproof::campaign {
namespace {

constexpr std::uint64_t kSeedStream = 1, kStrataStream = 0x9d5c;

bool Numbers(const std::vector<Value>& values) {
  return std::all_of(values.begin(), values.end(), [](const Value& value) { return value.is_number(); });
}

double Spread(double from, double to, bool logarithmic, double share) {
  return logarithmic ? from * std::pow(to / from, share) : from + (to - from) * share;
}

}  // namespace

std::string TextOf(const Value& value) {
  if (value.is_string()) return value.string();
  if (value.is_bool()) return value.boolean() ? "true" : "false";
  if (value.is_integer()) return fmt::format("{}", value.integer());
  return value.is_number() ? fmt::format("{}", value.number()) : value.KindName();
}

void AxisSpec::Check(Faults& faults) const {
  // As KEY=VALUE it would set the part before the sign, and the key itself would be nowhere.
  if (key.find('=') != std::string::npos)
    faults.At("key", fmt::format("the key \"{}\" has a \"=\"", key), "a dotted path such as plant.inertia.I5");
  int ways = 0;
  for (const bool given : {!list.empty(), !grid.empty(), !choice.empty(), !uniform.empty(), !log_uniform.empty(),
                           !normal.empty(), !log_normal.empty()})
    ways += given ? 1 : 0;
  if (ways != 1) {
    faults.At("key", fmt::format("axis \"{}\" has {} ways to get its values (an empty list is none)", key, ways),
              "give one of list, grid, choice, uniform, log_uniform, normal, log_normal");
  }
  for (const auto& [name, pair] :
       {std::pair("grid", &grid), std::pair("uniform", &uniform), std::pair("log_uniform", &log_uniform),
        std::pair("normal", &normal), std::pair("log_normal", &log_normal)}) {
    if (!pair->empty() && pair->size() != 2)
      faults.At(name, fmt::format("{} has {} numbers", name, pair->size()), "two");
  }
  for (const auto& [name, range] : {std::pair("uniform", &uniform), std::pair("log_uniform", &log_uniform)}) {
    if (range->size() == 2 && !((*range)[0] < (*range)[1])) faults.At(name, "the range is empty", "[least, largest]");
  }
  for (const auto& [name, spread] : {std::pair("normal", &normal), std::pair("log_normal", &log_normal)}) {
    if (spread->size() == 2 && !((*spread)[1] > 0.0)) faults.At(name, "the standard deviation must be positive");
  }
  if (!grid.empty() && count == 0) faults.At("grid", "a grid needs a count", "count = 5");
  if (grid.empty() && count != 0) faults.At("count", "belongs to grid", "grid = [from, to]");
  if (grid.size() == 2 && spacing == "log" && !(grid[0] > 0.0 && grid[1] > 0.0))
    faults.At("grid", "equal ratios need positive ends", "spacing = \"linear\"");
  if (grid.size() == 2 && grid[0] == grid[1]) faults.At("grid", "both ends are the same");
  for (const auto& [name, values] : {std::pair("list", &list), std::pair("choice", &choice)}) {
    const bool tables = std::any_of(values->begin(), values->end(),
                                    [](const Value& value) { return value.is_table() || value.is_array(); });
    if (tables) faults.At(name, "tables and arrays cannot be varied", "vary one of their keys");
    if (relative && !Numbers(*values)) faults.At(name, "relative values must be numbers");
  }
}

Axes::Axes(std::vector<AxisSpec> specs, std::int64_t samples, Sampling sampling, std::uint64_t seed)
    : samples_(samples), runs_(samples), seed_(seed) {
  for (AxisSpec& spec : specs) {
    Axis& axis = axes_.emplace_back();
    axis.stream = std::stoull(Fingerprint(spec.key), nullptr, 16);
    axis.spec = std::move(spec);
  }
  for (std::size_t i = axes_.size(); i-- > 0;) {
    Axis& axis = axes_[i];
    if (!axis.spec.drawn()) {
      axis.stride = runs_;
      runs_ *= Steps(axis.spec);
    } else if (sampling == Sampling::kLatinHypercube) {
      axis.strata.resize(static_cast<std::size_t>(samples));
      std::iota(axis.strata.begin(), axis.strata.end(), 0);
      const auto rank = [&](std::int32_t stratum) {
        return RandomBits(seed_, axis.stream ^ kStrataStream, static_cast<std::uint64_t>(stratum));
      };
      std::stable_sort(axis.strata.begin(), axis.strata.end(),
                       [&](std::int32_t a, std::int32_t b) { return rank(a) < rank(b); });
    }
  }
}

std::int64_t Axes::Steps(const AxisSpec& spec) const {
  return spec.grid.empty() ? static_cast<std::int64_t>(spec.list.size()) : spec.count;
}

double Axes::Uniform(const Axis& axis, std::int64_t sample) const {
  const double u = RandomUniform(seed_, axis.stream, static_cast<std::uint64_t>(sample));
  if (axis.strata.empty()) return u;
  return (axis.strata[static_cast<std::size_t>(sample)] + u) / static_cast<double>(samples_);
}

double Axes::Drawn(const Axis& axis, std::int64_t sample) const {
  const AxisSpec& spec = axis.spec;
  const double u = Uniform(axis, sample);
  if (!spec.uniform.empty()) return Spread(spec.uniform[0], spec.uniform[1], false, u);
  if (!spec.log_uniform.empty()) return Spread(spec.log_uniform[0], spec.log_uniform[1], true, u);
  const double deviate = boost::math::quantile(boost::math::normal(), u);
  if (!spec.normal.empty()) return spec.normal[0] + spec.normal[1] * deviate;
  return spec.log_normal[0] * std::exp(spec.log_normal[1] * deviate);
}

const Value* Axes::Listed(const Axis& axis, std::int64_t run, std::size_t* place) const {
  const std::vector<Value>& values = axis.spec.list.empty() ? axis.spec.choice : axis.spec.list;
  if (values.empty()) return nullptr;
  const auto count = static_cast<double>(values.size());
  *place = axis.spec.drawn()
               ? std::min(values.size() - 1, static_cast<std::size_t>(Uniform(axis, run % samples_) * count))
               : static_cast<std::size_t>(run / axis.stride % static_cast<std::int64_t>(values.size()));
  return &values[*place];
}

Value Axes::At(std::size_t i, std::int64_t run) const {
  const Axis& axis = axes_[i];
  std::size_t place = 0;
  if (const Value* listed = Listed(axis, run, &place); listed != nullptr && !axis.spec.relative) return *listed;
  return Value(Number(i, run));
}

double Axes::Number(std::size_t i, std::int64_t run) const {
  const Axis& axis = axes_[i];
  const double unit = axis.spec.relative ? axis.nominal : 1.0;
  std::size_t place = 0;
  if (const Value* listed = Listed(axis, run, &place)) {
    const bool numbers = Numbers(axis.spec.list) && Numbers(axis.spec.choice);
    return numbers ? unit * listed->number() : static_cast<double>(place);
  }
  if (axis.spec.drawn()) return unit * Drawn(axis, run % samples_);
  const std::int64_t step = run / axis.stride % axis.spec.count;
  const double share = static_cast<double>(step) / (axis.spec.count - 1);
  return unit * Spread(axis.spec.grid[0], axis.spec.grid[1], axis.spec.spacing == "log", share);
}

std::vector<std::string> Axes::Labels(std::size_t axis) const {
  const AxisSpec& spec = axes_[axis].spec;
  std::vector<std::string> labels;
  if (Numbers(spec.list) && Numbers(spec.choice)) return labels;
  for (const Value& value : spec.list.empty() ? spec.choice : spec.list) labels.push_back(TextOf(value));
  return labels;
}

std::int64_t Axes::Seed(std::int64_t run) const {
  return 1 +
         static_cast<std::int64_t>(RandomBits(seed_, kSeedStream, static_cast<std::uint64_t>(run % samples_)) >> 33);
}

std::vector<std::int64_t> Axes::Extremes(std::size_t i) const {
  const Axis& axis = axes_[i];
  std::vector<std::int64_t> runs;
  if (!axis.spec.list.empty()) {
    for (std::size_t k = 0; k < axis.spec.list.size(); ++k) runs.push_back(static_cast<std::int64_t>(k) * axis.stride);
    return runs;
  }
  if (!axis.spec.drawn()) return {0, axis.stride * (axis.spec.count - 1)};
  const auto less = [&](std::int64_t a, std::int64_t b) { return Number(i, a) < Number(i, b); };
  std::int64_t least = 0, largest = 0;
  for (std::int64_t sample = 1; sample < samples_; ++sample) {
    if (less(sample, least)) least = sample;
    if (less(largest, sample)) largest = sample;
  }
  return {least, largest};
}

}  // namespace dynoproof::campaign
