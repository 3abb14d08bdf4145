// What the checks of a scenario find out, as figures for claims.
#pragma once

#include "thesis/studies.h"

namespace dynoproof {

/// The figures of the checks of one kind of a scenario, from its run with its own solver, the settings "key=value" laid
/// over it. Kept for as long as the program runs, since several claims read figures of one run.
Result<Figures> FiguresOf(const Registry& registry, const std::string& scenario, const std::string& kind,
                          const std::vector<std::string>& settings = {});

/// `figure` of the checks of `kind` of `scenario` with `set`; over `over`, another figure, or over the same figure of
/// `over_scenario`.
Result<Figure> ScenarioFigure(const Registry& registry, const Value& parameters);

}  // namespace dynoproof
