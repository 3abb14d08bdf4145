// What of chapter 5 comes out with the induction machine at a bandwidth of its current control, as the subject of a
// campaign. Linear: eigenvalues of MachineLoop, filters as FindSteadiestFilters finds them, two at most as in Sec. 5.6.
#pragma once

#include <cstdint>
#include <vector>

#include "campaign/subject.h"
#include "model/params.h"

namespace dynoproof::campaign {

struct MachineStudy {
  struct Parameters {
    double current_bandwidth_Hz = 150.0, radius = 0.995;
    int delay_samples = 0;
    void Visit(auto& v) {
      v.Optional("current_bandwidth_Hz", current_bandwidth_Hz, Between(1.0, 2000.0), "of the current controllers");
      v.Optional("delay_samples", delay_samples, Between(0, 100), "between the core and the current control");
      v.Optional("radius", radius, Between(0.5, 0.99999, "1"), "pole radius r of the filters");
    }
  };
  static constexpr const char* kContext = "study machine";
  /// Growth rates of the loop's modes [1/s]: of setup 1 at k_V = 9.7 how many grow, the rates of the rotor's first and
  /// second resonance and the largest with two filters; of Experiment I at k_V = 1, at 4.5 and with two filters; of
  /// Experiment II at 4.3, and with two filters; of Experiment III at 2.1, and with a filter.
  static const std::vector<FigureInfo>& Figures();
  /// Passes where all that the chapter says of these comes out.
  static void Fill(const Parameters& parameters, std::uint64_t seed, Row& row);
};

}  // namespace dynoproof::campaign
