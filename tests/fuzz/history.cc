// The results that a history takes in.
#include <cmath>
#include <nlohmann/json.hpp>

#include "history/reading.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dynoproof;
  const nlohmann::json document = history::ParseResult({reinterpret_cast<const char*>(data), size});
  if (document.is_discarded()) return 0;
  const auto readings = history::Readings(document);
  if (!readings.ok()) {
    fuzz::CheckFailure(readings.failure());
    return 0;
  }
  for (const history::Reading& reading : *readings)
    fuzz::Require(!reading.value || std::isfinite(*reading.value), "a reading that is no number: " + reading.series);
  return 0;
}
