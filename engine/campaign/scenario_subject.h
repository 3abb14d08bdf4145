// A scenario as the subject of a campaign: its values set by the axes, simulated, its figures taken.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "campaign/axes.h"
#include "campaign/figures.h"
#include "campaign/subject.h"
#include "model/registry.h"

namespace dynoproof::campaign {

struct ScenarioOptions {
  std::string scenario;             // id, or a file as seen from `folder` or from here
  std::string folder;               // of the campaign file
  std::vector<std::string> set;     // as --set
  std::vector<std::string> checks;  // the kinds of its checks that are made
  std::vector<std::pair<std::string, FigureSpec>> figures;
  std::string keep_traces = "none";  // none, failing, all
  std::string traces;                // folder
  bool vary_seed = true;
  std::string batch = "auto";  // auto, always, never
  Value root;                  // of the campaign: where its keys are written
};

/// Reads the scenario, finds the axes' keys in it (and tells `axes` the nominal values), and tries the corners.
std::unique_ptr<Subject> MakeScenarioSubject(ScenarioOptions options, Axes& axes, const Registry& registry,
                                             std::string& text, Diagnostics& diagnostics);

}  // namespace dynoproof::campaign
