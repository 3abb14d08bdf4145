#include "trace/trace_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "base/atomic_file.h"
#include "base/bad_input.h"
#include "trace/hdf5.h"
#include "trace/hdf5_apart.h"
#include "trace/hdf5_trace.h"
#include "trace/hdf5_values.h"

namespace dynoproof::trace {

template <class Archive>
void Members(Archive& archive, Signal& signal) {
  Pass(archive, signal.name);
  Pass(archive, signal.unit);
  Pass(archive, signal.description);
  Pass(archive, signal.nominal);
  Pass(archive, signal.interpolation);
  Pass(archive, signal.values);
  Pass(archive, signal.time_base);
  Pass(archive, signal.nominal_known);
}

template <class Archive>
void Members(Archive& archive, Trace& trace) {
  Pass(archive, trace.time);
  Pass(archive, trace.other_times);
  Pass(archive, trace.signals);
  Pass(archive, trace.scenario);
  Pass(archive, trace.provenance.texts);
  Pass(archive, trace.provenance.counters);
}

namespace {

using hdf5::Handle;

Failure Broken(Failure failure, int exit_code, const std::string& where = {}) {
  failure.exit_code = exit_code;
  if (failure.signal.empty()) failure.signal = where;
  return failure;
}

std::string Join(const std::vector<std::string>& problems) {
  constexpr std::size_t kMost = 20;
  std::string text =
      fmt::format("{}", fmt::join(problems.begin(), problems.begin() + std::min(problems.size(), kMost), "\n"));
  if (problems.size() > kMost) text += fmt::format("\nand {} more", problems.size() - kMost);
  return text;
}

std::size_t CountValues(const Trace& trace) {
  std::size_t count = trace.time.size();
  for (const auto& time : trace.other_times) count += time.size();
  for (const Signal& signal : trace.signals) count += signal.values.size();
  return count;
}

Status WriteSignal(hid_t group, const Signal& signal, const hdf5::Storage& storage) {
  const Result<Handle> dataset = hdf5::WriteDoubles(group, signal.name, signal.values, storage);
  if (!dataset.ok()) return dataset.failure();
  const hid_t id = dataset->id();
  if (Status s = hdf5::WriteAttribute(id, "unit", signal.unit)) return s;
  if (Status s = hdf5::WriteAttribute(id, "description", signal.description)) return s;
  if (signal.nominal_known) {
    if (Status s = hdf5::WriteAttribute(id, "nominal", signal.nominal)) return s;
  }
  if (Status s = hdf5::WriteAttribute(id, "interpolation", ToText(signal.interpolation))) return s;
  if (signal.time_base > 0) return hdf5::WriteAttribute(id, "time", TimeBaseName(signal.time_base));
  return {};
}

Status WriteProvenance(hid_t file, const Provenance& provenance) {
  const Result<Handle> group = hdf5::CreateGroup(file, "provenance");
  if (!group.ok()) return group.failure();
  for (const auto& [name, text] : provenance.texts) {
    if (Status s = hdf5::WriteAttribute(group->id(), name, text)) return s;
  }
  for (const auto& [name, count] : provenance.counters) {
    if (Status s = hdf5::WriteAttribute(group->id(), name, count)) return s;
  }
  return {};
}

Status WriteAll(hid_t file, const Trace& trace, const hdf5::Storage& storage) {
  for (std::size_t k = 0; k <= trace.other_times.size(); ++k) {
    const std::vector<double>& time = k == 0 ? trace.time : trace.other_times[k - 1];
    const Result<Handle> dataset = hdf5::WriteDoubles(file, TimeBaseName(k), time, storage);
    if (!dataset.ok()) return dataset.failure();
    if (Status s = hdf5::WriteAttribute(dataset->id(), "unit", "s")) return s;
  }
  const Result<Handle> signals = hdf5::CreateGroup(file, "signals");
  if (!signals.ok()) return signals.failure();
  for (const Signal& signal : trace.signals) {
    if (Status s = WriteSignal(signals->id(), signal, storage)) {
      s->message = fmt::format("signal \"{}\": {}", signal.name, s->message);
      return s;
    }
  }
  if (Status s = hdf5::WriteText(file, "scenario", trace.scenario)) return s;
  return WriteProvenance(file, trace.provenance);
}

}  // namespace

Result<std::vector<std::byte>> ToImage(const Trace& trace, const WriteOptions& options) {
  std::vector<std::string> problems = Validate(trace);
  std::ranges::move(ValidateProvenance(trace.provenance), std::back_inserter(problems));
  if (!problems.empty()) return Broken(BadInput(Join(problems)), 3);

  const hdf5::Session session;
  const std::size_t bytes = CountValues(trace) * sizeof(double);
  hdf5::Storage storage;
  storage.deflate_level = options.deflate_level >= 0 ? options.deflate_level : (bytes >= kCompressFromBytes ? 1 : 0);
  const auto file = hdf5::MemoryFile::Create(bytes + trace.scenario.size());
  if (!file.ok()) return Broken(file.failure(), 3);
  if (Status s = WriteAll((*file)->id(), trace, storage)) return Broken(*std::move(s), 3);
  Result<std::vector<std::byte>> image = (*file)->Finish();
  if (!image.ok()) return Broken(image.failure(), 3);
  return image;
}

Status WriteTrace(const std::filesystem::path& path, const Trace& trace, const WriteOptions& options) {
  const Result<std::vector<std::byte>> image = ToImage(trace, options);
  if (!image.ok()) return Broken(image.failure(), 3, path.string());
  return WriteFileAtomically(path, *image);
}

Result<Trace> ReadTraceUnchecked(const std::filesystem::path& path) {
  const hdf5::Session session;
  Result<Trace> trace = ReadApart<Trace>(hdf5::LimitsFor(path), [&]() -> Result<Trace> {
    hdf5::StayInFile();
    const Result<Handle> file = hdf5::OpenFile(path.string());
    if (!file.ok()) return file.failure();
    return ReadTraceFrom(file->id());
  });
  if (!trace.ok()) return Broken(trace.failure(), trace.failure().exit_code, path.string());
  return trace;
}

Result<Trace> ReadTrace(const std::filesystem::path& path) {
  Result<Trace> trace = ReadTraceUnchecked(path);
  if (!trace.ok()) return trace;
  if (const std::vector<std::string> problems = Validate(*trace); !problems.empty()) {
    return Broken(BadInput(Join(problems)), 2, path.string());
  }
  return trace;
}

}  // namespace dynoproof::trace
