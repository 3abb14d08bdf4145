#include "reports/modes_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "experiment/pictures_frequency.h"
#include "reports/html.h"

namespace dynoproof::reports {
namespace {

const char* HeatOf(double share) {
  return share >= 0.5    ? "heat h4"
         : share >= 0.2  ? "heat h3"
         : share >= 0.05 ? "heat h2"
         : share >= 0.01 ? "heat h1"
                         : "";
}

/// Modes over parts: who moves and who is twisted.
std::string Energies(const LinearAnalysis& analysis, double to_Hz) {
  std::vector<Cell> head = {{"frequency, Hz", "number"}, {"damping", "number"}};
  std::vector<std::string> parts;
  std::string rows;
  for (const mechanics::Mode& mode : analysis.modal.modes) {
    if (mode.frequency_hz > to_Hz) break;
    const auto shares = EnergyByElement(*analysis.network, mode);
    if (parts.empty()) {
      for (const auto& [part, share] : shares) {
        parts.push_back(part);
        head.push_back({Escape(part), "turned"});
      }
    }
    std::vector<Cell> cells = {{fmt::format("{:.3f}", mode.frequency_hz), "number"},
                               {fmt::format("{:.5f}", mode.damping_ratio), "number"}};
    for (const auto& [part, share] : shares)
      cells.push_back({share >= 0.01 ? fmt::format("{:.0f} %", 100.0 * share) : "", HeatOf(share)});
    rows += Row(cells);
  }
  return Table(head, rows);
}

/// The practical resonances in a sentence's form: "97.4 Hz (gain 12)", with commas between them.
std::string ResonancesText(const LinearAnalysis& analysis) {
  std::string text;
  for (const mechanics::Resonance& one : analysis.resonances) {
    text += fmt::format("{}{:.4g} Hz ({})", text.empty() ? "" : ", ", one.frequency_hz,
                        one.unbounded ? "undamped" : fmt::format("gain {:.3g}", one.gain));
  }
  return text.empty() ? "none" : text;
}

}  // namespace

std::string ModesPage(const Prepared& prepared, const AnalysisSettings& settings, const LinearAnalysis& analysis) {
  const auto swings = std::ranges::count_if(analysis.modal.modes, [&](const mechanics::Mode& mode) {
    return mode.frequency_hz > 0.0 && mode.frequency_hz <= settings.to_Hz;
  });
  std::string lead = Escape(fmt::format("Practical resonances from {} to {}, {:g} to {:g} Hz: {}", settings.input,
                                        settings.output, settings.from_Hz, settings.to_Hz, ResonancesText(analysis)));
  for (const std::string& note : analysis.notes) lead += "<br>Note: " + Escape(note);
  const std::string body =
      "<section id=\"pictures\"><h2>Response, shapes, poles</h2>\n" +
      Figures("modes", PicturesOfModes(prepared, settings, analysis), 40'000) +
      "</section>\n<section id=\"energies\"><h2>Energy of each mode by part</h2>\n"
      "<p class=\"note\">Half of it is kinetic and in the masses, half is strain and in the shafts.</p>\n" +
      Energies(analysis, settings.to_Hz) + "</section>\n";
  return Page(fmt::format("modes of {}: {} below {:g} Hz", prepared.plan.id, swings, settings.to_Hz), lead, BuildLine(),
              body);
}

}  // namespace dynoproof::reports
