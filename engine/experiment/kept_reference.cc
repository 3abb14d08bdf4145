#include "experiment/kept_reference.h"

#include <link.h>

#include <filesystem>
#include <vector>

#include "base/cpu.h"
#include "base/text.h"
#include "experiment/measured_record.h"
#include "experiment/prepare.h"
#include "experiment/run_scenario.h"
#include "scenario/load.h"
#include "trace/trace_io.h"

namespace dynoproof {
namespace {

/// One text that differs wherever the loaded code does: the hashes of the program and of all its shared libraries.
std::string CodeText() {
  std::string text;
  const auto add = [](dl_phdr_info* loaded, std::size_t, void* to) {
    const std::string name = loaded->dlpi_name;
    // The first entry, the program, has no name; the kernel's own (vdso) is no file.
    static_cast<std::string*>(to)->append(HashOf(name.empty() ? "/proc/self/exe" : name) + "\n");
    return 0;
  };
  dl_iterate_phdr(add, &text);
  return Fingerprint(text);
}

/// Plugins are loaded before the first scenario is prepared, so that the code stays what it is.
const std::string& Code() {
  static const std::string code = CodeText();
  return code;
}

std::string Bytes(const std::vector<double>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)};
}

/// Differs wherever what the sources of a scenario play from files does, whatever the files are called.
std::string FingerprintOf(const Records& records) {
  std::string text;
  for (const auto& [name, series] : records)
    text += name + " " + Fingerprint(Bytes(*series.time)) + " " + Fingerprint(Bytes(*series.values)) + "\n";
  return Fingerprint(text);
}

/// The scenario without what judges or names it.
std::string TextOf(Value root) {
  for (const char* key : {"check", "title"}) root.Erase(key);
  return ToToml(root);
}

}  // namespace

KeptReference::KeptReference(const std::string& folder, const Prepared& prepared)
    : rig_(*prepared.rig),
      file_((std::filesystem::path(folder) / prepared.plan.id).string() + ".reference.h5"),
      scenario_(TextOf(prepared.plan.root)),
      records_(prepared.records == nullptr ? "" : FingerprintOf(*prepared.records)) {}

std::optional<Samples> KeptReference::Find() const {
  if (!std::filesystem::exists(file_)) return std::nullopt;
  Result<trace::Trace> trace = trace::ReadTrace(file_);
  if (!trace.ok() || trace->scenario != scenario_ || trace->signals.size() != rig_.inputs.size() + rig_.outputs.size())
    return std::nullopt;
  const trace::Provenance& provenance = trace->provenance;
  if (provenance.Text("records") != records_ || provenance.Text("code") != Code() ||
      provenance.Text("cpu") != CpuFeatureClass())
    return std::nullopt;
  Samples samples;
  samples.time = std::move(trace->time);
  for (const InputLine& line : rig_.inputs) {
    trace::Signal* const signal = trace->Find(line.name);
    if (signal == nullptr) return std::nullopt;
    samples.inputs.push_back(std::move(signal->values));
  }
  for (const OutputLine& line : rig_.outputs) {
    trace::Signal* const signal = trace->Find(line.name);
    if (signal == nullptr) return std::nullopt;
    samples.outputs.push_back(std::move(signal->values));
  }
  samples.counters = {provenance.counters.begin(), provenance.counters.end()};
  samples.solver_summary = provenance.Text("solver_summary").value_or("");
  return samples;
}

Status KeptReference::Keep(const Samples& samples) const {
  trace::Trace trace = SampledTrace(rig_, samples);
  trace.scenario = scenario_;
  trace.provenance.Set("code", Code());
  trace.provenance.Set("cpu", CpuFeatureClass());
  trace.provenance.Set("records", records_);
  trace.provenance.Set("solver_summary", samples.solver_summary);
  for (const auto& [name, count] : samples.counters) trace.provenance.SetCounter(name, count);
  return trace::WriteTrace(file_, trace);
}

}  // namespace dynoproof
