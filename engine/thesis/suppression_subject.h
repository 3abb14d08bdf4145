// The robustness of the proposed resonance suppression as the subject of a campaign (suppression_case.h).
#pragma once

#include <cstdint>
#include <vector>

#include "campaign/subject.h"
#include "thesis/suppression_case.h"

namespace dynoproof::campaign {

struct SuppressionStudy {
  using Parameters = SuppressionParameters;
  static constexpr const char* kContext = "study suppression";
  static const std::vector<FigureInfo>& Figures();
  static void Fill(const Parameters& parameters, std::uint64_t seed, Row& row);
};

}  // namespace dynoproof::campaign
