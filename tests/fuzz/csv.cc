// Text files of columns.
#include "trace/csv.h"

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dynoproof;
  fuzz::CheckRecord(trace::ReadCsv(fuzz::InputFile("record.csv", data, size)));
  return 0;
}
