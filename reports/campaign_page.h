// The page of `dynoproof sweep --html`: figures over each axis, quantiles, rates, the worst runs with the command that
// makes each again.
#pragma once

#include <string>

#include "campaign/summary.h"
#include "campaign/table.h"

namespace dynoproof::reports {

/// `again` is the command of the campaign; " --run N" is added.
std::string CampaignPage(const campaign::Campaign& campaign, const campaign::Rows& rows,
                         const campaign::Summary& summary, const std::string& again);

}  // namespace dynoproof::reports
