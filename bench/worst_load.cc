// The loads that mislead the adaptive suppression most: worst_load [--seed N] [--json FILE]. Rates over many varied
// loops come from `dynoproof sweep bench/campaigns/suppression.toml`.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "thesis/suppression_case.h"

int main(int argc, char** argv) {
  using namespace dynoproof;
  std::uint64_t seed = 1;
  std::string json;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i];
    if (key == "--seed") seed = std::strtoull(argv[i + 1], nullptr, 10);
    if (key == "--json") json = argv[i + 1];
  }
  const auto smallest = SmallestMisleadingTone(2.1, 170.0, 1780.0, 5.0);
  const auto search = SearchWorstLoad(500.0, 120, seed);
  if (!smallest.ok() || !search.ok()) return 3;
  fmt::print("stable loop (k_V = 2.1): a steady tone of {:.2f} N m at {:.0f} Hz is enough to draw a filter\n",
             smallest->amplitude_Nm, smallest->frequency_Hz);
  fmt::print(
      "after both right placements (k_V = 9.7), {} tones of at most 500 N m tried: the worst is {:.0f} N m at {:.1f} "
      "Hz: "
      "{} further placements, loop {} at the end, peak {:.0f} N m\n",
      search->tried, search->amplitude_Nm, search->frequency_Hz, search->placements_after_load,
      search->unstable_at_end ? "unstable" : "stable", search->peak_Nm);
  if (json.empty()) return 0;
  std::ofstream(json) << fmt::format(
      "{{\"seed\": {}, \"smallest_tone\": {{\"Hz\": {}, \"Nm\": {}}}, \"worst_load\": {{\"Hz\": {}, \"Nm\": {}, "
      "\"placements\": {}, \"unstable_at_end\": {}, \"peak_Nm\": {}}}}}\n",
      seed, smallest->frequency_Hz, smallest->amplitude_Nm, search->frequency_Hz, search->amplitude_Nm,
      search->placements_after_load, search->unstable_at_end, search->peak_Nm);
  return 0;
}
