// The files that `dynoproof new` writes. @NAME@ and @CLASS@ are replaced. tests/acceptance proves that each passes
// `validate` or builds, loads and runs as it is.
#include "app/templates.h"

namespace dynoproof::app {

const char* const kScenarioTemplate = R"toml(# A three-mass drive line under a chirp. Change the numbers to yours, then:
#   dynoproof validate @NAME@.toml
#   dynoproof modes @NAME@.toml
#   dynoproof run @NAME@.toml
title = "@NAME@"
source = "where the numbers come from"

[run]
duration_s = 2.0
period_s = 1e-4              # inputs are held and signals recorded at 10 kHz

[plant]
type = "drive_line"          # dynoproof describe drive_line

[plant.inertia]              # kg m^2
I1 = 2.0                     # machine
I2 = 0.3                     # coupling
I3 = 0.5                     # device under test

[plant.shaft.k1]
between = ["I1", "I2"]
stiffness_Nm_per_rad = 4.0e5
damping_Nms_per_rad = 8.0

[plant.shaft.k2]
between = ["I2", "I3"]
stiffness_Nm_per_rad = 2.5e5
damping_Nms_per_rad = 6.0

[plant.torque.T_airgap]
on = "I1"

[input.T_airgap]
to = "plant.T_airgap"
unit = "N m"
nominal = 100.0
source = { type = "chirp", amplitude = 100.0, start_Hz = 0.0, end_Hz = 400.0, rate_Hz_per_s = 200.0 }

[output.T_shaft]
of = "plant.k2.torque"
unit = "N m"
nominal = 100.0

[output.omega_1]
of = "plant.I1.speed"
unit = "rad/s"
nominal = 1.0

[analysis]
input = "T_airgap"
output = "T_shaft"
to_Hz = 400.0

# Is the run right? The solver `realtime` against `reference`, started anew from its state every 20 ms: so it holds for
# every law, also where play or dry friction makes motion chaotic and two free runs part.
[[check]]
kind = "windows"
signal = "T_shaft"
window_s = 0.02
nrmse = 1e-3
origin = "a tenth of a torque flange's error; linear lines are 1e-9 apart, those with play, friction or a cubic spring 1e-6"

# A linear line, of spring-damper shafts and viscous loads alone, can be held against an oracle as well: a matrix
# exponential that shares no code with either solver. `validate` says when it does not apply. Take out the # for it:
# [[check]]
# kind = "oracle"
# oracle = "held_input_exponential"
# signal = "T_shaft"
# nrmse = 1e-9
# origin = "round-off: two exact methods"
)toml";

const char* const kPluginCmake =
    R"cmake(# cmake -S @NAME@ -B @NAME@/build -DCMAKE_PREFIX_PATH=@PREFIX@ && cmake --build @NAME@/build
cmake_minimum_required(VERSION 3.25)
project(@NAME@ CXX)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
find_package(dynoproof REQUIRED)
add_library(@NAME@ MODULE @NAME@.cc)
target_link_libraries(@NAME@ PRIVATE dynoproof::@LIBRARY@)
set_target_properties(@NAME@ PROPERTIES PREFIX "")
)cmake";

// The delimiter is not "cpp": clang-format would format the text and tear the placeholders apart.
const char* const kLawTemplate =
    R"template(// Law @NAME@: a shaft whose torque saturates, T = T_max tanh(k d / T_max) + c w.
#include <cmath>
#include <model/plugin_loader.h>

namespace {

class @CLASS@ : public dynoproof::Law {
 public:
  struct Params {
    double stiffness_Nm_per_rad = 0.0, damping_Nms_per_rad = 0.0, limit_Nm = 0.0;
    void Visit(auto& v) {
      v.Required("stiffness_Nm_per_rad", stiffness_Nm_per_rad, dynoproof::Positive(), "stiffness k at rest");
      v.Optional("damping_Nms_per_rad", damping_Nms_per_rad, dynoproof::NonNegative(), "damping c");
      v.Required("limit_Nm", limit_Nm, dynoproof::Positive(), "torque T_max that the spring never exceeds");
    }
  };

  static dynoproof::PluginInfo Info() {
    return {"law", "@NAME@", "a shaft whose torque saturates", "T = T_max tanh(k d / T_max) + c w", "your source", {}};
  }
  explicit @CLASS@(const Params& params) : p_(params) {}

  // What modes and zeros see: the law linearised about rest. linear() stays zero: `realtime` takes the torque as it is.
  // A law that is spring and damper and nothing else says so by linear() and is_linear(), and is then carried exactly.
  dynoproof::SpringDamper linearised() const override { return {p_.stiffness_Nm_per_rad, p_.damping_Nms_per_rad}; }
  double Torque(const dynoproof::LawView& view) const override {
    return p_.limit_Nm * std::tanh(p_.stiffness_Nm_per_rad * view.twist / p_.limit_Nm) +
           p_.damping_Nms_per_rad * view.rate;
  }

 private:
  Params p_;
};

}  // namespace

DYNOPROOF_PLUGIN(registry) { registry.Add<@CLASS@>(); }
)template";

const char* const kEffectTemplate =
    R"template(// Effect @NAME@: an inertia is off by a mass that nobody told the model of, new = nominal + I_extra.
#include <memory>
#include <model/plugin_loader.h>

namespace {

class @CLASS@ : public dynoproof::Effect {
 public:
  @CLASS@() {
    info_ = {"@NAME@", "I = I_nominal + I_extra", "inertia that the model does not know of",
             {{"I_extra", "kg m^2", "inertia that is added", 0.0, 100.0, 0.0, 0.01}}};
  }

  std::vector<dynoproof::Place> Places(const dynoproof::Plan& plan) const override {
    std::vector<dynoproof::Place> places;
    const dynoproof::Value* inertias = plan.root.FindPath("plant.inertia");
    for (const std::string& name : inertias != nullptr ? dynoproof::KeysOf(*inertias) : std::vector<std::string>{}) {
      if (inertias->Find(name)->is_number()) places.push_back({"inertia", name, ""});
    }
    return places;
  }

  void Apply(dynoproof::Plan& plan, const dynoproof::Place& place, const std::vector<double>& parameters) const override {
    dynoproof::Value& inertia = *plan.root.FindPath("plant.inertia." + place.name);
    inertia = dynoproof::Value(inertia.number() + parameters[0]);
  }
};

}  // namespace

DYNOPROOF_PLUGIN(registry) { registry.Add(std::make_unique<@CLASS@>()); }
)template";

const char* const kCheckHeader =
    R"template(// Check @NAME@: the mean square of an output, over a stretch of the run, stays below a limit.
#pragma once

#include <experiment/check.h>
#include <string>
#include <utility>
#include <vector>

class @CLASS@ : public dynoproof::CheckPlan {
 public:
  struct Params {
    std::string signal, origin;
    double rms = 0.0, from_s = 0.0;
    void Visit(auto& v) {
      v.Required("signal", signal, dynoproof::Any(), "output that is judged");
      v.Required("rms", rms, dynoproof::Positive("1"), "largest root mean square, in the signal's unit");
      v.Optional("from_s", from_s, dynoproof::NonNegative("s"), "judged from here to the end");
      v.Required("origin", origin, dynoproof::Any(), "why this limit");
    }
  };
  static constexpr const char* kName = "@NAME@";
  static constexpr const char* kSummary = "the root mean square of an output stays below a limit";

  explicit @CLASS@(Params params) : p_(std::move(params)) {}
  std::vector<std::string> Signals() const override { return {p_.signal}; }
  std::vector<dynoproof::score::Check> Run(dynoproof::CheckContext& context) const override;

 private:
  Params p_;
};
)template";

const char* const kCheckTemplate =
    R"template(#include "@NAME@.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <model/plugin_loader.h>

namespace score = dynoproof::score;

std::vector<score::Check> @CLASS@::Run(dynoproof::CheckContext& context) const {
  const dynoproof::RunSignal signal = *context.Find(p_.signal);  // Signals() has seen to it that it is there
  const auto& [time_s, values, interpolation] = signal.series;
  const auto first = std::lower_bound(time_s.begin(), time_s.end(), p_.from_s) - time_s.begin();
  const score::Series judged{time_s.subspan(first), values.subspan(first), interpolation};
  // Nothing to judge, or a NaN in it, is no number: AtMost() then fails and says so.
  const bool sound = score::FaultOf(judged, p_.signal).empty();
  const double rms = sound ? score::RootMeanSquare(judged.values) : std::numeric_limits<double>::quiet_NaN();
  context.figures[p_.signal + "_rms"] = {rms, signal.unit};
  score::Check check = score::AtMost("@NAME@ " + p_.signal, kName, rms, p_.rms, signal.unit, p_.origin);
  // What was judged, for the pictures of the report: the output against zero, within the limit.
  const std::vector<double> zeros(judged.values.size(), 0.0);
  check.evidence = score::BandEvidence({p_.signal, signal.unit, "zero", "run"}, score::Evidence::Rule::kRms,
                                       {judged.time_s, zeros}, judged, p_.rms);
  return {check};
}

DYNOPROOF_PLUGIN(registry) { registry.AddCheck<@CLASS@>(); }
)template";

const char* const kCheckReadme = R"text(# @NAME@

A kind of check of your own, in a shared library. `@NAME@.h` declares its parameters, `@NAME@.cc` judges, `@NAME@.toml`
is a scenario that states it:

```sh
cmake -S . -B build -DCMAKE_PREFIX_PATH="@PREFIX@" && cmake --build build
dynoproof describe @NAME@ --plugin build/@NAME@.so
dynoproof run @NAME@.toml --plugin build/@NAME@.so
```

- `Params::Visit` names each key of the `[[check]]` table with its range: faults are reported at their place, before
  anything runs. `Signals()` and `Inputs()` name what the scenario must have.
- `Run` gets a `dynoproof::CheckContext` (`experiment/check.h`): `plan()`, `solver()`, `Find(NAME)` for the samples, unit and
  nominal of an input or output, `figures` for what it found out besides.
- It gives at least one `score::Check`; `AtMost` and `AtLeast` fail on what is no number. Each limit has an `origin`, which
  says why it is what it is.
- A check that compares two courses hands on its evidence (`score/evidence.h`): the report draws what was judged.
)text";

const char* const kLawUse = R"toml(law = "@NAME@"
limit_Nm = 20.0
)toml";

const char* const kEffectUse = R"toml(
[[effect]]
name = "@NAME@"
at = "inertia:I3"
parameters = { I_extra = 0.1 }
)toml";

const char* const kCheckUse = R"toml(
[[check]]
kind = "@NAME@"
signal = "T_shaft"
rms = 90.0
origin = "what the flange bears for long"
)toml";

const char* const kGoldenUse = R"toml(
# Any change of the run, against the trace that `dynoproof bless` keeps beside this file.
[[check]]
kind = "golden"
)toml";

}  // namespace dynoproof::app
