// The part of record.h that reads HDF5 files.
#include "trace/hdf5_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "trace/hdf5.h"
#include "trace/record.h"
#include "trace/trace_io.h"

namespace dynoproof::trace {
namespace {

using hdf5::Handle;

Failure Bad(std::string message, const std::string& where = {}) {
  return {.message = std::move(message), .signal = where, .time_s = {}, .exit_code = 2};
}

bool HoldsNumbers(hid_t dataset) {
  const Handle type(H5Dget_type(dataset));
  const H5T_class_t type_class = H5Tget_class(type.id());
  return type_class == H5T_FLOAT || type_class == H5T_INTEGER;
}

Result<std::vector<std::string>> ListDatasets(hid_t file) {
  std::vector<std::string> paths;
  const auto add = [](hid_t root, const char* name, const H5O_info_t* info, void* out) -> herr_t {
    if (info->type != H5O_TYPE_DATASET) return 0;
    const Handle dataset(H5Dopen2(root, name, H5P_DEFAULT));
    if (dataset.valid() && HoldsNumbers(dataset.id())) {
      static_cast<std::vector<std::string>*>(out)->push_back("/" + std::string(name));
    }
    return 0;
  };
  if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, add, &paths, H5O_INFO_BASIC) < 0) {
    return hdf5::LastError("the datasets cannot be listed");
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// "path[3]" -> ("path", 3); nothing if the name has no such end.
std::optional<std::pair<std::string, std::size_t>> SplitIndex(const std::string& name) {
  const std::size_t open = name.rfind('[');
  if (open == std::string::npos || open == 0 || name.back() != ']') return {};
  std::size_t index = 0;
  const char* const end = name.data() + name.size() - 1;
  const auto parsed = std::from_chars(name.data() + open + 1, end, index);
  if (parsed.ec != std::errc() || parsed.ptr != end) return {};
  return std::pair(name.substr(0, open), index);
}

Result<std::string> ReadUnit(hid_t dataset) {
  for (const char* name : {"unit", "units"}) {
    const Result<hdf5::Attribute> value = hdf5::ReadAttribute(dataset, name);
    if (!value.ok()) return value.failure();
    if (const auto* text = std::get_if<std::string>(&*value)) return *text;
  }
  return std::string();
}

/// Appends the column or columns that `name` asks for.
Status ReadColumns(hid_t file, const std::string& name, std::vector<Column>& columns) {
  std::string path = name;
  std::optional<std::size_t> wanted;
  if (hdf5::KindOf(file, path) != hdf5::Kind::kDataset) {
    if (const auto split = SplitIndex(name)) {
      path = split->first;
      wanted = split->second;
    }
  }
  const Result<Handle> dataset = hdf5::OpenDataset(file, path);
  if (!dataset.ok()) {
    const Result<std::vector<std::string>> known = ListDatasets(file);
    return Bad(fmt::format("there is no dataset \"{}\"; the file has: {}", path,
                           known.ok() ? fmt::format("{}", fmt::join(*known, ", ")) : known.failure().message));
  }
  std::vector<std::size_t> shape = hdf5::Shape(dataset->id());
  const std::vector<std::size_t> stored = shape;
  std::erase(shape, 1U);
  if (shape.size() > 2) {
    return Bad(
        fmt::format("dataset \"{}\" has extents {}, at most two may be above 1", path, fmt::join(stored, " x ")));
  }
  Result<std::vector<double>> values = hdf5::ReadDoubles(dataset->id(), path);
  if (!values.ok()) return values.failure();
  const Result<std::string> unit = ReadUnit(dataset->id());
  if (!unit.ok()) return unit.failure();

  const std::size_t width = shape.size() == 2 ? shape[1] : 1;
  if (wanted && *wanted >= width) {
    return Bad(fmt::format("dataset \"{}\" has {} columns, there is no \"{}\"", path, width, name));
  }
  if (width == 1) {
    columns.push_back({.name = name, .unit = *unit, .values = *std::move(values), .time = {}});
    return {};
  }
  for (std::size_t j = 0; j < width; ++j) {
    if (wanted && *wanted != j) continue;
    Column column{.name = fmt::format("{}[{}]", path, j), .unit = *unit, .values = {}, .time = {}};
    column.values.reserve(shape[0]);
    for (std::size_t i = 0; i < shape[0]; ++i) column.values.push_back((*values)[i * width + j]);
    columns.push_back(std::move(column));
  }
  return {};
}

}  // namespace

Result<Record> ReadHdf5Record(const std::filesystem::path& path, std::span<const std::string> datasets) {
  if (datasets.empty()) {
    const Result<Trace> trace = ReadTraceUnchecked(path);
    if (trace.ok()) return ToRecord(*trace, path.string());
    Failure failure = trace.failure();
    if (const auto known = ListHdf5Datasets(path); known.ok()) {
      failure.message += fmt::format("; datasets of numbers in the file: {}", fmt::join(*known, ", "));
    }
    return failure;
  }
  const hdf5::Session session;
  const Result<Handle> file = hdf5::OpenFile(path.string());
  if (!file.ok()) return Bad(file.failure().message, path.string());
  Record record;
  record.source = path.string();
  for (const std::string& name : datasets) {
    if (Status s = ReadColumns(file->id(), name, record.columns)) return Bad(s->message, path.string());
  }
  FinishRecord(record);
  return record;
}

Result<std::vector<std::string>> ListHdf5Datasets(const std::filesystem::path& path) {
  const hdf5::Session session;
  const Result<Handle> file = hdf5::OpenFile(path.string());
  if (!file.ok()) return Bad(file.failure().message, path.string());
  Result<std::vector<std::string>> paths = ListDatasets(file->id());
  if (!paths.ok()) return Bad(paths.failure().message, path.string());
  return paths;
}

}  // namespace dynoproof::trace
