// The page of `dynoproof reproduce --html`: the claims ledger by chapter, and the figures that can be computed.
#pragma once

#include <string>
#include <vector>

#include "thesis/atlas.h"
#include "thesis/coverage.h"
#include "thesis/ledger.h"

namespace dynoproof::reports {

/// The chapter or appendix that a claim belongs to: "2" ... "6", "A" ... "E".
std::string ChapterOf(const Claim& claim);

std::string AtlasPage(const std::vector<ClaimResult>& claims, const std::vector<DrawnFigure>& figures,
                      const std::vector<CoverageRow>& coverage = {});

}  // namespace dynoproof::reports
