#include "sim/solver.h"

#include <fmt/format.h>

#include <algorithm>

namespace dynoproof {

std::optional<std::size_t> CorrectedAs(const std::vector<std::string>& nominal, const std::string& state) {
  const auto index = [&](const std::string& name) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(nominal, name);
    if (found == nominal.end()) return std::nullopt;
    return found - nominal.begin();
  };
  const std::size_t kind = state.rfind('.');
  if (const auto itself = index(state); itself || kind == std::string::npos || kind == 0) return itself;
  const std::size_t mark = state.find_last_of("._", kind - 1);
  if (mark == std::string::npos || state[mark] != '_') return std::nullopt;
  return index(state.substr(0, mark) + state.substr(kind));
}

Result<std::unique_ptr<Solver>> MakeSolver(const std::string& name, const Rig& rig) {
  if (name == "reference") return MakeReferenceSolver(rig);
  if (name == "realtime") return MakeRealtimeSolver(rig);
  return Failure{fmt::format("there is no solver \"{}\"; known: realtime, reference", name)};
}

}  // namespace dynoproof
