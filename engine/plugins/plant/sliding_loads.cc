#include "plugins/plant/sliding_loads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dynoproof {

std::optional<SlidingLoads> SlidingLoads::Of(const std::vector<std::pair<std::string, Value>>& loads,
                                             const std::vector<Body>& bodies, const char* plant, Motion motion,
                                             BuildContext& context, Layout& layout) {
  SlidingLoads all;
  const int before = context.diagnostics.error_count();
  const auto fault = [&](const Value& at, const std::string& message, const std::string& hint) {
    context.diagnostics.Error(at.where(), message, hint, fmt::format("dynoproof describe {}", plant));
  };
  for (const auto& [name, table] : loads) {
    if (!table.is_table()) {
      fault(table, fmt::format("load.{} is {}", name, table.KindName()), "write a table");
      continue;
    }
    const Value *on = table.Find("on"), *law = table.Find("law");
    const auto body =
        on != nullptr && on->is_string() ? std::ranges::find(bodies, on->string(), &Body::name) : bodies.end();
    if (body == bodies.end()) {
      std::string wanted;
      for (const Body& one : bodies) wanted += fmt::format("{}on = \"{}\"", wanted.empty() ? "" : " or ", one.name);
      fault(on != nullptr ? *on : table,
            fmt::format("load \"{}\" does not act on {}", name, bodies.size() == 1 ? "the body" : "a body"),
            wanted.empty() ? "there is no body: write [plant.body.NAME]" : "write " + wanted);
    }
    if (law == nullptr || !law->is_string()) {
      fault(law != nullptr ? *law : table, fmt::format("\"{}\" names no law", name),
            "add law = \"viscous\", \"coulomb\", ...");
      continue;
    }
    BuildContext own{context.registry,
                     context.diagnostics,
                     name,
                     {"on", "law"},
                     context.period_s,
                     context.seed,
                     body != bodies.end() ? body->nominal : 1.0,
                     nullptr,
                     motion};
    std::unique_ptr<Law> made = context.registry.MakeLaw(law->string(), table, own);
    if (made == nullptr || body == bodies.end()) continue;
    if (made->layout().modes > 0 && !made->sticks()) {
      fault(*law, fmt::format("law \"{}\" has contact to follow, which a {} does not", law->string(), plant),
            "put it on a shaft of a drive_line");
      continue;
    }
    all.loads_.push_back({std::move(made), static_cast<std::size_t>(body - bodies.begin()), layout.states.size(),
                          body->transition_speed});
    for (Port state : all.loads_.back().law->layout().states) {
      state.name = name + "." + NameIn(motion, state.name);
      state.unit = UnitIn(motion, state.unit);
      layout.states.push_back(std::move(state));
    }
  }
  if (context.diagnostics.error_count() != before) return std::nullopt;
  return all;
}

LawView SlidingLoads::ViewOf(const Load& load, double position, double speed, const View& view) {
  return {view.time_s, position, speed, 0.0, view.states.subspan(load.state, load.states()), {}};
}

double SlidingLoads::Torque(std::size_t body, double position, double speed, const View& view) const {
  double torque = 0.0;
  for (const Load& load : loads_) {
    if (load.body != body) continue;
    const LawView at = ViewOf(load, position, speed, view);
    if (!load.law->sticks()) {
      torque += load.law->Torque(at);
    } else if (speed != 0.0) {
      const double slips = load.transition_speed > 0.0 ? std::tanh(std::abs(speed) / load.transition_speed) : 1.0;
      torque += slips * load.law->SlipTorque(at, speed > 0.0 ? 1 : -1);
    }
  }
  return torque;
}

void SlidingLoads::Derivative(std::size_t body, double position, double speed, const View& view,
                              std::span<double> rates) const {
  for (const Load& load : loads_) {
    if (load.body == body)
      load.law->Derivative(ViewOf(load, position, speed, view), rates.subspan(load.state, load.states()));
  }
}

void SlidingLoads::Start(std::size_t body, double position, double speed, std::span<double> states) const {
  for (const Load& load : loads_) {
    if (load.body == body && !load.law->sticks())
      load.law->Start(position, speed, states.subspan(load.state, load.states()), {});
  }
}

}  // namespace dynoproof
