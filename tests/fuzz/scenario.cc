// Scenario files: what was read is written and read again as the same.
#include <fstream>

#include "scenario/load.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dynoproof;
  const std::filesystem::path file = fuzz::InputFile("scenario.toml", data, size);
  Diagnostics diagnostics;
  const std::optional<Plan> plan = LoadPlan(file.string(), {}, diagnostics);
  fuzz::CheckDiagnostics(diagnostics, plan.has_value());
  if (!plan || diagnostics.has_errors()) return 0;
  const std::string text = ToToml(plan->root);
  const std::filesystem::path again =
      fuzz::InputFile("again.toml", reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const std::optional<Plan> back = LoadPlan(again.string(), {}, diagnostics);
  fuzz::Require(back && !diagnostics.has_errors(), "what was written cannot be read:\n" + text + diagnostics.Format());
  fuzz::Require(ToToml(back->root) == text, "what was written is read as something else:\n" + text);
  return 0;
}
