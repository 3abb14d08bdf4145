#include "trace/mat_write.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "base/atomic_file.h"

namespace dynoproof::trace {
namespace {

std::string VariableOf(const std::string& name) {
  const bool letter = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0;
  std::string variable(letter ? 0 : 1, 'x');
  for (const char c : name) variable.push_back(std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_');
  return variable;
}

/// Header (type, rows, columns, no imaginary part, length of the name with its zero), name, values by column.
void Append(std::string& file, std::int32_t type, const std::string& name, std::size_t rows, std::size_t columns,
            const std::vector<double>& values) {
  const std::array<std::int32_t, 5> header = {type, static_cast<std::int32_t>(rows), static_cast<std::int32_t>(columns),
                                              0, static_cast<std::int32_t>(name.size() + 1)};
  const auto raw = [&file](const void* data, std::size_t size) { file.append(static_cast<const char*>(data), size); };
  raw(header.data(), sizeof(header));
  raw(name.c_str(), name.size() + 1);
  raw(values.data(), values.size() * sizeof(double));
}

}  // namespace

Status WriteMat(const std::filesystem::path& path, std::span<const Column> columns) {
  constexpr std::int32_t kNumbers = 0, kText = 1;  // doubles, little-endian
  const auto fail = [&](std::string message) {
    return Failure{.message = std::move(message), .signal = path.string(), .time_s = {}, .exit_code = 3};
  };
  if (columns.empty()) return fail("there are no columns to write");
  std::string file;
  std::set<std::string> known = {"units"};
  std::vector<std::string> units;
  std::size_t width = 0;
  for (const Column& column : columns) {
    const std::string variable = VariableOf(column.name);
    if (!known.insert(variable).second)
      return fail(fmt::format("two columns would be the variable \"{}\": choose some with --signals", variable));
    Append(file, kNumbers, variable, column.values.size(), 1, column.values);
    units.push_back(variable + ": " + (column.unit.empty() ? "?" : column.unit));
    width = std::max(width, units.back().size());
  }
  std::vector<double> text(units.size() * width, ' ');
  for (std::size_t row = 0; row < units.size(); ++row) {
    for (std::size_t k = 0; k < units[row].size(); ++k)
      text[k * units.size() + row] = static_cast<unsigned char>(units[row][k]);
  }
  Append(file, kText, "units", units.size(), width, text);
  return WriteFileAtomically(path, file);
}

}  // namespace dynoproof::trace
