// MAT v5 to v7: a header of 128 bytes, then one element a variable, plain or compressed by zlib.
#pragma once

#include <cstdint>
#include <istream>

#include "trace/mat_matrix.h"

namespace dynoproof::trace::mat {

/// Whether the 128 bytes are the header of such a file.
bool LooksLike5(const char* header);

/// The most that the compressed variables of one file may unpack to, together.
inline constexpr std::uint64_t kMostUnpackedBytes = std::uint64_t{1} << 30;

/// All variables. Every element and every part of one lies within what holds it and fills it; the bytes of numbers are
/// as many as the extents say; a compressed element unpacks to exactly one variable, with zlib's checksum over it. So a
/// changed bit in a compressed variable is found. Plain variables have no checksum: within numbers it goes unseen.
Content ReadMat5(std::istream& file, std::uint64_t size);

}  // namespace dynoproof::trace::mat
