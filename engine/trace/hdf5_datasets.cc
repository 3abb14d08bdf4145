#include "trace/hdf5_datasets.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>
#include <utility>

#include "base/bad_input.h"
#include "trace/hdf5_attributes.h"
#include "trace/hdf5_meaning.h"
#include "trace/hdf5_record.h"
#include "trace/hdf5_values.h"

namespace dynoproof::trace {
namespace {

using hdf5::Handle;

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

std::string_view LastPart(std::string_view path) { return path.substr(path.rfind('/') + 1); }
/// "/a/b/x" -> "/a/b", "/x" -> "".
std::string_view GroupOf(std::string_view path) {
  const std::size_t end = path.rfind('/');
  return path.substr(0, end == std::string_view::npos ? 0 : end);
}

/// A dataset that is to be read.
struct Planned {
  std::string path, name = {};  // name: of its column or columns
  std::optional<std::size_t> only = {};
  Handle dataset = {};
  hdf5::Meaning meaning = {};
  std::size_t signals = 1, samples = 0;
  bool by_rows = false;
};

std::string KindOfType(hid_t dataset) {
  const Handle type(H5Dget_type(dataset));
  switch (H5Tget_class(type.id())) {
    case H5T_STRING:
      return "is text";
    case H5T_COMPOUND:
      return "is a table of rows with fields: store each field as a dataset of its own";
    case H5T_ENUM:
      return "holds names or truth values, not numbers";
    case H5T_REFERENCE:
      return "holds references to others";
    default:
      return "does not hold numbers";
  }
}

/// What netCDF leaves where a dimension has a length but no coordinates.
Result<bool> IsBareDimension(hid_t dataset) {
  const Result<hdf5::Attribute> name = hdf5::ReadAttribute(dataset, "NAME");
  if (!name.ok()) return name.failure();
  const auto* const text = std::get_if<std::string>(&*name);
  return text != nullptr && text->starts_with("This is a netCDF dimension but not a netCDF variable");
}

class DatasetsReader {
 public:
  DatasetsReader(hid_t file, std::span<const std::string> scaled_later) : file_(file), scaled_later_(scaled_later) {}

  Result<Record> Asked(std::span<const std::string> wanted) {
    for (const std::string& name : wanted) {
      if (Status s = PlanAsked(name)) return *s;
    }
    return Read();
  }

  Result<Record> All() {
    const Result<Listing> listing = ListAll(file_);
    if (!listing.ok()) return listing.failure();
    for (const auto& [path, other] : listing->links_out)
      LeaveOut(path, fmt::format("is a link into another file, \"{}\", which is not followed", other));
    for (const std::string& path : listing->datasets) {
      if (Status s = PlanAny(path)) return *s;
    }
    std::map<std::string, int, std::less<>> uses;
    for (const Planned& planned : plan_) ++uses[std::string(LastPart(planned.path))];
    for (Planned& planned : plan_) {
      const std::string_view last = LastPart(planned.path);
      planned.name = uses.find(last)->second == 1 ? std::string(last) : planned.path;
    }
    Result<Record> record = Read();
    if (!record.ok() || !record->columns.empty()) return record;
    std::string message = "it holds no dataset of numbers that can be a column";
    for (const auto& [name, why] : record->left_out) message += fmt::format("\ndataset \"{}\" {}", name, why);
    return BadInput(message);
  }

 private:
  void LeaveOut(std::string path, std::string why) { record_.left_out.emplace_back(std::move(path), std::move(why)); }

  bool ScaledLater(const std::string& path) const {
    return std::ranges::any_of(scaled_later_, [&](const std::string& name) {
      return name == path || name == LastPart(path) || SplitIndex(name).value_or(std::pair(name, 0)).first == path;
    });
  }

  /// How a dataset lies: signals and samples. Failure: it has more than two dimensions.
  static Status Lay(Planned& planned, std::vector<std::size_t> shape) {
    const std::string extents = fmt::format("{}", fmt::join(shape, " x "));
    std::erase(shape, 1U);
    if (shape.size() > 2)
      return BadInput(fmt::format("dataset \"{}\" has extents {}, at most two may be above 1", planned.path, extents));
    planned.samples = shape.empty() ? 1 : shape[0];
    if (shape.size() < 2) return {};
    planned.by_rows = shape[1] > shape[0];
    planned.signals = std::min(shape[0], shape[1]);
    planned.samples = std::max(shape[0], shape[1]);
    return {};
  }

  /// The path that a name means: itself, or the only one that ends in it; "" if there is none.
  std::string PathOf(const std::string& name) const {
    if (hdf5::KindOf(file_, name) != hdf5::Kind::kMissing) return name;
    const Result<Listing> listing = ListAll(file_);
    std::string path;
    for (std::size_t k = 0; listing.ok() && k < listing->datasets.size(); ++k) {
      if (LastPart(listing->datasets[k]) != name) continue;
      if (!path.empty()) return "";
      path = listing->datasets[k];
    }
    return path;
  }

  Status PlanAsked(const std::string& name) {
    Planned planned{.path = PathOf(name), .name = name};
    if (planned.path.empty()) {
      if (const auto split = SplitIndex(name)) {
        planned.path = PathOf(split->first);
        planned.name = split->first;
        planned.only = split->second;
      }
    }
    if (planned.path.empty()) planned.path = planned.name;
    Result<Handle> dataset = hdf5::OpenDataset(file_, planned.path);
    if (!dataset.ok()) {
      if (!hdf5::LinkOut(file_, planned.path).empty()) return dataset.failure();
      return BadInput(fmt::format("there is no dataset \"{}\"; the file has: {}", planned.path, NamesOfNumbers()));
    }
    planned.dataset = *std::move(dataset);
    if (!hdf5::HoldsNumbers(planned.dataset.id()))
      return BadInput(fmt::format("dataset \"{}\" {}", planned.path, KindOfType(planned.dataset.id())));
    const Result<hdf5::Space> space = hdf5::SpaceOf(planned.dataset.id(), fmt::format("dataset \"{}\"", planned.path));
    if (!space.ok()) return space.failure();
    if (Status s = Lay(planned, space->shape)) return s;
    if (planned.only && *planned.only >= planned.signals)
      return BadInput(
          fmt::format("dataset \"{}\" has {} columns, there is no \"{}\"", planned.path, planned.signals, name));
    Result<hdf5::Meaning> meaning =
        hdf5::ReadMeaning(planned.dataset.id(), planned.path, ScaledLater(name) || ScaledLater(planned.path));
    if (!meaning.ok()) return meaning.failure();
    planned.meaning = *std::move(meaning);
    plan_.push_back(std::move(planned));
    return {};
  }

  Status PlanAny(const std::string& path) {
    Planned planned{.path = path};
    Result<Handle> dataset = hdf5::OpenDataset(file_, path);
    if (!dataset.ok()) return dataset.failure();
    planned.dataset = *std::move(dataset);
    const hid_t id = planned.dataset.id();
    if (!hdf5::HoldsNumbers(id)) return LeaveOut(path, KindOfType(id)), Status();
    const Result<hdf5::Space> space = hdf5::SpaceOf(id, fmt::format("dataset \"{}\"", path));
    if (!space.ok()) return space.failure();
    if (space->count == 0) return LeaveOut(path, "is empty"), Status();
    if (space->count == 1) return LeaveOut(path, "is a single number"), Status();
    if (Lay(planned, space->shape))
      return LeaveOut(path, fmt::format("has extents {}, of which at most two may be above 1",
                                        fmt::join(space->shape, " x "))),
             Status();
    if (planned.signals > kMostSignalsOfMatrix)
      return LeaveOut(path,
                      fmt::format("is a matrix of {} signals: name those to read, \"{}[0]\"", planned.signals, path)),
             Status();
    const Result<bool> bare = IsBareDimension(id);
    if (!bare.ok()) return BadInput(fmt::format("dataset \"{}\": {}", path, bare.failure().message));
    if (*bare) return LeaveOut(path, "is a dimension without values"), Status();
    Result<hdf5::Meaning> meaning = hdf5::ReadMeaning(id, path, ScaledLater(path));
    if (!meaning.ok() && meaning.failure().signal != hdf5::kRefused) return meaning.failure();
    if (!meaning.ok()) {
      std::string why = meaning.failure().message;
      const std::string prefix = fmt::format("dataset \"{}\": ", path);
      if (why.starts_with(prefix)) why.erase(0, prefix.size());
      return LeaveOut(path, "cannot be taken: " + why), Status();
    }
    planned.meaning = *std::move(meaning);
    plan_.push_back(std::move(planned));
    return {};
  }

  std::string NamesOfNumbers() const {
    const Result<Listing> listing = ListAll(file_);
    if (!listing.ok()) return listing.failure().message;
    std::vector<std::string> names;
    for (const std::string& path : listing->datasets) {
      const Result<Handle> dataset = hdf5::OpenDataset(file_, path);
      if (dataset.ok() && hdf5::HoldsNumbers(dataset->id())) names.push_back(path);
    }
    return fmt::format("{}", fmt::join(names, ", "));
  }

  /// Reads what was planned: all attributes are known by then.
  Result<Record> Read() {
    std::size_t values = 0;
    for (const Planned& planned : plan_) {
      const std::size_t signals = planned.only ? 1 : planned.signals;
      if (planned.samples > hdf5::kMostBytes || planned.samples * signals > hdf5::kMostBytes / sizeof(double) - values)
        return BadInput(
            fmt::format("dataset \"{}\" is the one with which there are more than {} values to read: name the "
                        "datasets that are needed",
                        planned.path, hdf5::kMostBytes / sizeof(double)));
      values += planned.samples * signals;
    }
    for (const Planned& planned : plan_) {
      if (Status s = ReadOne(planned)) return *s;
    }
    SetTimes();
    FinishRecord(record_);
    return std::move(record_);
  }

  Status ReadOne(const Planned& planned) {
    if (planned.path != last_path_) {  // one matrix may be asked for signal by signal
      last_.clear();
      last_path_ = planned.path;
      Result<std::vector<double>> values = hdf5::ReadMeasured(planned.dataset.id(), planned.path, planned.meaning);
      if (!values.ok()) return values.failure();
      last_ = *std::move(values);
    }
    const auto heading = [&](const std::string& path) { return path.starts_with('/') ? path : "/" + path; };
    if (planned.signals == 1) {
      record_.columns.push_back({.name = planned.name, .unit = planned.meaning.unit, .values = std::move(last_)});
      record_.columns.back().heading = heading(planned.path);
      record_.columns.back().held = planned.meaning.holds;
      last_path_.clear();
      return {};
    }
    if (planned.by_rows && !planned.only)
      record_.notes.push_back(fmt::format(
          "dataset \"{0}\" is {1} x {2}: its rows are the columns \"{3}[0]\" to \"{3}[{4}]\", of {2} samples "
          "each",
          planned.path, planned.signals, planned.samples, planned.name, planned.signals - 1));
    for (std::size_t j = 0; j < planned.signals; ++j) {
      if (planned.only && *planned.only != j) continue;
      Column column{.name = fmt::format("{}[{}]", planned.name, j), .unit = planned.meaning.unit};
      column.heading = fmt::format("{}[{}]", heading(planned.path), j);
      column.values.reserve(planned.samples);
      for (std::size_t i = 0; i < planned.samples; ++i)
        column.values.push_back(last_[planned.by_rows ? j * planned.samples + i : i * planned.signals + j]);
      record_.columns.push_back(std::move(column));
    }
    return {};
  }

  void SetTimes() {
    for (Column& column : record_.columns) {
      if (IsTimeName(LastPart(column.heading))) continue;
      for (std::string_view group = GroupOf(column.heading);; group = GroupOf(group)) {
        for (std::size_t k = 0; k < record_.columns.size() && !column.time; ++k) {
          const Column& time = record_.columns[k];
          if (IsTimeName(LastPart(time.heading)) && GroupOf(time.heading) == group &&
              time.values.size() == column.values.size())
            column.time = k;
        }
        if (column.time || group.empty()) break;
      }
    }
  }

  hid_t file_;
  std::span<const std::string> scaled_later_;
  std::vector<Planned> plan_;
  Record record_;
  std::string last_path_;  // the dataset whose values are at hand
  std::vector<double> last_;
};

}  // namespace

Result<Listing> ListAll(hid_t file) {
  Listing listing;
  const auto object = [](hid_t, const char* name, const H5O_info_t* info, void* out) -> herr_t {
    if (info->type == H5O_TYPE_DATASET) static_cast<Listing*>(out)->datasets.push_back("/" + std::string(name));
    return 0;
  };
  if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, object, &listing, H5O_INFO_BASIC) < 0)
    return hdf5::LastError("the datasets cannot be listed");
  const auto link = [&](const char* name, const H5L_info_t& info) {
    if (info.type == H5L_TYPE_EXTERNAL)
      listing.links_out.emplace_back("/" + std::string(name), hdf5::LinkOut(file, name));
  };
  if (Status s = hdf5::VisitLinks(file, link)) return *s;
  std::ranges::sort(listing.datasets);
  return listing;
}

Result<Record> ReadDatasets(hid_t file, std::span<const std::string> wanted,
                            std::span<const std::string> scaled_later) {
  DatasetsReader reader(file, scaled_later);
  return wanted.empty() ? reader.All() : reader.Asked(wanted);
}

}  // namespace dynoproof::trace
