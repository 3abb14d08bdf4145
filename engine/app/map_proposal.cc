#include "app/map_proposal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>

#include "base/text.h"
#include "base/units.h"
#include "experiment/drive_by_record.h"
#include "scenario/load.h"
#include "trace/time_base.h"

namespace dynoproof::app {
namespace {

bool IsQuantity(const std::string& unit, const std::string& like) {
  const std::optional<Unit> a = ParseUnit(unit), b = ParseUnit(like);
  return a && b && SameQuantity(*a, *b);
}

/// KEY = "TEXT", whatever stands in the text: names come from strangers.
std::string Line(const char* key, const std::string& text) { return ToToml(Value{{key, Value(text)}}); }

std::string Plain(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

class Proposal {
 public:
  Proposal(const trace::Record& record, const Plan& plan) : record_(record), plan_(plan) {
    for (std::size_t i = 0; i < record.columns.size(); ++i) {
      if (MayBeTime(i)) times_.push_back(i);
    }
  }

  std::string Text(const std::vector<SignalName>& inputs, const std::vector<SignalName>& outputs) {
    std::string text =
        fmt::format("# Proposed from the columns of {}; what is unsure says so. More: dynoproof describe map\n",
                    std::filesystem::path(record_.source).filename().string());
    text += Clock();
    for (const SignalName& input : inputs) text += Channel("input", input);
    for (const SignalName& output : outputs) text += Channel("output", output);
    std::vector<std::string> left;
    for (std::size_t i = 0; i < record_.columns.size(); ++i) {
      const bool taken = std::find(taken_.begin(), taken_.end(), i) != taken_.end();
      if (!taken && std::find(times_.begin(), times_.end(), i) == times_.end()) left.push_back(record_.columns[i].name);
    }
    if (!left.empty()) text += fmt::format("\n# not used: {}\n", fmt::join(left, ", "));
    return text;
  }

 private:
  bool MayBeTime(std::size_t i) const {
    const trace::Column& column = record_.columns[i];
    if (record_.time == i) return true;
    const bool rises = column.values.size() > 2 && trace::FirstFaultOf(column.values) == column.values.size() &&
                       column.values.back() > column.values.front();
    return rises && (IsQuantity(column.unit, "s") || Plain(column.name).starts_with("t"));
  }

  std::string UnitFor(const trace::Column& time) const {
    const double span = time.values.back() - time.values.front();
    return TimeUnitFor(span, span / static_cast<double>(std::max<std::size_t>(2, time.values.size()) - 1), plan_, "s");
  }

  std::string Clock() const {
    if (record_.time) {
      const trace::Column& time = record_.columns[*record_.time];
      if (!time.unit.empty()) return "";
      const std::string unit = UnitFor(time);
      return fmt::format("# unsure: no unit stands at {}; {} is what fits the scenario\n", time.name, unit) +
             Line("time", time.name) + Line("time_unit", unit);
    }
    if (times_.empty()) return "# unsure: no column rises as time does; samples per second:\nrate_hz = 1000\n";
    const trace::Column& time = record_.columns[times_.front()];
    std::string others;
    for (std::size_t k = 1; k < times_.size(); ++k)
      others += (k > 1 ? ", " : "; or: ") + record_.columns[times_[k]].name;
    return fmt::format("# unsure: it rises{}\n", others) + Line("time", time.name) +
           Line("time_unit", time.unit.empty() ? UnitFor(time) : time.unit);
  }

  std::string Channel(const char* section, const SignalName& signal) {
    std::vector<std::size_t> alike;
    std::optional<std::size_t> named;
    for (std::size_t i = 0; i < record_.columns.size(); ++i) {
      if (std::find(times_.begin(), times_.end(), i) != times_.end()) continue;
      if (std::find(taken_.begin(), taken_.end(), i) != taken_.end()) continue;
      if (Plain(record_.columns[i].name) == Plain(signal.name)) named = i;
      const bool counts = IsQuantity(signal.unit, "rad/s") && IsQuantity(record_.columns[i].unit, "1/min");
      if (IsQuantity(record_.columns[i].unit, signal.unit) || counts) alike.push_back(i);
    }
    std::string unsure;
    if (!named && !alike.empty()) {
      std::vector<std::string> names;
      for (const std::size_t i : alike) names.push_back(record_.columns[i].name);
      const std::optional<std::string> near = Closest(signal.name, names);
      named = near ? record_.Find(*near) : alike.front();
      std::erase(names, record_.columns[*named].name);
      unsure = fmt::format("# unsure: by its unit{}\n",
                           names.empty() ? "" : fmt::format("; others of its quantity: {}", fmt::join(names, ", ")));
    }
    if (!named)
      return fmt::format("\n# unsure: no column is like it ({})\n# [{}.{}]\n# column = \"\"\n", signal.unit, section,
                         signal.name);
    taken_.push_back(*named);
    const trace::Column& column = record_.columns[*named];
    std::string text = fmt::format("\n{}[{}.{}]\n", unsure, section, signal.name) + Line("column", column.name);
    if (column.unit.empty()) text += "# unsure: the file does not say the unit\n" + Line("unit", signal.unit);
    if (std::string_view(section) == "input")
      text +=
          "# between = \"held\"     # or linear, band_limited, band_limited_held: what it does between its samples; "
          "else the outputs decide\n";
    return text;
  }

  const trace::Record& record_;
  const Plan& plan_;
  std::vector<std::size_t> times_, taken_;
};

}  // namespace

std::string ProposeMap(const trace::Record& record, const std::vector<SignalName>& inputs,
                       const std::vector<SignalName>& outputs, const Plan& plan) {
  return Proposal(record, plan).Text(inputs, outputs);
}

}  // namespace dynoproof::app
