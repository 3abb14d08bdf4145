// The Plan: a scenario after includes and overrides, before it is built. Fits and effects change its values by path.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "base/time.h"
#include "model/params.h"
#include "model/value.h"

namespace dynoproof {

struct Plan {
  std::string id;    // path below scenarios/ without .toml, or the file's stem
  std::string file;  // as the user wrote it
  Value root;        // the whole scenario
};

/// [run]: how long, how fine, and by which solver.
struct RunSettings {
  double duration_s = 0.0;
  double period_s = 1e-4;   // inputs are held and signals are recorded at this period
  double clock_rate = 1.0;  // seconds that pass in one of the clock: a record's period may be no whole nanoseconds
  std::int64_t seed = 1;
  std::string solver = "realtime";
  struct Reference {
    std::string method = "explicit";  // explicit: ARKODE Runge-Kutta, mildly stiff plants; bdf: CVODE, stiff ones
    double relative_tolerance = 1e-9;
    double max_step_s = 0.0;  // 0: none
    void Visit(auto& v);
  } reference;
  struct Realtime {
    int substeps = 4;                // of a period, where nonlinear laws or parts exist
    int corrections = 2;             // sweeps of the implicit correction in a substep
    int part_corrections = 0;        // of these sweeps, those that carry the nonlinear parts anew; 0: all
    double keep_below_Hz = 0.0;      // 0: all modes; else faster modes are replaced by their static gain
    double condense_above_Hz = 0.0;  // 0: none; else faster modes without damping follow statically
    void Visit(auto& v);
  } realtime;
  void Visit(auto& v);
};

/// [input.NAME]: a scalar that drives the plant, held between samples.
struct InputSpec {
  std::vector<std::string> to;  // "plant.T_airgap": block.port
  std::string unit = "1", description, from;
  double nominal = 1.0;
  Value source;                 // table with `type`; or `from`: the output of a controller or another part
  std::vector<Value> actuator;  // stages, first acts first
  void Visit(auto& v);
};

/// [output.NAME]: what is recorded and may be compared.
struct OutputSpec {
  std::string of, unit, description;  // "plant.k4.torque"
  double nominal = 1.0;
  std::vector<Value> sensor;  // stages, first acts first
  void Visit(auto& v);
};

/// [part.NAME] (continuous) and [control.NAME] (discrete): further blocks with wired inputs.
struct WiringSpec {
  std::string type;
  std::vector<std::pair<std::string, std::string>> inputs;  // port -> signal
  double period_s = 1e-4, offset_s = 0.0;                   // control only
};

/// [[effect]]: a change of the model by name and place.
struct EffectUse {
  std::string name, at;
  Value parameters;
  SourceSpan where;
  SourceSpan name_where = {}, at_where = {};  // of the two words; unknown when the effect was not written in a file
  void Visit(auto& v);
};

/// [extension]: the scenario is another one with what a diagnosis found. `bless` asks for evidence against that one.
struct ExtensionSpec {
  std::string of;                 // the nominal scenario: an id, or a file
  std::vector<std::string> set;   // "KEY=VALUE": what --set had changed in it
  std::vector<std::string> data;  // SHA-256 of the records that the extension was found in
  void Visit(auto& v);
  void Check(Faults& faults) const;
};

/// The sections of a plan, decoded; faults become diagnostics.
RunSettings ReadRun(const Plan& plan, Diagnostics& diagnostics);
/// run.realtime.substeps of a plan whose [run] is in order, the default where it says nothing.
int SubstepsOf(const Plan& plan);
void SetSubsteps(Plan& plan, int substeps);
std::vector<std::pair<std::string, InputSpec>> ReadInputs(const Plan& plan, Diagnostics& diagnostics);
std::vector<std::pair<std::string, OutputSpec>> ReadOutputs(const Plan& plan, Diagnostics& diagnostics);
std::vector<EffectUse> ReadEffects(const Plan& plan, Diagnostics& diagnostics);
/// Nothing where the plan has no [extension], or a faulty one.
std::optional<ExtensionSpec> ReadExtension(const Plan& plan, Diagnostics& diagnostics);
/// Reports keys of the top level that no section has.
void CheckTopLevel(const Plan& plan, Diagnostics& diagnostics);

void RunSettings::Reference::Visit(auto& v) {
  v.Optional("method", method, std::vector<std::string>{"explicit", "bdf"},
             "explicit Runge-Kutta (ARKODE) or BDF (CVODE)");
  v.Optional("relative_tolerance", relative_tolerance, Between(1e-14, 1e-2),
             "local error per step, scaled by nominals");
  v.Optional("max_step_s", max_step_s, NonNegative(), "largest step; 0: none");
}

void RunSettings::Realtime::Visit(auto& v) {
  v.Optional("substeps", substeps, Between(1, 1000), "substeps of a period where something is nonlinear");
  v.Optional("corrections", corrections, Between(1, 20), "sweeps of the implicit correction in a substep");
  v.Optional("part_corrections", part_corrections, Between(0, 20),
             "sweeps that carry the nonlinear parts anew; 0: all of them");
  v.Optional("keep_below_Hz", keep_below_Hz, NonNegative(), "replace faster modes by their static gain; 0 keeps all");
  v.Optional("condense_above_Hz", condense_above_Hz, NonNegative(),
             "condense faster modes statically before the rest is decomposed: less exact than keep_below_Hz and many "
             "times faster where each run has other numbers; linear plants only; 0: none");
}

void RunSettings::Visit(auto& v) {
  v.Required("duration_s", duration_s, Positive(), "simulated time");
  v.Optional("period_s", period_s, Positive(), "period at which inputs are held and signals recorded");
  v.Optional("clock_rate", clock_rate, Between(0.999, 1.001),
             "seconds that pass in one of the clock, for a record whose period is no whole nanoseconds");
  v.Optional("seed", seed, Any(), "seed of all noise");
  v.Optional("solver", solver, std::vector<std::string>{"realtime", "reference"}, "solver of the trace that is kept");
}

void InputSpec::Visit(auto& v) {
  v.Required("to", to, Any(), "the port or ports it drives, as block.port");
  v.Optional("unit", unit, Any(), "unit");
  v.Optional("nominal", nominal, Positive(), "usual magnitude; scales tolerances and the harmonics of an actuator");
  v.Optional("description", description, Any(), "what it is");
  v.Optional("from", from, Any(), "signal that drives it, instead of a source");
  v.Optional("source", source, Any(), "source plugin with its parameters");
  v.Optional("actuator", actuator, Any(), "actuator stages, first acts first");
}

void OutputSpec::Visit(auto& v) {
  v.Required("of", of, Any(), "the signal, as block.port");
  v.Optional("unit", unit, Any(), "unit; that of the port when not given");
  v.Optional("nominal", nominal, Positive(), "usual magnitude; scales tolerances");
  v.Optional("description", description, Any(), "what it is");
  v.Optional("sensor", sensor, Any(), "sensor stages, first acts first");
}

void EffectUse::Visit(auto& v) {
  v.Required("name", name, Any(), "name of the effect");
  v.Required("at", at, Any(), "place, as kind:name");
  v.Optional("parameters", parameters, Any(), "its parameters");
}

void ExtensionSpec::Visit(auto& v) {
  v.Required("of", of, Any(), "the nominal scenario that is extended: an id, or a file");
  v.Optional("set", set, Any(), "KEY=VALUE, as for --set: what else made the nominal model");
  v.Optional("data", data, Any(), "SHA-256 of the records it was found in: they are no hold-out");
}

}  // namespace dynoproof
