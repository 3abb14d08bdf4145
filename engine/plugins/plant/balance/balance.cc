#include "plugins/plant/balance/balance.h"

#include <cmath>
#include <numeric>
#include <set>

namespace dynoproof {
namespace {

enum State { kIn, kOut, kTurnover, kStart };

}  // namespace

void Balance::Params::Check(Faults& faults) const {
  std::set<std::string> names;
  for (const auto& [key, list] : {std::pair("stored", &stored), std::pair("in", &in), std::pair("out", &out)}) {
    if (list->empty()) faults.At(key, "nothing is named here", "at least one");
    for (const std::string& name : *list) {
      if (!names.insert(name).second) faults.At(key, fmt::format("\"{}\" is there twice", name), "each name once");
    }
  }
  // As many as the solvers carry without the heap.
  if (names.size() > 16) faults.At("stored", fmt::format("{} inputs", names.size()), "at most 16");
}

PluginInfo Balance::Info() {
  return {"plant",
          "balance",
          "books of mass or energy over several parts",
          "balance = (S - S(0) - I + O)/(|S(0)| + I_abs), I' = sum of in, O' = sum of out",
          "definition",
          {}};
}

Balance::Balance(const Params& params) : stored_(params.stored.size()), in_(params.in.size()), out_(params.out.size()) {
  for (const auto* list : {&params.stored, &params.in, &params.out}) {
    for (const std::string& name : *list) layout_.inputs.push_back({name, "1", "in the books, in its own unit", 1.0});
  }
  layout_.outputs = {{"balance", "1", "what is unaccounted for, of all that came in", 1.0}};
  layout_.states = {{"in", "1", "that came in", 1.0},
                    {"out", "1", "that left", 1.0},
                    {"turnover", "1", "that came in or went back", 1.0},
                    {"start", "1", "stored at t = 0", 1.0}};
}

double Balance::Stored(std::span<const double> inputs) const {
  return std::accumulate(inputs.begin(), inputs.begin() + static_cast<std::ptrdiff_t>(stored_), 0.0);
}

void Balance::Start(std::span<const double> inputs, std::span<double> states, std::span<int>) const {
  states[kStart] = Stored(inputs);
}

void Balance::Output(const View& view, std::span<double> outputs) const {
  const std::span<const double> s = view.states;
  const double all = std::abs(s[kStart]) + s[kTurnover];
  const double missing = Stored(view.inputs) - s[kStart] - s[kIn] + s[kOut];
  outputs[0] = all > 0.0 ? missing / all : 0.0 * missing;
}

void Balance::Derivative(const View& view, std::span<double> rates) const {
  rates[kIn] = rates[kOut] = rates[kTurnover] = rates[kStart] = 0.0;
  for (std::size_t i = 0; i < in_; ++i) {
    rates[kIn] += view.inputs[stored_ + i];
    rates[kTurnover] += std::abs(view.inputs[stored_ + i]);
  }
  for (std::size_t i = 0; i < out_; ++i) rates[kOut] += view.inputs[stored_ + in_ + i];
}

}  // namespace dynoproof
