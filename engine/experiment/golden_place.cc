#include "experiment/golden_place.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/text.h"
#include "experiment/golden.h"
#include "scenario/find.h"
#include "scenario/load.h"

namespace dynoproof {

GoldenPlace GoldenPlaceOf(const Plan& plan, const std::string& folder) {
  namespace fs = std::filesystem;
  const bool own = IsOwnScenario(plan.file);
  const fs::path file = plan.file;
  const fs::path place = !folder.empty() ? fs::path(folder) : own ? file.parent_path() : fs::path(GoldenFolder());
  const std::string stem = (place / (own ? file.stem().string() + ".golden" : plan.id)).string();
  const std::string named = folder.empty() ? "" : " --golden " + ShellQuoted(folder);
  return {stem + ".h5", stem + ".toml",
          fmt::format("dynoproof bless {}{} --reason TEXT", own ? ShellQuoted(plan.file) : plan.id, named)};
}

}  // namespace dynoproof
