// Brings a record onto the clock of a run: which period the run has, and what each input does in each of its periods.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/records.h"
#include "model/plan.h"
#include "model/registry.h"

namespace dynoproof {

/// Brings the record onto the clock of the plan's run, and adds to its notes what that changed; one that is on a clock
/// already stays as it is.
///
/// The run keeps its own period where all samples lie on its ticks. Else, if the inputs have a uniform base and the plan
/// no controllers (whose periods divide the run's), it gets a period that divides their step.
MappedRecord OntoClock(MappedRecord data, const Plan& plan);

/// Drives the inputs of the record by it, for as long as it lasts: the plan gets replay sources, period and duration,
/// `records` the series. Between samples an input does what the record says of it, else what the scenario's own replay
/// says, else it is held. One whose samples lie between ticks is held over each period at its mean there, which errs in
/// second order of the period.
void DriveByRecord(const MappedRecord& given, Plan& plan, Records& records);

/// Where a plan holds the start of record `record` alone, to be laid over it: "of_record.0.start", with "plant..." in it.
std::string StartOfRecord(std::size_t record);
/// Whether a dotted path lies in one of these.
bool IsOfAStart(std::string_view path);

/// Where a plan holds, by the path of a number, the factor by which that differs in record `record`: "of_record.1.times".
std::string DifferenceOfRecord(std::size_t record);

/// Writes a number at a dotted path, with the tables that lead there.
void WriteNumber(Value& root, const std::string& path, double value);

/// The plan as it starts into one record: with what it holds for that one alone, its start and how numbers differ there.
Plan StartingInto(const Plan& plan, std::size_t record);

/// The unit of a clock by which a record of this span and step [in units as read] fits the time scales of the scenario; `read`
/// where that does.
std::string TimeUnitFor(double span, double step, const Plan& plan, const std::string& read);

/// That the record has nothing to do with the time scales of the scenario, e.g. milliseconds taken as seconds.
struct ForeignTime {
  std::string what, way_out;
};
std::optional<ForeignTime> ForeignTimeScale(const MappedRecord& data, const Plan& plan);

}  // namespace dynoproof
