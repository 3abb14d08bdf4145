// Campaign files. Reading one runs nothing.
#include "campaign/campaign.h"

#include "experiment/checks.h"
#include "tests/fuzz/target.h"

namespace {

/// What the campaigns of the corpus vary.
constexpr std::string_view kLine = R"(title = "two masses"
source = "made up"
[run]
duration_s = 0.05
[plant]
type = "drive_line"
inertia = { I1 = 2.0, I3 = 0.5 }
torque.T_airgap.on = "I1"
[plant.shaft.k1]
between = ["I1", "I3"]
stiffness_Nm_per_rad = 4.0e5
[input.T_airgap]
to = "plant.T_airgap"
source = { type = "constant", value = 100.0 }
[output.T_shaft]
of = "plant.k1.torque"
[[check]]
kind = "solvers"
signal = "T_shaft"
nrmse = 1e-6
origin = "made up"
)";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dynoproof;
  static const Registry* const registry = [] {
    auto* made = new Registry;  // lives as long as the process
    RegisterBuiltIns(*made);
    RegisterChecks(*made);
    return made;
  }();
  static const std::filesystem::path line =
      fuzz::InputFile("line.toml", reinterpret_cast<const std::uint8_t*>(kLine.data()), kLine.size());
  const std::filesystem::path file = fuzz::InputFile("campaign.toml", data, size);
  Diagnostics diagnostics;
  const auto read = campaign::LoadCampaign(file.string(), line.parent_path().string(), *registry, diagnostics);
  fuzz::CheckDiagnostics(diagnostics, read != nullptr);
  return 0;
}
