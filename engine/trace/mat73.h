// MAT v7.3: an HDF5 file with MATLAB's 512 bytes before it, as MATLAB writes it and as programs in Python do.
#pragma once

#include <filesystem>
#include <vector>

#include "base/status.h"
#include "trace/mat_matrix.h"

namespace dynoproof::trace::mat {

/// The variables of a file: the datasets of its root. The type of a dataset says that it holds numbers; the attribute
/// MATLAB_class, which only some writers give, says where it means something else (text, a cell, an object). Extents
/// are turned round, since MATLAB counts the fastest one first. Reading is guarded as that of any HDF5 file
/// (hdf5_apart.h, hdf5_values.h).
Result<std::vector<Matrix>> ReadMat73(const std::filesystem::path& path);

}  // namespace dynoproof::trace::mat
