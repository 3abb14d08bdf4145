// The page of `dynoproof run --html`: overview with the worst first, then each scenario with pictures, score card,
// figures, settings and solver counters.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "experiment/run_scenario.h"

namespace dynoproof::reports {

class RunPage {
 public:
  /// `scenarios`: how many will come; they share the room for samples, so that the file stays below some 60 MB, or 120
  /// MB where many of them fail.
  explicit RunPage(std::size_t scenarios);

  /// Takes what there is to see of a run. May be called from several threads; the course is not needed afterwards.
  void Add(const Prepared& prepared, const Course& course, const ScenarioResult& result);

  /// The page over all results; those never added (broken runs) have their reason instead of pictures.
  std::string Finish(const std::vector<ScenarioResult>& results) const;

  /// What the page has of one scenario, where it was made in another process.
  struct Part {
    std::string source, pictures, settings, counters;
  };
  std::optional<Part> PartOf(const std::string& id) const;
  void Put(const std::string& id, Part part);

 private:
  const std::size_t scenarios_;
  std::mutex mutex_;
  std::size_t bytes_ = 0;              // of pictures so far
  std::map<std::string, Part> parts_;  // by id
};

}  // namespace dynoproof::reports
