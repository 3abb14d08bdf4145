// MAT files, v4 to v7.3.
#include "trace/mat.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dynoproof;
  fuzz::CheckRecord(trace::ReadMat(fuzz::InputFile("record.mat", data, size)));
  return 0;
}
