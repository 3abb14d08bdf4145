// The result of a campaign: one row a run, as HDF5 and CSV, and what the rows say together. The tables hold nothing
// that depends on where, when or by how many the runs were made: equal campaigns give equal bytes. Costs stand beside.
//
//   table.csv   run, [seed,] axes, figures, verdict, why; texts in quotes
//   table.h5    /axes/<key>, /figures/<name> (attribute unit), /run, /seed, /verdict (codes; attribute codes), each
//               float64 [runs]; texts of an axis as attribute labels, one a line; /why: a line "run: reason" for each
//               run that has one; /campaign: its TOML; /provenance
//   costs.csv   run, wall_s, cpu_s, peak_MB
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/campaign.h"
#include "campaign/rows.h"
#include "score/rate.h"

namespace dynoproof::campaign {

/// Writes table.csv, table.h5 and costs.csv into the folder.
Status WriteTables(const Campaign& campaign, const Rows& rows, const std::vector<Cost>& costs,
                   const std::string& folder);

}  // namespace dynoproof::campaign
