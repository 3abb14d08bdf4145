// Map files.
#include "experiment/record_map.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dynoproof;
  Diagnostics diagnostics;
  const auto map = ReadRecordMap(fuzz::InputFile("map.toml", data, size).string(), diagnostics);
  fuzz::CheckDiagnostics(diagnostics, map.has_value());
  fuzz::Require(!map || map->first <= map->last, "rows that end before they begin");
  return 0;
}
