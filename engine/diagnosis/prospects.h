// What each effect would remove of what a model gets wrong, by a few runs of each beside the record and without a fit: in
// seconds, where a diagnosis takes minutes. It ranks and proves nothing: a candidate may remove much and not be the cause.
#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/status.h"
#include "diagnosis/diagnose.h"
#include "experiment/records.h"
#include "model/registry.h"

namespace dynoproof::diagnosis {

/// One effect at one place.
struct Prospect {
  std::string name, at;
  double removes = 0.0;         // share of the squared error, in a run in which nominal values follow
  std::string parameter, unit;  // the one that its size is told by; empty: it has none
  double strength = 0.0;        // at which it removes that
  double smallest = std::numeric_limits<double>::
      quiet_NaN();  // that would be told from noise and nominal values, about, if all else were right; not finite: not told
  std::vector<std::string> alike;  // "effect@place" of those that these records cannot tell from it
};

/// Two of them at once.
struct ProspectPair {
  std::string first, second;  // "effect@place"
  double removes = 0.0;
};

struct Prospects {
  std::string level;                // "memory 0.025 s", "free run": where they are compared
  bool excess = false;              // whether the model leaves more than noise there
  std::vector<Prospect> all;        // those that remove most first; without an excess by name
  std::vector<ProspectPair> pairs;  // the three best, where two remove clearly more than one
  std::vector<NotTestable> silent;  // that move no output so that it shows beside the noise
  std::int64_t simulations = 0;

  std::string ToTable() const;
};

/// At the most corrected level at which the plan leaves more than noise with its nominal values fitted within their priors; in
/// the free run where there is none. `records`: of which the first 12 000 periods are looked at. Fails where the plan cannot be
/// run beside them.
Result<Prospects> ProspectsOf(const Plan& plan, const std::vector<MappedRecord>& records, const Registry& registry);

/// "candidates", "candidates_level", "pairs" and "not_testable", to be added to a document.
void AddTo(nlohmann::json& document, const Prospects& prospects);

}  // namespace dynoproof::diagnosis
