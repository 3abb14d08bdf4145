#include "sim/solver.h"

#include <fmt/format.h>

namespace dynoproof {

Result<std::unique_ptr<Solver>> MakeSolver(const std::string& name, const Rig& rig) {
  if (name == "reference") return MakeReferenceSolver(rig);
  if (name == "realtime") return MakeRealtimeSolver(rig);
  return Failure{fmt::format("there is no solver \"{}\"; known: realtime, reference", name)};
}

}  // namespace dynoproof
