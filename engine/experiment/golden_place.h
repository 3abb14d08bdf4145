// Where the golden data of a scenario lie.
#pragma once

#include <string>

#include "model/plan.h"

namespace dynoproof {

struct GoldenPlace {
  std::string trace, tolerances;  // the two files
  std::string bless;              // the command that writes them; it lacks only the reason
};

/// A scenario of the scenario folder: golden/<id>.h5 and .toml. Any other belongs to its user, and so do its golden
/// data: <name>.golden.h5 and .golden.toml beside it. `folder` (--golden) takes the place of either folder.
GoldenPlace GoldenPlaceOf(const Plan& plan, const std::string& folder = "");

}  // namespace dynoproof
