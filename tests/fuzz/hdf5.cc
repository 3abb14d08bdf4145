// HDF5 files, as records and as traces.
#include "tests/fuzz/target.h"
#include "trace/hdf5_record.h"
#include "trace/trace_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dynoproof;
  const std::filesystem::path file = fuzz::InputFile("record.h5", data, size);
  fuzz::CheckRecord(trace::ReadHdf5Record(file));
  const Result<trace::Trace> read = trace::ReadTrace(file);
  if (read.ok()) {
    fuzz::Require(trace::Validate(*read).empty(), "a trace that is not valid was read");
  } else {
    fuzz::CheckFailure(read.failure());
  }
  return 0;
}
