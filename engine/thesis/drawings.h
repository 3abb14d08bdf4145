// Figures of the thesis that show a formula or a model rather than a run: the atlas draws them from here.
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
