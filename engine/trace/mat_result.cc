#include "trace/mat_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "base/text_safety.h"

namespace dynoproof::trace::mat {
namespace {

const Matrix* Find(const std::vector<Matrix>& matrices, std::string_view name) {
  const auto found = std::ranges::find(matrices, name, &Matrix::name);
  return found == matrices.end() ? nullptr : &*found;
}

/// A matrix seen in the order "signal, sample", or "variable, letter", whichever way it lies in the file.
class View {
 public:
  View(const Matrix& matrix, bool transposed) : matrix_(matrix), transposed_(transposed) {}
  std::size_t items() const { return matrix_.extents[transposed_ ? 1 : 0]; }
  std::size_t length() const { return matrix_.extents[transposed_ ? 0 : 1]; }
  double At(std::size_t item, std::size_t i) const {
    const std::size_t rows = matrix_.extents[0];
    return matrix_.values[transposed_ ? item * rows + i : i * rows + item];
  }
  /// A text, without what fills it up.
  std::string Text(std::size_t item) const {
    std::string text;
    for (std::size_t i = 0; i < length(); ++i) {
      const double code = At(item, i);  // a text may be stored as any numbers
      text += code >= 0.0 && code < 256.0 ? static_cast<char>(static_cast<unsigned char>(code)) : '?';
    }
    text.erase(std::min(text.find('\0'), text.size()));
    text.erase(text.find_last_not_of(' ') + 1);
    return WithoutControls(ToUtf8(text));
  }

 private:
  const Matrix& matrix_;
  bool transposed_;
};

/// "Angular velocity [rad/s|rev/min]" -> "rad/s".
std::string UnitIn(const std::string& description) {
  const std::size_t open = description.rfind('[');
  if (open == std::string::npos || description.back() != ']') return "";
  std::string unit = description.substr(open + 1, description.size() - open - 2);
  unit.erase(std::min(unit.find_first_of("|:"), unit.size()));  // the unit to show, "[:#(type=Integer)]"
  return unit;
}

/// A whole number of at most `most`, or nothing.
std::optional<std::size_t> Whole(double value, std::size_t most) {
  if (!(value >= 0.0) || value > static_cast<double>(most) || value != std::floor(value)) return {};
  return static_cast<std::size_t>(value);
}

constexpr std::size_t kMostBytes = std::size_t{2} << 30;  // of all columns together

class Table {
 public:
  Table(const std::vector<Matrix>& matrices, Record& record) : matrices_(matrices), record_(record) {}

  std::string Add() {
    const View form(*Find(matrices_, "Aclass"), false);
    std::string order;
    for (std::size_t row = 0; row < form.items(); ++row) order = form.Text(row);  // in the last row
    if (order != "binTrans" && order != "binNormal")
      return fmt::format("its \"Aclass\" ends in \"{}\", neither binTrans nor binNormal", order);
    transposed_ = order == "binTrans";
    const Matrix* const name = Find(matrices_, "name");
    const Matrix* const info = Find(matrices_, "dataInfo");
    const Matrix* const description = Find(matrices_, "description");
    if (name == nullptr || !name->is_text) return "it has no text \"name\" of its variables";
    if (info == nullptr || !info->why_not.empty()) return "it has no matrix \"dataInfo\"";
    const View names(*name, transposed_), infos(*info, transposed_);
    if (infos.items() != names.items() || infos.length() != 4)
      return fmt::format("its \"dataInfo\" is {} for {} names", fmt::join(info->extents, " x "), names.items());
    const bool described =
        description != nullptr && description->is_text && View(*description, transposed_).items() == names.items();
    for (std::size_t i = 0; i < names.items(); ++i) {
      std::string unit = described ? UnitIn(View(*description, transposed_).Text(i)) : "";
      std::string fault = AddVariable(names.Text(i), std::move(unit), infos.At(i, 0), infos.At(i, 1));
      if (!fault.empty()) return fault;
    }
    return "";
  }

 private:
  std::string AddVariable(std::string name, std::string unit, double table, double place) {
    const std::optional<std::size_t> k = Whole(table, matrices_.size());
    if (!k) return fmt::format("its \"dataInfo\" says that \"{}\" is in data_{}", name, table);
    if (*k == 0) return "";  // the abscissa, which comes with each table
    const Matrix* const data = Find(matrices_, fmt::format("data_{}", *k));
    if (data == nullptr || !data->why_not.empty()) return fmt::format("it has no matrix \"data_{}\"", *k);
    const View signals(*data, !transposed_);
    const std::optional<std::size_t> signal = Whole(std::abs(place), signals.items());
    if (!signal || *signal == 0)
      return fmt::format("its \"dataInfo\" says that \"{}\" is signal {} of the {} in data_{}", name, place,
                         signals.items(), *k);
    if (*k == 1 || signals.length() < 3) {
      record_.left_out.emplace_back(std::move(name), "is a parameter or a constant of the simulation");
      return "";
    }
    const std::size_t bytes = signals.length() * sizeof(double);
    if ((record_.columns.size() + 2) * bytes > kMostBytes)
      return fmt::format("its variables have more than {} bytes together: store fewer of them", kMostBytes);
    const std::size_t time = TimeOf(*k, signals);
    if (name == record_.columns[time].name) return "";
    Column column{.name = std::move(name), .unit = std::move(unit), .time = time};
    for (std::size_t i = 0; i < signals.length(); ++i) {
      const double value = signals.At(*signal - 1, i);
      column.values.push_back(place < 0.0 ? -value : value);
    }
    record_.columns.push_back(std::move(column));
    return "";
  }

  /// The column of the time stamps of a table, which is its first signal.
  std::size_t TimeOf(std::size_t table, const View& signals) {
    const auto known = times_.find(table);
    if (known != times_.end()) return known->second;
    Column column{.name = times_.empty() ? "time" : fmt::format("time_{}", times_.size()), .unit = "s"};
    for (std::size_t i = 0; i < signals.length(); ++i) column.values.push_back(signals.At(0, i));
    record_.columns.push_back(std::move(column));
    return times_[table] = record_.columns.size() - 1;
  }

  const std::vector<Matrix>& matrices_;
  Record& record_;
  bool transposed_ = false;
  std::map<std::size_t, std::size_t> times_;  // by table
};

}  // namespace

bool IsResult(const std::vector<Matrix>& matrices) {
  const Matrix* const form = Find(matrices, "Aclass");
  return form != nullptr && form->is_text && form->extents[0] > 0 && View(*form, false).Text(0) == "Atrajectory";
}

std::string AddResult(const std::vector<Matrix>& matrices, Record& record) { return Table(matrices, record).Add(); }

}  // namespace dynoproof::trace::mat
