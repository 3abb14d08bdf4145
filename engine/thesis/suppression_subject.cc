#include "thesis/suppression_subject.h"

#include <algorithm>
#include <limits>

#include "thesis/suppression_case.h"

namespace dynoproof::campaign {
namespace {

class SuppressionSubject : public Subject {
 public:
  SuppressionSubject(Value parameters, const Axes& axes) : parameters_(std::move(parameters)), axes_(axes) {}

  const std::vector<FigureInfo>& figures() const override {
    static const std::vector<FigureInfo> figures = {
        {"unstable_modes", "1"}, {"found", "1"},           {"placements", "1"},    {"false_placements", "1"},
        {"with_false", "1"},     {"unstable_at_end", "1"}, {"first_found_s", "s"}, {"peak", "N m"}};
    return figures;
  }

  Status Run(Range runs, bool, const std::function<void(Row)>& done) const override {
    for (std::int64_t run = runs.begin; run < runs.end; ++run) done(RowOf(run));
    return {};
  }

  std::string Command(std::int64_t) const override { return ""; }

  /// The parameters of a run; faults at the campaign's file.
  bool Read(std::int64_t run, SuppressionParameters& parameters, Diagnostics& diagnostics) const {
    Value table = parameters_;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      Value value = axes_.At(i, run);
      value.set_where(parameters_.where());
      table[axes_.spec(i).key] = std::move(value);
    }
    return ReadParams(table, parameters, diagnostics, "study suppression");
  }

 private:
  Row RowOf(std::int64_t run) const {
    Row row;
    row.run = run;
    row.verdict = score::Verdict::kBroken;
    row.figures.assign(figures().size(), std::numeric_limits<double>::quiet_NaN());
    SuppressionParameters parameters;
    Diagnostics diagnostics;
    if (!Read(run, parameters, diagnostics)) {
      row.why = diagnostics.items().empty() ? "bad parameters" : diagnostics.items().front().message;
      return row;
    }
    const Result<SuppressionRun> result = RunCase(parameters, static_cast<std::uint64_t>(axes_.Seed(run)));
    if (!result.ok()) {
      row.why = result.failure().ToString();
      return row;
    }
    const auto wrong = static_cast<double>(
        std::ranges::count_if(result->placements, [](const auto& placement) { return !placement.right; }));
    const auto unstable = static_cast<double>(result->unstable_Hz.size());
    row.figures = {unstable,
                   static_cast<double>(result->found),
                   static_cast<double>(result->placements.size()),
                   wrong,
                   wrong > 0.0 ? 1.0 : 0.0,
                   result->stable_at_end ? 0.0 : 1.0,
                   result->times.empty() ? std::numeric_limits<double>::quiet_NaN() : result->times.front(),
                   result->peak_Nm};
    row.verdict = result->stable_at_end && wrong == 0.0 ? score::Verdict::kPass : score::Verdict::kFail;
    if (!result->stable_at_end) row.why = "the loop is unstable at the end";
    if (wrong > 0.0) row.why += fmt::format("{}{} false placements", row.why.empty() ? "" : ", ", wrong);
    return row;
  }

  Value parameters_;
  const Axes& axes_;
};

}  // namespace

std::unique_ptr<Subject> MakeSuppressionSubject(const std::vector<std::pair<std::string, Value>>& parameters,
                                                const Value& root, const Axes& axes, Diagnostics& diagnostics) {
  Value table;
  table.set_where(root.where());
  for (const auto& [key, value] : parameters) table[key] = value;
  auto subject = std::make_unique<SuppressionSubject>(std::move(table), axes);
  const int before = diagnostics.error_count();
  for (std::size_t i = 0; i < axes.size() && diagnostics.error_count() == before; ++i) {
    for (const std::int64_t run : axes.Extremes(i)) {
      SuppressionParameters ignored;
      if (!subject->Read(run, ignored, diagnostics)) break;
    }
  }
  SuppressionParameters ignored;
  if (diagnostics.error_count() == before) subject->Read(0, ignored, diagnostics);
  return diagnostics.error_count() == before ? std::move(subject) : nullptr;
}

}  // namespace dynoproof::campaign
