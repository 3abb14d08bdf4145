// Traces as HDF5 files.
//
//   /time            float64 [n]        seconds
//   /time_<k>        float64 [n_k]      seconds, k = 1, 2, ...: the time bases of signals of another rate
//   /signals/<name>  float64 [n or n_k] attributes unit, description (text), nominal (float64), interpolation
//                                       ("linear", "hold"); `time` = "/time_<k>" for a signal of another rate, absent
//                                       otherwise
//   /scenario        text               the resolved TOML
//   /provenance      group              its attributes: texts and integers (int64)
//
// Strings are UTF-8 of fixed length. Datasets are chunked with a Fletcher-32 checksum a chunk and metadata carry HDF5's
// own checksums, so damage in a file is found on reading (except inside a scenario of more than 60 kB). The format is
// that of HDF5 1.10 (2016) and later. Equal traces give equal bytes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "base/status.h"
#include "trace/trace.h"

namespace dynoproof::trace {

/// Smaller traces are not compressed unless asked for. For 100 000 samples of 6 signals (5.6 MB), level 1 saved 46 %
/// and took 130 ms instead of 25 ms; levels 4 to 9 saved 1 % more. Most runs are quicker than that; a long one gains
/// space.
inline constexpr std::size_t kCompressFromBytes = 8U << 20;

struct WriteOptions {
  /// -1: 0 below kCompressFromBytes of numbers, else 1; 0: not compressed; 1 (fast) to 9 (small).
  int deflate_level = -1;
};

/// The bytes of the file. Failure (exit code 3): Validate() or ValidateProvenance() object, or a text does not fit.
Result<std::vector<std::byte>> ToImage(const Trace& trace, const WriteOptions& options = {});

/// Writes the file whole or not at all (base/atomic_file.h); missing folders are created. Failure (exit code 3,
/// `signal` = path): as ToImage() and WriteFileAtomically(); what was under the name is untouched then.
Status WriteTrace(const std::filesystem::path& path, const Trace& trace, const WriteOptions& options = {});

/// Reads a file in the layout above, in a process of its own (hdf5_apart.h). Unknown further objects are ignored, and
/// attributes that change no values (hdf5_meaning.h); missing attributes take the defaults of Signal; `/scenario` and
/// `/provenance` may be missing; integers and float32 are converted; times whose unit is another than s become seconds.
/// Failure (exit code 2, `signal` = path): not HDF5, damaged, `/time` or `/signals` missing, wrong rank, values that the
/// file does not hold (hdf5_values.h), and all that Validate() says.
Result<Trace> ReadTrace(const std::filesystem::path& path);

/// The same without the final Validate(): for measured records, whose faults are reported one by one (csv.h, record.h).
/// Every signal still has the length of its time base.
Result<Trace> ReadTraceUnchecked(const std::filesystem::path& path);

}  // namespace dynoproof::trace
