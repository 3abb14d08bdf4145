// The part of record.h that reads HDF5 files.
#include "trace/hdf5_record.h"

#include <utility>

#include "trace/hdf5.h"
#include "trace/hdf5_apart.h"
#include "trace/hdf5_datasets.h"
#include "trace/hdf5_trace.h"
#include "trace/hdf5_values.h"
#include "trace/record.h"

namespace dynoproof::trace {

template <class Archive>
void Members(Archive& archive, Column& column) {
  Pass(archive, column.name);
  Pass(archive, column.unit);
  Pass(archive, column.values);
  Pass(archive, column.time);
  Pass(archive, column.heading);
  Pass(archive, column.held);
}

template <class Archive>
void Members(Archive& archive, NonFinite& entry) {
  Pass(archive, entry.column);
  Pass(archive, entry.count);
  Pass(archive, entry.first_row);
  Pass(archive, entry.first_line);
}

template <class Archive>
void Members(Archive& archive, Record& record) {
  Pass(archive, record.source);
  Pass(archive, record.columns);
  Pass(archive, record.time);
  Pass(archive, record.non_finite);
  Pass(archive, record.notes);
  Pass(archive, record.left_out);
}

namespace {

using hdf5::Handle;

/// What `read` finds in the file, in a process of its own.
template <class T, class Read>
Result<T> ReadFileApart(const std::filesystem::path& path, const Read& read) {
  const hdf5::Session session;
  Result<T> result = ReadApart<T>(hdf5::LimitsFor(path), [&]() -> Result<T> {
    hdf5::StayInFile();
    const Result<Handle> file = hdf5::OpenFile(path.string());
    if (!file.ok()) return file.failure();
    return read(file->id());
  });
  if (result.ok()) return result;
  Failure failure = result.failure();
  failure.signal = path.string();
  return failure;
}

}  // namespace

Result<Record> ReadHdf5Record(const std::filesystem::path& path, std::span<const std::string> datasets,
                              std::span<const std::string> scaled_later) {
  Result<Record> record = ReadFileApart<Record>(path, [&](hid_t file) -> Result<Record> {
    if (!datasets.empty() || !HasTraceLayout(file)) return ReadDatasets(file, datasets, scaled_later);
    const Result<Trace> trace = ReadTraceFrom(file);
    if (!trace.ok()) return trace.failure();
    return ToRecord(*trace, "");
  });
  if (record.ok()) record->source = path.string();
  return record;
}

Result<std::vector<std::string>> ListHdf5Datasets(const std::filesystem::path& path) {
  return ReadFileApart<std::vector<std::string>>(path, [](hid_t file) -> Result<std::vector<std::string>> {
    const Result<Listing> listing = ListAll(file);
    if (!listing.ok()) return listing.failure();
    std::vector<std::string> numbers;
    for (const std::string& name : listing->datasets) {
      const Result<Handle> dataset = hdf5::OpenDataset(file, name);
      if (dataset.ok() && hdf5::HoldsNumbers(dataset->id())) numbers.push_back(name);
    }
    return numbers;
  });
}

}  // namespace dynoproof::trace
