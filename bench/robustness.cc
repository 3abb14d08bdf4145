// The robustness campaign of the adaptive suppression. robustness [--runs N] [--seed N] [--jobs N] [--probe GAMMA]
// [--json FILE] [--worst]: a table on stdout; with --worst also the loads that mislead the algorithm. The same seed
// gives the same table, whatever the number of jobs.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "experiment/suppression_campaign.h"

int main(int argc, char** argv) {
  using namespace dynoproof;
  CampaignOptions options;
  std::string json;
  bool worst = false;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i], value = i + 1 < argc ? argv[i + 1] : "";
    if (key == "--worst") {
      worst = true;
      continue;
    }
    if (value.empty()) {
      fmt::print(stderr, "{} needs a value\n", key);
      return 2;
    }
    ++i;
    if (key == "--runs") {
      options.runs = std::atoi(value.c_str());
    } else if (key == "--seed") {
      options.seed = static_cast<std::uint64_t>(std::atoll(value.c_str()));
    } else if (key == "--jobs") {
      options.jobs = std::atoi(value.c_str());
    } else if (key == "--probe") {
      options.probe_gamma = std::atof(value.c_str());
    } else if (key == "--json") {
      json = value;
    } else {
      fmt::print(stderr, "unknown option {}\n", key);
      return 2;
    }
  }
  const auto runs = RunCampaign(options);
  if (!runs.ok()) {
    fmt::print(stderr, "{}\n", runs.failure().ToString());
    return 3;
  }
  fmt::print("{:<14}{:>6}  {:<27}{:<27}{:<27}{:>8}{:>8}\n", "load", "runs", "resonances found",
             "placements that are false", "loop unstable at the end", "median", "90 %");
  std::string document = fmt::format("{{\"seed\": {}, \"runs\": {}, \"probe_gamma\": {}, \"loads\": [", options.seed,
                                     options.runs, options.probe_gamma);
  const auto text = [](const Rate& rate) {
    return fmt::format("{:.1f} % [{:.1f}, {:.1f}]", 100 * rate.value(), 100 * rate.lower(), 100 * rate.upper());
  };
  const auto record = [](const char* name, const Rate& rate) {
    return fmt::format("\"{}\": {{\"hits\": {}, \"of\": {}, \"rate\": {:.6f}, \"ci95\": [{:.6f}, {:.6f}]}}", name,
                       rate.hits, rate.of, rate.value(), rate.lower(), rate.upper());
  };
  bool first = true;
  for (const CampaignSummary& line : Summarise(*runs)) {
    fmt::print("{:<14}{:>6}  {:<27}{:<27}{:<27}{:>6.2f} s{:>6.2f} s\n", line.load, line.runs, text(line.found),
               text(line.false_placements), text(line.unstable_at_end), line.median_time_s, line.p90_time_s);
    document += fmt::format(
        "{}{{\"load\": \"{}\", \"runs\": {}, {}, {}, {}, {}, \"median_time_s\": {:.4f}, \"p90_time_s\": {:.4f}}}",
        first ? "" : ", ", line.load, line.runs, record("found", line.found),
        record("false_placements", line.false_placements), record("runs_with_false", line.runs_with_false),
        record("unstable_at_end", line.unstable_at_end), line.median_time_s, line.p90_time_s);
    first = false;
  }
  document += "]";
  if (worst) {
    const auto smallest = SmallestMisleadingTone(2.1, 170.0, 1780.0, 5.0);
    const auto search = SearchWorstLoad(500.0, 120, options.seed);
    if (!smallest.ok() || !search.ok()) return 3;
    fmt::print("stable loop (k_V = 2.1): a steady tone of {:.2f} N m at {:.0f} Hz is enough to draw a filter\n",
               smallest->amplitude_Nm, smallest->frequency_Hz);
    fmt::print(
        "after both right placements (k_V = 9.7), {} tones of at most 500 N m tried: the worst is {:.0f} N m at {:.1f} "
        "Hz: "
        "{} further placements, loop {} at the end, peak {:.0f} N m\n",
        search->tried, search->amplitude_Nm, search->frequency_Hz, search->placements_after_load,
        search->unstable_at_end ? "unstable" : "stable", search->peak_Nm);
    document += fmt::format(
        ", \"smallest_tone\": {{\"Hz\": {}, \"Nm\": {}}}, \"worst_load\": {{\"Hz\": {}, \"Nm\": {}, \"placements\": "
        "{}, "
        "\"unstable_at_end\": {}, \"peak_Nm\": {}}}",
        smallest->frequency_Hz, smallest->amplitude_Nm, search->frequency_Hz, search->amplitude_Nm,
        search->placements_after_load, search->unstable_at_end, search->peak_Nm);
  }
  document += "}\n";
  if (!json.empty()) std::ofstream(json) << document;
  return 0;
}
