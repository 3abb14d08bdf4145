// Any program as the subject of a campaign: numbers of the JSON object that it prints, alone or as its last line, are
// the figures.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "campaign/axes.h"
#include "campaign/figures.h"
#include "campaign/subject.h"

namespace dynoproof::campaign {

/// In the words of `command`, {KEY} is the value of an axis, {run} the number of the run, {seed} its seed and {folder}
/// a folder for its files below `folder`. Figures name what they take by `from`, a dotted path.
std::unique_ptr<Subject> MakeCommandSubject(std::vector<std::string> command,
                                            std::vector<std::pair<std::string, FigureSpec>> figures, const Value& root,
                                            const Axes& axes, const std::string& folder, Diagnostics& diagnostics);

}  // namespace dynoproof::campaign
