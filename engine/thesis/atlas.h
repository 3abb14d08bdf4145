// The atlas: the data figures of the thesis that can be computed here, golden/figures.toml, and their pictures.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "experiment/pictures.h"

namespace dynoproof {

/// One figure of the thesis as the file has it.
struct AtlasFigure {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::string number, title, shows, missing;
  std::vector<std::string> scenarios, labels, pictures, curves, drawings;
  bool overlay = false;
  double from = kNone, to = kNone;
  SourceSpan where = {};
  void Visit(auto& v) {
    v.Required("number", number, Any(), "number in the thesis, without \"Fig.\"");
    v.Required("title", title, Any(), "what it shows, in our words");
    v.Optional("shows", shows, Any(), "what the thesis shows with it, and whether ours does");
    v.Optional("scenarios", scenarios, Any(), "ids of the scenarios that compute it");
    v.Optional("labels", labels, Any(), "what each scenario is called in the figure; its id when left out");
    v.Optional("pictures", pictures, Any(), "keys of the pictures of a run");
    v.Optional("curves", curves, Any(), "labels of the curves that are kept, and shown at first; all when left out");
    v.Optional("from", from, Any("1"), "abscissa that is shown at first, from here");
    v.Optional("to", to, Any("1"), "to here");
    v.Optional("drawings", drawings, Any(), "names of drawings: what is shown is no run");
    v.Optional("overlay", overlay, Any(), "all scenarios in one picture");
    v.Optional("missing", missing, Any(), "what of the printed figure cannot be compared, and why");
  }
};

/// All figures of the file; faults (a number twice, a scenario that does not exist) become diagnostics.
std::vector<AtlasFigure> ReadFigures(const std::string& file, Diagnostics& diagnostics);

/// What a place of the ledger names of a kind, "Fig" or "Table", in order: "Figs. 5.21-5.23, Table A.7" names the figures
/// 5.21, 5.22 and 5.23 and the table A.7. Sections, equations and panels, "2.11(b)", are left out.
std::vector<std::string> NumbersIn(const std::string& place, const std::string& kind);
/// Whether such a place names the figure.
bool Names(const std::string& place, const std::string& number);

/// A figure with its pictures, scenario by scenario for each key, or one for each key with all scenarios in it, then its
/// drawings. `fault` is set where a scenario cannot be prepared or run, or does not have a picture or a curve.
struct DrawnFigure {
  AtlasFigure figure;
  std::vector<Picture> pictures = {};
  std::string fault = {};
};
/// Runs every scenario that the figures need once, without its checks. `progress` hears the scenario and the fraction
/// done.
std::vector<DrawnFigure> Draw(const Registry& registry, const std::vector<AtlasFigure>& figures,
                              const std::function<void(const std::string&, double)>& progress = {});

}  // namespace dynoproof
