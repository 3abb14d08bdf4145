#include "campaign/table.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "base/atomic_file.h"
#include "experiment/build_info.h"
#include "trace/hdf5.h"

namespace dynoproof::campaign {
namespace {

namespace hdf5 = trace::hdf5;

std::string Quoted(const std::string& text) {
  std::string out = "\"";
  // A spreadsheet takes such a cell for a formula, quoted or not.
  if (text.find_first_of("=+-@\t") == 0) out += '\'';
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out + "\"";
}

std::string NumberText(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

std::string ToCsv(const Campaign& campaign, const std::vector<Row>& rows) {
  const Axes& axes = campaign.axes;
  std::string text = "run,seed";
  for (std::size_t i = 0; i < axes.size(); ++i) text += "," + Quoted(axes.spec(i).key);
  for (const FigureInfo& figure : campaign.subject->figures()) text += "," + Quoted(figure.name);
  text += ",verdict,why\n";
  for (const Row& row : rows) {
    text += fmt::format("{},{}", row.run, axes.Seed(row.run));
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const Value value = axes.At(i, row.run);
      text += "," + (value.is_string() ? Quoted(value.string()) : TextOf(value));
    }
    for (const double figure : row.figures) text += "," + NumberText(figure);
    text += fmt::format(",{},{}\n", score::ToString(row.verdict), row.why.empty() ? "" : Quoted(row.why));
  }
  return text;
}

Status WriteColumn(hid_t group, const std::string& name, const std::vector<double>& values, const std::string& unit,
                   const std::vector<std::string>& labels = {}) {
  // A dotted key is one name; a slash would be a group.
  std::string safe = name;
  std::replace(safe.begin(), safe.end(), '/', '_');
  const Result<hdf5::Handle> set = hdf5::WriteDoubles(group, safe, values, {});
  if (!set.ok()) return set.failure();
  if (!unit.empty()) {
    if (Status failed = hdf5::WriteAttribute(set->id(), "unit", unit)) return failed;
  }
  if (labels.empty()) return {};
  return hdf5::WriteAttribute(set->id(), "labels", fmt::format("{}", fmt::join(labels, "\n")));
}

Status FillFile(hid_t file, const Campaign& campaign, const Rows& all) {
  const std::vector<Row>& rows = all.rows;
  std::vector<double> column(rows.size());
  const auto fill = [&](auto of) {
    for (std::size_t i = 0; i < rows.size(); ++i) column[i] = of(rows[i]);
  };
  fill([](const Row& row) { return static_cast<double>(row.run); });
  if (Status s = WriteColumn(file, "run", column, "1")) return s;
  fill([&](const Row& row) { return static_cast<double>(campaign.axes.Seed(row.run)); });
  if (Status s = WriteColumn(file, "seed", column, "1")) return s;
  fill([](const Row& row) { return static_cast<double>(row.verdict); });
  if (Status s = WriteColumn(file, "verdict", column, "1", {"pass", "fail", "broken", "inconclusive"})) return s;
  const Result<hdf5::Handle> axes = hdf5::CreateGroup(file, "axes");
  if (!axes.ok()) return axes.failure();
  for (std::size_t i = 0; i < campaign.axes.size(); ++i) {
    fill([&](const Row& row) { return campaign.axes.Number(i, row.run); });
    if (Status s = WriteColumn(axes->id(), campaign.axes.spec(i).key, column, "", campaign.axes.Labels(i))) return s;
  }
  const Result<hdf5::Handle> figures = hdf5::CreateGroup(file, "figures");
  if (!figures.ok()) return figures.failure();
  for (std::size_t i = 0; i < campaign.subject->figures().size(); ++i) {
    const FigureInfo& figure = campaign.subject->figures()[i];
    fill([i](const Row& row) { return row.figures[i]; });
    if (Status s = WriteColumn(figures->id(), figure.name, column, figure.unit)) return s;
  }
  std::string why;
  for (const Row& row : rows) {
    if (!row.why.empty()) why += fmt::format("{}: {}\n", row.run, row.why);
  }
  if (Status s = hdf5::WriteText(file, "why", why)) return s;
  if (Status s = hdf5::WriteText(file, "campaign", campaign.text)) return s;
  const Result<hdf5::Handle> provenance = hdf5::CreateGroup(file, "provenance");
  if (!provenance.ok()) return provenance.failure();
  for (const auto& [name, text] : {std::pair<std::string, std::string>("version", build_info::kVersion),
                                   {"commit", build_info::Commit()},
                                   {"compiler", build_info::kCompiler},
                                   {"cpu", all.cpu},
                                   {"fingerprint", campaign.fingerprint}}) {
    if (Status s = hdf5::WriteAttribute(provenance->id(), name, text)) return s;
  }
  return {};
}

Result<std::vector<std::byte>> ToImage(const Campaign& campaign, const Rows& rows) {
  const hdf5::Session session;
  const std::size_t columns = campaign.axes.size() + campaign.subject->figures().size() + 3;
  const auto file = hdf5::MemoryFile::Create(rows.rows.size() * columns * sizeof(double) + campaign.text.size());
  if (!file.ok()) return file.failure();
  if (Status failed = FillFile((*file)->id(), campaign, rows)) return *failed;
  return (*file)->Finish();
}

}  // namespace

Status WriteTables(const Campaign& campaign, const Rows& rows, const std::vector<Cost>& costs,
                   const std::string& folder) {
  const std::filesystem::path place(folder);
  std::string prices = "run,wall_s,cpu_s,peak_MB\n";
  for (std::size_t i = 0; i < costs.size(); ++i)
    prices += fmt::format("{},{:.6f},{:.6f},{:.1f}\n", i, costs[i].wall_s, costs[i].cpu_s, costs[i].peak_MB);
  if (Status failed = WriteFileAtomically(place / "costs.csv", prices)) return failed;
  if (Status failed = WriteFileAtomically(place / "table.csv", ToCsv(campaign, rows.rows))) return failed;
  const Result<std::vector<std::byte>> image = ToImage(campaign, rows);
  if (!image.ok()) return Failure{image.failure().message, (place / "table.h5").string()};
  return WriteFileAtomically(place / "table.h5", *image);
}

}  // namespace dynoproof::campaign
