#include "trace/mat.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <new>
#include <string_view>
#include <utility>

#include "trace/mat4.h"
#include "trace/mat5.h"
#include "trace/mat73.h"
#include "trace/mat_matrix.h"
#include "trace/mat_result.h"

namespace dynoproof::trace {
namespace {

Failure Bad(const std::filesystem::path& path, std::string message) {
  return {.message = std::move(message), .signal = path.string(), .time_s = {}, .exit_code = 2};
}

/// Whether HDF5 begins at one of the places where it may: at the start, or behind MATLAB's 512 bytes.
bool HoldsHdf5(std::istream& file, std::uint64_t size) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  for (const std::uint64_t at : {0, 512}) {
    char bytes[kSignature.size()];
    file.seekg(static_cast<std::streamoff>(at));
    if (size >= at + sizeof bytes && file.read(bytes, sizeof bytes) &&
        kSignature == std::string_view(bytes, sizeof bytes))
      return true;
    file.clear();
  }
  return false;
}

Result<Record> ToColumns(const std::filesystem::path& path, std::vector<mat::Matrix> matrices) {
  Record record;
  record.source = path.string();
  if (mat::IsResult(matrices)) {
    if (const std::string fault = mat::AddResult(matrices, record); !fault.empty())
      return Bad(path, "is a result of a simulator, but damaged or cut short: " + fault);
  } else {
    for (mat::Matrix& matrix : matrices) mat::AddColumns(std::move(matrix), record);
  }
  if (record.columns.empty()) {
    std::string message = record.left_out.empty() ? "holds no variables: it is damaged, or was never filled"
                                                  : "holds no variable that can be a column";
    constexpr std::size_t kMost = 20;
    for (std::size_t i = 0; i < std::min(record.left_out.size(), kMost); ++i)
      message += fmt::format("\nvariable \"{}\" {}", record.left_out[i].first, record.left_out[i].second);
    if (record.left_out.size() > kMost) message += fmt::format("\nand {} more", record.left_out.size() - kMost);
    return Bad(path, message);
  }
  FinishRecord(record);
  return record;
}

}  // namespace

Result<Record> ReadMat(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff end = file ? static_cast<std::streamoff>(file.tellg()) : -1;
  if (end < 0 || std::filesystem::is_directory(path)) return Bad(path, "cannot be read");
  const auto size = static_cast<std::uint64_t>(end);
  if (size == 0) return Bad(path, "is empty");
  try {
    if (HoldsHdf5(file, size)) {
      Result<std::vector<mat::Matrix>> matrices = mat::ReadMat73(path);
      if (!matrices.ok()) {
        Failure failure = matrices.failure();
        failure.signal = path.string();
        return failure;
      }
      return ToColumns(path, *std::move(matrices));
    }
    char header[128] = {};
    file.seekg(0);
    file.read(header, sizeof header);
    file.clear();
    const bool is_5 = mat::LooksLike5(header);
    if (!is_5 && !mat::LooksLike4(header)) return Bad(path, "is no MAT file, or damaged from its first bytes on");
    mat::Content content = is_5 ? mat::ReadMat5(file, size) : mat::ReadMat4(file, size);
    if (!content.fault.empty()) return Bad(path, "is damaged or cut short: " + content.fault);
    return ToColumns(path, std::move(content.matrices));
  } catch (const std::bad_alloc&) {
    return Bad(path, "does not fit into memory");
  }
}

}  // namespace dynoproof::trace
