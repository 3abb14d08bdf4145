// Hum and drifts are taken off the records before causes are asked for.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "experiment/records.h"

namespace dynoproof::diagnosis {

/// Takes a course off a series, over its whole length. The course has At() of an instant of the series.
template <class Course>
void TakeOff(const Course& course, Series& series) {
  std::vector<double> values = *series.values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= course.At((*series.time)[i]);
  series.values = std::make_shared<const std::vector<double>>(std::move(values));
}

/// Takes each course off its output of its record. A course has a `record` and a `signal`, too.
template <class Course>
void TakeOff(const std::vector<Course>& courses, std::vector<MappedRecord>& records) {
  for (const Course& one : courses) TakeOff(one, records[one.record].outputs.at(one.signal));
}

}  // namespace dynoproof::diagnosis
