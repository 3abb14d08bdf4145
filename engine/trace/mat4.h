// MAT v4: matrix after matrix, each a header of five words, a name and numbers. What Dymola and OpenModelica write.
#pragma once

#include <cstdint>
#include <istream>

#include "trace/mat_matrix.h"

namespace dynoproof::trace::mat {

/// Whether the first four bytes of a file can begin a v4 matrix.
bool LooksLike4(const char* bytes);

/// All matrices. Every extent is held against the bytes that are there before anything is allocated, and the last
/// matrix ends where the file does. The format has no checksum: a changed bit within the numbers goes unseen.
Content ReadMat4(std::istream& file, std::uint64_t size);

}  // namespace dynoproof::trace::mat
