// The robustness of the proposed resonance suppression as the subject of a campaign (suppression_case.h).
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "campaign/axes.h"
#include "campaign/subject.h"

namespace dynoproof::campaign {

/// `parameters`: what is the same in all runs; the axes name the others.
std::unique_ptr<Subject> MakeSuppressionSubject(const std::vector<std::pair<std::string, Value>>& parameters,
                                                const Value& root, const Axes& axes, Diagnostics& diagnostics);

}  // namespace dynoproof::campaign
