// Measured data as text: writing it as the reader (csv.h) reads it.
#pragma once

#include <filesystem>
#include <span>

#include "base/status.h"
#include "trace/record.h"

namespace dynoproof::trace {

/// Writes columns of equal length: names, units (if any column has one; "1" becomes "-"), then the shortest decimals
/// that read back as the same doubles. Whole or not at all (base/atomic_file.h). Failure (exit code 3): lengths differ,
/// no columns, names empty or twice, or the file cannot be written.
Status WriteCsv(const std::filesystem::path& path, std::span<const Column> columns, char separator = ',');

}  // namespace dynoproof::trace
