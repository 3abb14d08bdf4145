// The page of `dynoproof modes --html`: response, shapes, energies, poles and zeros.
#pragma once

#include <string>

#include "experiment/analysis.h"
#include "experiment/prepare.h"

namespace dynoproof::reports {

std::string ModesPage(const Prepared& prepared, const AnalysisSettings& settings, const LinearAnalysis& analysis);

}  // namespace dynoproof::reports
