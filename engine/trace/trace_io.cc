#include "trace/trace_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/atomic_file.h"
#include "trace/hdf5.h"

namespace dynoproof::trace {
namespace {

using hdf5::Handle;

Failure Broken(Failure failure, int exit_code, const std::string& where = {}) {
  failure.exit_code = exit_code;
  if (failure.signal.empty()) failure.signal = where;
  return failure;
}

Failure Bad(std::string message) { return {.message = std::move(message), .signal = {}, .time_s = {}, .exit_code = 2}; }

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

std::string TimeBaseName(std::size_t k) { return k == 0 ? "/time" : fmt::format("/time_{}", k); }

Status WriteSignal(hid_t group, const Signal& signal, const hdf5::Storage& storage) {
  const Result<Handle> dataset = hdf5::WriteDoubles(group, signal.name, signal.values, storage);
  if (!dataset.ok()) return dataset.failure();
  const hid_t id = dataset->id();
  if (Status s = hdf5::WriteAttribute(id, "unit", signal.unit)) return s;
  if (Status s = hdf5::WriteAttribute(id, "description", signal.description)) return s;
  if (Status s = hdf5::WriteAttribute(id, "nominal", signal.nominal)) return s;
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

/// Reads one file; keeps track of the time bases met so far.
class Reader {
 public:
  explicit Reader(hid_t file) : file_(file) {}

  Result<Trace> Read() {
    if (Result<std::size_t> base = TimeBase("/time"); !base.ok()) return base.failure();
    for (std::size_t k = 1; hdf5::KindOf(file_, TimeBaseName(k)) != hdf5::Kind::kMissing; ++k) {
      if (Result<std::size_t> base = TimeBase(TimeBaseName(k)); !base.ok()) return base.failure();
    }
    const Result<Handle> group = hdf5::OpenGroup(file_, "/signals");
    if (!group.ok()) return group.failure();
    const Result<std::vector<std::string>> names = hdf5::LinkNames(group->id());
    if (!names.ok()) return names.failure();
    for (const std::string& name : *names) {
      // Groups and the like are none of ours; what cannot be opened was meant to be a signal.
      const hdf5::Kind kind = hdf5::KindOf(group->id(), name);
      if (kind == hdf5::Kind::kGroup || kind == hdf5::Kind::kOther) continue;
      if (Status s = ReadSignal(group->id(), name)) return *s;
    }
    if (hdf5::KindOf(file_, "/scenario") != hdf5::Kind::kMissing) {
      const Result<Handle> dataset = hdf5::OpenDataset(file_, "/scenario");
      if (!dataset.ok()) return dataset.failure();
      Result<std::string> text = hdf5::ReadText(dataset->id(), "/scenario");
      if (!text.ok()) return text.failure();
      trace_.scenario = *std::move(text);
    }
    if (Status s = ReadProvenance()) return *s;
    return std::move(trace_);
  }

 private:
  Result<std::vector<double>> ReadVector(hid_t location, const std::string& path, const std::string& shown) {
    const Result<Handle> dataset = hdf5::OpenDataset(location, path, shown);
    if (!dataset.ok()) return dataset.failure();
    const std::size_t rank = hdf5::Shape(dataset->id()).size();
    if (rank != 1) return Bad(fmt::format("dataset \"{}\" has rank {}, it must be 1", shown, rank));
    return hdf5::ReadDoubles(dataset->id(), shown);
  }

  /// The number of the time base under this path, read at its first use.
  Result<std::size_t> TimeBase(const std::string& path) {
    if (const auto known = time_bases_.find(path); known != time_bases_.end()) return known->second;
    Result<std::vector<double>> time = ReadVector(file_, path, path);
    if (!time.ok()) return time.failure();
    const std::size_t number = time_bases_.size();
    if (number == 0) {
      trace_.time = *std::move(time);
    } else {
      trace_.other_times.push_back(*std::move(time));
    }
    time_bases_.emplace(path, number);
    return number;
  }

  Status ReadSignal(hid_t group, const std::string& name) {
    const std::string path = "/signals/" + name;
    Signal signal;
    signal.name = name;
    Result<std::vector<double>> values = ReadVector(group, name, path);
    if (!values.ok()) return values.failure();
    signal.values = *std::move(values);
    const Result<Handle> dataset = hdf5::OpenDataset(group, name);
    if (!dataset.ok()) return dataset.failure();
    const hid_t id = dataset->id();
    if (Status s = ReadTextAttribute(id, path, "unit", signal.unit)) return s;
    if (Status s = ReadTextAttribute(id, path, "description", signal.description)) return s;
    const Result<hdf5::Attribute> nominal = hdf5::ReadAttribute(id, "nominal");
    if (!nominal.ok()) return nominal.failure();
    if (const auto* real = std::get_if<double>(&*nominal)) signal.nominal = *real;
    if (const auto* integer = std::get_if<std::int64_t>(&*nominal)) signal.nominal = static_cast<double>(*integer);
    if (std::holds_alternative<std::string>(*nominal)) {
      return Bad(fmt::format("dataset \"{}\": attribute \"nominal\" is not a number", path));
    }
    std::string interpolation{ToText(signal.interpolation)};
    if (Status s = ReadTextAttribute(id, path, "interpolation", interpolation)) return s;
    const std::optional<Interpolation> parsed = ParseInterpolation(interpolation);
    if (!parsed) {
      return Bad(
          fmt::format("dataset \"{}\": interpolation \"{}\" is neither \"linear\" nor \"hold\"", path, interpolation));
    }
    signal.interpolation = *parsed;

    std::string time = "/time";
    if (Status s = ReadTextAttribute(id, path, "time", time)) return s;
    const Result<std::size_t> base = TimeBase(time);
    if (!base.ok()) return Bad(fmt::format("dataset \"{}\": its time base: {}", path, base.failure().message));
    signal.time_base = *base;
    if (const std::size_t stamps = trace_.TimeOf(signal).size(); signal.values.size() != stamps) {
      return Bad(fmt::format("dataset \"{}\" has {} values, its time base \"{}\" {}", path, signal.values.size(), time,
                             stamps));
    }
    trace_.signals.push_back(std::move(signal));
    return {};
  }

  static Status ReadTextAttribute(hid_t object, const std::string& path, const std::string& name, std::string& text) {
    const Result<hdf5::Attribute> value = hdf5::ReadAttribute(object, name);
    if (!value.ok()) return Bad(fmt::format("dataset \"{}\": {}", path, value.failure().message));
    if (std::holds_alternative<std::monostate>(*value)) return {};
    if (const auto* found = std::get_if<std::string>(&*value)) {
      text = *found;
      return {};
    }
    return Bad(fmt::format("dataset \"{}\": attribute \"{}\" is not a text", path, name));
  }

  Status ReadProvenance() {
    if (hdf5::KindOf(file_, "/provenance") == hdf5::Kind::kMissing) return {};
    const Result<Handle> group = hdf5::OpenGroup(file_, "/provenance");
    if (!group.ok()) return group.failure();
    const Result<std::vector<std::string>> names = hdf5::AttributeNames(group->id());
    if (!names.ok()) return names.failure();
    for (const std::string& name : *names) {
      const Result<hdf5::Attribute> value = hdf5::ReadAttribute(group->id(), name);
      if (!value.ok()) return Bad("group \"/provenance\": " + value.failure().message);
      if (const auto* text = std::get_if<std::string>(&*value)) trace_.provenance.texts.emplace_back(name, *text);
      if (const auto* count = std::get_if<std::int64_t>(&*value)) trace_.provenance.counters.emplace_back(name, *count);
    }
    return {};
  }

  hid_t file_;
  Trace trace_;
  std::map<std::string, std::size_t> time_bases_;
};

}  // namespace

Result<std::vector<std::byte>> ToImage(const Trace& trace, const WriteOptions& options) {
  std::vector<std::string> problems = Validate(trace);
  std::ranges::move(ValidateProvenance(trace.provenance), std::back_inserter(problems));
  if (!problems.empty()) return Broken(Bad(Join(problems)), 3);

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
  const Result<Handle> file = hdf5::OpenFile(path.string());
  if (!file.ok()) return Broken(file.failure(), 2, path.string());
  Result<Trace> trace = Reader(file->id()).Read();
  if (!trace.ok()) return Broken(trace.failure(), 2, path.string());
  return trace;
}

Result<Trace> ReadTrace(const std::filesystem::path& path) {
  Result<Trace> trace = ReadTraceUnchecked(path);
  if (!trace.ok()) return trace;
  if (const std::vector<std::string> problems = Validate(*trace); !problems.empty()) {
    return Broken(Bad(Join(problems)), 2, path.string());
  }
  return trace;
}

}  // namespace dynoproof::trace
