#include "thesis/coupling.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/bad_input.h"
#include "base/units.h"
#include "linear/modes.h"
#include "trace/csv.h"

namespace dynoproof {

Result<mechanics::CouplingTable> ReadCouplingTable(const std::string& file) {
  const Result<trace::Record> record = trace::ReadCsv(file);
  if (!record.ok()) return record.failure();
  mechanics::CouplingTable table;
  struct Wanted {
    const char *name, *unit;
    std::vector<double>* values;
  };
  for (const auto& [name, unit, values] : {Wanted{"nu", "rad/s", &table.nu}, Wanted{"k", "N m/rad", &table.stiffness},
                                           Wanted{"c", "N m s/rad", &table.damping}}) {
    const std::optional<std::size_t> column = record->Find(name);
    if (!column) return BadInput(fmt::format("has no column \"{}\": a data sheet has nu, k and c", name), file);
    const trace::Column& found = record->columns[*column];
    const std::optional<Unit> written = ParseUnit(found.unit.empty() ? unit : found.unit), ours = ParseUnit(unit);
    const bool hertz = std::string_view(name) == "nu" && written && found.unit.ends_with("Hz");
    if (!written || !SameQuantity(*written, *ours)) {
      return BadInput(fmt::format("column \"{}\" is in \"{}\", which is no {}", name, found.unit, unit), file);
    }
    const double factor = written->factor * (hertz ? 2.0 * std::numbers::pi : 1.0);
    for (const double value : found.values) values->push_back(factor * value);
  }
  const std::string fault = FaultOf(table);
  return fault.empty() ? Result<mechanics::CouplingTable>(std::move(table)) : BadInput(fault, file);
}

Result<CouplingChoice> ChooseCouplingMode(const mechanics::Network& network, const std::string& shaft,
                                          double static_stiffness) {
  const int coupling = network.FindEdge(shaft);
  if (coupling < 0) return BadInput(fmt::format("the drive line has no shaft \"{}\"", shaft), "coupling");
  mechanics::Network bare = network;
  for (mechanics::Edge& edge : bare.edges) edge.damping = 0.0;
  bare.edges[coupling].stiffness = static_stiffness;
  const Result<mechanics::ModalAnalysis> modal = mechanics::Modes(bare);
  if (!modal.ok()) return modal.failure();
  CouplingChoice choice{static_stiffness, 0.0, {}};
  double largest = 0.0;
  for (const mechanics::Mode& mode : modal->modes) {
    if (mode.frequency_hz <= 0.0) continue;
    double sum = 0.0, own = 0.0;
    for (std::size_t e = 0; e < bare.edges.size(); ++e) {
      const mechanics::Edge& edge = bare.edges[e];
      if (edge.to == mechanics::kGround) continue;
      const double twist = std::abs(mode.shape[edge.from] - mode.shape[edge.to]);
      sum += twist;
      if (static_cast<int>(e) == coupling) own = twist;
    }
    const double nu = 2.0 * std::numbers::pi * mode.frequency_hz, share = own / sum;
    choice.modes.push_back({nu, share});
    if (share <= largest) continue;
    largest = share;
    choice.nu_0 = nu;
  }
  if (largest == 0.0) return BadInput(fmt::format("no mode twists \"{}\"", shaft), "coupling");
  return choice;
}

std::optional<mechanics::DynamicValues> SteadyValues(const Value& shaft, double nu) {
  const std::string name = shaft.TextOr("law", "spring_damper");
  const double k = shaft.NumberOr("stiffness_Nm_per_rad", 0.0);
  if (name == "kelvin_voigt" || name == "spring_damper") {
    return mechanics::DynamicValues{k, shaft.NumberOr("damping_Nms_per_rad", 0.0)};
  }
  if (name != "oil_coupling") return std::nullopt;
  return mechanics::OilCoupling{k, shaft.NumberOr("k_p_m3", 0.0), shaft.NumberOr("kappa_p_per_s", 0.0),
                                shaft.NumberOr("kappa_w_Pa_per_rad", 0.0)}
      .At(nu);
}

}  // namespace dynoproof
