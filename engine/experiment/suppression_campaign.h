// The robustness of the proposed suppression (thesis Sec. 5.5, 5.6), which nobody has published: many seeded runs of
// varied loops under loads from quiet to nasty, each placement judged against the eigenvalues of the loop at that
// moment.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/status.h"
#include "experiment/suppression_loop.h"

namespace dynoproof {

enum class LoadKind { kQuiet, kPrinted, kGearChanges, kEngineSweep, kBroadband, kNearTone, kFarTone };
inline constexpr std::array<const char*, 7> kLoadNames = {"quiet",     "printed",   "gear_changes", "engine_sweep",
                                                          "broadband", "near_tone", "far_tone"};

/// One run, drawn from (seed, index).
struct CampaignCase {
  SuppressionPlant plant;
  double k_V = 0.0, noise_Nm = 0.0;
  int delay_samples = 0;
  LoadKind load = LoadKind::kQuiet;
  double load_amplitude_Nm = 0.0, load_Hz = 0.0;
  std::vector<double> unstable_Hz;  // modes of the loop with its idle filters that grow
};

struct CampaignRun {
  CampaignCase drawn;
  struct Placement {
    double time_s, f_Hz;
    bool right;  // within 20 Hz of a mode that grew in the loop just before
  };
  std::vector<Placement> placements;
  int found = 0;               // of drawn.unstable_Hz: a placement within 20 Hz
  std::vector<double> times;   // to the first such placement of each
  bool stable_at_end = false;  // the loop with its filters
  double peak_Nm = 0.0;        // largest shaft torque
};

struct CampaignOptions {
  int runs = 1000;
  std::uint64_t seed = 1;
  double duration_s = 2.5;
  int jobs = 1;
  double probe_gamma = 0.0;  // Appendix E
};

/// A rate with its 95 % Wilson interval.
struct Rate {
  int hits = 0, of = 0;
  double value() const { return of > 0 ? static_cast<double>(hits) / of : 0.0; }
  double lower() const { return Wilson(-1.0); }
  double upper() const { return Wilson(1.0); }

 private:
  double Wilson(double sign) const;
};

struct CampaignSummary {
  std::string load;  // or "all"
  int runs = 0, placements = 0;
  Rate found;             // of the unstable modes at the start
  Rate false_placements;  // of all placements
  Rate runs_with_false, unstable_at_end;
  double median_time_s = 0.0, p90_time_s = 0.0;  // to find
};

CampaignCase DrawCase(std::uint64_t seed, int index);
Result<CampaignRun> RunCase(const CampaignCase& drawn, std::uint64_t seed, int index, const CampaignOptions& options);
/// All runs, in the order of their index whatever the number of jobs.
Result<std::vector<CampaignRun>> RunCampaign(const CampaignOptions& options);
/// One line a kind of load, then "all".
std::vector<CampaignSummary> Summarise(const std::vector<CampaignRun>& runs);

/// The smallest steady tone on the load that draws a filter to itself in a loop that is stable (setup 1, k_V), by
/// frequency; and the tone of at most `most_Nm` that, arriving after both filters are rightly placed (k_V = 9.7), does
/// the worst: found by seeded search.
struct SmallestTone {
  double frequency_Hz, amplitude_Nm;
};
Result<SmallestTone> SmallestMisleadingTone(double k_V, double from_Hz, double to_Hz, double step_Hz);
struct WorstLoad {
  double frequency_Hz = 0.0, amplitude_Nm = 0.0, peak_Nm = 0.0;
  int placements_after_load = 0;
  bool unstable_at_end = false;
  int tried = 0;
};
Result<WorstLoad> SearchWorstLoad(double most_Nm, int tries, std::uint64_t seed);

}  // namespace dynoproof
