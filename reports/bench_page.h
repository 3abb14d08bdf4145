// The page of `dynoproof bench --html`: each scenario's verdict, its limits, and how many periods took longer than a time.
#pragma once

#include <string>
#include <vector>

#include "experiment/budget.h"

namespace dynoproof::reports {

struct Timed {
  std::string id;
  double period_us = 0.0;
  Timing timing;
  Budget budget;                     // its limits are drawn
  std::vector<score::Check> checks;  // by JudgeBudget(); none: nothing was compared
};

std::string BenchPage(const std::vector<Timed>& timed);

}  // namespace dynoproof::reports
