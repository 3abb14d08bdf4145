// `dynoproof new map`: which column of a record may be which signal of a scenario, with what is unsure said.
#pragma once

#include <string>
#include <vector>

#include "experiment/records.h"
#include "model/plan.h"
#include "trace/record.h"

namespace dynoproof::app {

/// The text of a map file. A signal takes the column of its name, in whatever case; else the only column of its quantity,
/// or the one of those whose name is nearest, with the others in a comment; else it stands there commented out.
/// A clock without a unit gets the one that fits the plan's time scales.
std::string ProposeMap(const trace::Record& record, const std::vector<SignalName>& inputs,
                       const std::vector<SignalName>& outputs, const Plan& plan);

}  // namespace dynoproof::app
