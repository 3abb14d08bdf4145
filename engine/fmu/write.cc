#include <fmt/format.h>
#include <zip.h>

#include <cstring>
#include <memory>

#include "base/atomic_file.h"
#include "base/text.h"
#include "fmu/unit.h"
#include "scenario/load.h"

namespace dynoproof::fmu {
namespace {

namespace fs = std::filesystem;

/// The scenario in one file, without what compares and records it: checks, records, golden data, variants. An importer drives its inputs;
/// run by itself they keep what they begin with.
Value Alone(const Plan& plan, const Fmu& unit) {
  Value root = plan.root;
  for (const char* section :
       {"check", "record", "golden", "variant", "extension", "analysis", "budget", "include", "of_record"})
    root.Erase(section);
  for (const Variable& input : unit.inputs) {
    Value* own = root.FindPath("input." + input.name);
    if (own != nullptr) (*own)["source"] = Value{{"type", "constant"}, {"value", input.start}};
  }
  return root;
}

/// The shared library of units, beside this program or in the libraries of its installation.
Result<std::string> Library() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* place : {"dynoproof_fmu.so", "../lib/dynoproof/dynoproof_fmu.so"}) {
    if (const std::optional<std::string> bytes = ReadTextFile((folder / place).string())) return *bytes;
  }
  return Failure{.message = fmt::format("dynoproof_fmu.so is neither in {} nor in ../lib/dynoproof", folder.string()),
                 .signal = "the library of units"};
}

/// A zip file in memory.
class Archive {
 public:
  Archive() {
    zip_error_init(&error_);
    source_ = zip_source_buffer_create(nullptr, 0, 0, &error_);
    if (source_ == nullptr) return;
    zip_source_keep(source_);
    zip_ = zip_open_from_source(source_, ZIP_TRUNCATE, &error_);
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  ~Archive() {
    if (zip_ != nullptr) zip_discard(zip_);
    if (source_ != nullptr) zip_source_free(source_);
    zip_error_fini(&error_);
  }

  /// `bytes` outlive the archive.
  bool Add(const char* name, std::string_view bytes) {
    if (zip_ == nullptr) return false;
    zip_source_t* content = zip_source_buffer(zip_, bytes.data(), bytes.size(), 0);
    if (content == nullptr) return false;
    const zip_int64_t index = zip_file_add(zip_, name, content, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(content);
      return false;
    }
    // The same scenario makes the same file, whenever it is written.
    constexpr zip_uint16_t kFirstDay = (1 << 5) | 1;  // 1980-01-01, where the format's time begins
    return zip_file_set_dostime(zip_, static_cast<zip_uint64_t>(index), 0, kFirstDay, 0) == 0;
  }

  /// Its bytes; nothing where something failed.
  std::optional<std::string> Close() {
    if (zip_ == nullptr || zip_close(zip_) != 0) return std::nullopt;
    zip_ = nullptr;
    zip_stat_t stat;
    zip_stat_init(&stat);
    if (zip_source_stat(source_, &stat) != 0 || zip_source_open(source_) != 0) return std::nullopt;
    std::string bytes(stat.size, '\0');
    const bool read = zip_source_read(source_, bytes.data(), bytes.size()) == static_cast<zip_int64_t>(bytes.size());
    zip_source_close(source_);
    return read ? std::optional(std::move(bytes)) : std::nullopt;
  }

 private:
  zip_error_t error_;
  zip_source_t* source_ = nullptr;
  zip_t* zip_ = nullptr;
};

}  // namespace

Status Write(const fs::path& file, const Fmu& unit, const Plan& plan) {
  const Result<std::string> library = Library();
  if (!library.ok()) return library.failure();
  std::error_code error;
  const std::string description = ModelDescription(unit), scenario = ToToml(Alone(plan, unit)),
                    program = fs::read_symlink("/proc/self/exe", error).string();
  const std::string name = fmt::format("binaries/linux64/{}.so", unit.identifier);
  Archive archive;
  const bool added = archive.Add("modelDescription.xml", description) && archive.Add(name.c_str(), *library) &&
                     archive.Add("resources/scenario.toml", scenario) &&
                     archive.Add("resources/program.txt", program) && archive.Add("resources/guid.txt", unit.guid);
  const std::optional<std::string> bytes = added ? archive.Close() : std::nullopt;
  if (!bytes) return Failure{.message = "the archive cannot be made", .signal = file.string()};
  return WriteFileAtomically(file, std::string_view(*bytes));
}

}  // namespace dynoproof::fmu
