// Measured data as a MAT file, version 4, which every tool that knows MAT files opens.
#pragma once

#include <filesystem>
#include <span>

#include "base/status.h"
#include "trace/record.h"

namespace dynoproof::trace {

/// Each column as a column vector of doubles under its name (characters that no variable may have become `_`), and a
/// character matrix `units` with a row "name: unit" each. Whole or not at all. Failure (exit code 3): no columns, two of
/// one name, or the file cannot be written.
Status WriteMat(const std::filesystem::path& path, std::span<const Column> columns);

}  // namespace dynoproof::trace
