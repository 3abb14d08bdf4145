// The page of `dynoproof probe --html`: a map of changes over places, and every finding.
#pragma once

#include <string>

#include "probe/probe.h"

namespace dynoproof::reports {

std::string ProbePage(const std::string& id, const probe::Probed& probed);

}  // namespace dynoproof::reports
