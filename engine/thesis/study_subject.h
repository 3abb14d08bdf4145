// A study of this folder as the subject of a campaign: a row from parameters, which a campaign's [parameters] give and
// its axes vary.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "campaign/axes.h"
#include "campaign/subject.h"
#include "model/params.h"

namespace dynoproof::campaign {

/// `Study` has `Parameters`, what a run takes; kContext, who speaks where they are wrong; Figures(); and
/// Fill(parameters, seed, row), which fills in figures and verdict, or says why not.
template <class Study>
class StudySubject : public Subject {
 public:
  StudySubject(Value parameters, const Axes& axes) : parameters_(std::move(parameters)), axes_(axes) {}

  const std::vector<FigureInfo>& figures() const override { return Study::Figures(); }

  Status Run(Range runs, bool, const std::function<void(Row)>& done) const override {
    for (std::int64_t run = runs.begin; run < runs.end; ++run) done(RowOf(run));
    return {};
  }

  std::string Command(std::int64_t) const override { return ""; }

  /// The parameters of a run; faults at the campaign's file.
  bool Read(std::int64_t run, typename Study::Parameters& parameters, Diagnostics& diagnostics) const {
    Value table = parameters_;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      Value value = axes_.At(i, run);
      value.set_where(parameters_.where());
      table[axes_.spec(i).key] = std::move(value);
    }
    return ReadParams(table, parameters, diagnostics, Study::kContext);
  }

 private:
  Row RowOf(std::int64_t run) const {
    Row row;
    row.run = run;
    row.verdict = score::Verdict::kBroken;
    row.figures.assign(figures().size(), std::numeric_limits<double>::quiet_NaN());
    typename Study::Parameters parameters;
    Diagnostics diagnostics;
    if (!Read(run, parameters, diagnostics)) {
      row.why = diagnostics.items().empty() ? "bad parameters" : diagnostics.items().front().message;
      return row;
    }
    Study::Fill(parameters, static_cast<std::uint64_t>(axes_.Seed(run)), row);
    return row;
  }

  Value parameters_;
  const Axes& axes_;
};

/// `parameters`: what is the same in all runs; the axes name the others. Null with the faults in the diagnostics.
template <class Study>
std::unique_ptr<Subject> MakeStudySubject(const std::vector<std::pair<std::string, Value>>& parameters,
                                          const Value& root, const Axes& axes, Diagnostics& diagnostics) {
  Value table;
  table.set_where(root.where());
  for (const auto& [key, value] : parameters) table[key] = value;
  auto subject = std::make_unique<StudySubject<Study>>(std::move(table), axes);
  const int before = diagnostics.error_count();
  typename Study::Parameters ignored;
  for (std::size_t i = 0; i < axes.size() && diagnostics.error_count() == before; ++i) {
    for (const std::int64_t run : axes.Extremes(i)) {
      if (!subject->Read(run, ignored, diagnostics)) break;
    }
  }
  if (diagnostics.error_count() == before) subject->Read(0, ignored, diagnostics);
  if (diagnostics.error_count() != before) return nullptr;
  return subject;
}

}  // namespace dynoproof::campaign
