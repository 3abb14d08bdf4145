// Golden tolerances.
#include "experiment/golden.h"

#include <cmath>

#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dynoproof;
  const auto golden = ReadTolerances(fuzz::InputFile("golden.toml", data, size).string());
  if (!golden.ok()) {
    fuzz::CheckFailure(golden.failure());
    return 0;
  }
  for (const auto& [name, tolerance] : golden->signals)
    fuzz::Require(std::isfinite(tolerance.relative_width) && tolerance.relative_width >= 0.0,
                  "a tolerance that lets everything pass, of " + name);
  return 0;
}
