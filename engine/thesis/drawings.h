// Figures of the thesis that no scenario shows: formulas, models, and runs made for the figure. The atlas draws them from
// here.
#pragma once

#include <map>
#include <string>

#include "experiment/pictures.h"
#include "model/registry.h"

namespace dynoproof {

/// One picture. Fails where its scenario cannot be prepared or an equation has no root.
using Drawing = Result<Picture> (*)(const Registry& registry);
using DrawingTable = std::map<std::string, Drawing, std::less<>>;

/// All drawings by name.
const DrawingTable& Drawings();

}  // namespace dynoproof
