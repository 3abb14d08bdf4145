// The page of `dynoproof history show --html`: what changed, and every series over the nights.
#pragma once

#include <string>

#include "history/watch.h"

namespace dynoproof::reports {

std::string TrendPage(const history::History& history, const history::Watch& watch);

}  // namespace dynoproof::reports
