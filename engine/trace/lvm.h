// LabVIEW measurement files (.lvm): a header that says how the numbers are written, then one block of channels.
#pragma once

#include <string_view>
#include <vector>

#include "trace/csv_layout.h"

namespace dynoproof::trace::csv {

bool IsLvm(std::string_view first_line);

/// The layout of such a file. Without an X column the times are X0 + i Delta_X, which all channels must share. Refused
/// in one sentence: an X column for every channel, a header that is not whole.
Layout FindLvmLayout(const std::vector<HeadLine>& head);

/// Whether a line begins another block, with times of its own.
bool BeginsLvmBlock(std::string_view line);

}  // namespace dynoproof::trace::csv
