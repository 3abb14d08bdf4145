#include "trace/hdf5_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/bad_input.h"
#include "base/units.h"
#include "trace/hdf5_attributes.h"
#include "trace/hdf5_meaning.h"
#include "trace/hdf5_values.h"

namespace dynoproof::trace {
namespace {

using hdf5::Handle;

/// Reads one file; keeps track of the time bases met so far.
class TraceReader {
 public:
  explicit TraceReader(hid_t file) : file_(file) {}

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
  Result<std::vector<double>> ReadVector(hid_t dataset, const std::string& shown, const hdf5::Meaning& meaning) {
    const Result<hdf5::Space> space = hdf5::SpaceOf(dataset, fmt::format("dataset \"{}\"", shown));
    if (!space.ok()) return space.failure();
    const std::vector<std::size_t>& shape = space->shape;
    if (shape.size() != 1)
      return BadInput(fmt::format("dataset \"{}\" has rank {}, it must be 1", shown, shape.size()));
    constexpr std::size_t kMost = hdf5::kMostBytes / sizeof(double);
    if (shape[0] <= kMost && (values_ += shape[0]) > kMost)  // one that is larger by itself is refused on reading
      return BadInput(
          fmt::format("dataset \"{}\" is the one with which the file has more than {} values", shown, kMost));
    return hdf5::ReadMeasured(dataset, shown, meaning);
  }

  /// The number of the time base under this path, read at its first use.
  Result<std::size_t> TimeBase(const std::string& path) {
    if (const auto known = time_bases_.find(path); known != time_bases_.end()) return known->second;
    const Result<Handle> dataset = hdf5::OpenDataset(file_, path);
    if (!dataset.ok()) return dataset.failure();
    const Result<hdf5::Meaning> meaning = hdf5::ReadMeaning(dataset->id(), path);
    if (!meaning.ok()) return meaning.failure();
    Result<std::vector<double>> time = ReadVector(dataset->id(), path, *meaning);
    if (!time.ok()) return time.failure();
    if (!meaning->unit.empty()) {
      const std::optional<Unit> unit = ParseUnit(meaning->unit);
      if (!unit || !SameQuantity(*unit, *ParseUnit("s")))
        return BadInput(fmt::format("dataset \"{}\" has the unit \"{}\", which is none of time", path, meaning->unit));
      if (unit->factor != 1.0) {
        for (double& stamp : *time) stamp *= unit->factor;
      }
    }
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
    const Result<Handle> dataset = hdf5::OpenDataset(group, name, path);
    if (!dataset.ok()) return dataset.failure();
    const hid_t id = dataset->id();
    const Result<hdf5::Meaning> meaning = hdf5::ReadMeaning(id, path);
    if (!meaning.ok()) return meaning.failure();
    signal.unit = meaning->unit;
    Result<std::vector<double>> values = ReadVector(id, path, *meaning);
    if (!values.ok()) return values.failure();
    signal.values = *std::move(values);
    if (Status s = ReadTextAttribute(id, path, "description", signal.description)) return s;
    const Result<hdf5::Attribute> nominal = hdf5::ReadAttribute(id, "nominal");
    if (!nominal.ok()) return nominal.failure();
    signal.nominal_known = !std::holds_alternative<std::monostate>(*nominal);
    if (const auto* real = std::get_if<double>(&*nominal)) signal.nominal = *real;
    if (const auto* integer = std::get_if<std::int64_t>(&*nominal)) signal.nominal = static_cast<double>(*integer);
    if (std::holds_alternative<std::string>(*nominal) || std::holds_alternative<hdf5::Other>(*nominal)) {
      return BadInput(fmt::format("dataset \"{}\": attribute \"nominal\" is not a number", path));
    }
    std::string interpolation{ToText(signal.interpolation)};
    if (Status s = ReadTextAttribute(id, path, "interpolation", interpolation)) return s;
    const std::optional<Interpolation> parsed = ParseInterpolation(interpolation);
    if (!parsed) {
      return BadInput(
          fmt::format("dataset \"{}\": interpolation \"{}\" is neither \"linear\" nor \"hold\"", path, interpolation));
    }
    signal.interpolation = *parsed;

    std::string time = "/time";
    if (Status s = ReadTextAttribute(id, path, "time", time)) return s;
    const Result<std::size_t> base = TimeBase(time);
    if (!base.ok()) return BadInput(fmt::format("dataset \"{}\": its time base: {}", path, base.failure().message));
    signal.time_base = *base;
    if (const std::size_t stamps = trace_.TimeOf(signal).size(); signal.values.size() != stamps) {
      return BadInput(fmt::format("dataset \"{}\" has {} values, its time base \"{}\" {}", path, signal.values.size(),
                                  time, stamps));
    }
    trace_.signals.push_back(std::move(signal));
    return {};
  }

  static Status ReadTextAttribute(hid_t object, const std::string& path, const std::string& name, std::string& text) {
    const Result<hdf5::Attribute> value = hdf5::ReadAttribute(object, name);
    if (!value.ok()) return BadInput(fmt::format("dataset \"{}\": {}", path, value.failure().message));
    if (std::holds_alternative<std::monostate>(*value) || *value == hdf5::Attribute(hdf5::Other{0})) return {};
    if (const auto* found = std::get_if<std::string>(&*value)) {
      text = *found;
      return {};
    }
    return BadInput(fmt::format("dataset \"{}\": attribute \"{}\" is not a text", path, name));
  }

  Status ReadProvenance() {
    if (hdf5::KindOf(file_, "/provenance") == hdf5::Kind::kMissing) return {};
    const Result<Handle> group = hdf5::OpenGroup(file_, "/provenance");
    if (!group.ok()) return group.failure();
    const Result<std::vector<std::string>> names = hdf5::AttributeNames(group->id());
    if (!names.ok()) return names.failure();
    for (const std::string& name : *names) {
      const Result<hdf5::Attribute> value = hdf5::ReadAttribute(group->id(), name);
      if (!value.ok()) return BadInput("group \"/provenance\": " + value.failure().message);
      if (const auto* text = std::get_if<std::string>(&*value)) trace_.provenance.texts.emplace_back(name, *text);
      if (const auto* count = std::get_if<std::int64_t>(&*value)) trace_.provenance.counters.emplace_back(name, *count);
    }
    return {};
  }

  hid_t file_;
  Trace trace_;
  std::size_t values_ = 0;  // read so far
  std::map<std::string, std::size_t> time_bases_;
};

}  // namespace

std::string TimeBaseName(std::size_t k) { return k == 0 ? "/time" : fmt::format("/time_{}", k); }

bool HasTraceLayout(hid_t file) {
  const hdf5::Kind time = hdf5::KindOf(file, "/time"), signals = hdf5::KindOf(file, "/signals");
  if (time == hdf5::Kind::kBroken || signals == hdf5::Kind::kBroken) return true;  // was meant to be
  return time == hdf5::Kind::kDataset && signals == hdf5::Kind::kGroup;
}

Result<Trace> ReadTraceFrom(hid_t file) {
  Result<Trace> trace = TraceReader(file).Read();
  if (trace.ok()) return trace;
  Failure failure = trace.failure();
  failure.signal.clear();
  return failure;
}

}  // namespace dynoproof::trace
