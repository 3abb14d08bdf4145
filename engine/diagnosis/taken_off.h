// What is taken off records before causes are asked for: hum, drifts.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "experiment/records.h"

namespace dynoproof::diagnosis {

/// Takes courses off the outputs, over their whole length. A course has a `record`, a `signal`, and At() of an instant of its series.
template <class Course>
void TakeOff(const std::vector<Course>& courses, std::vector<MappedRecord>& records) {
  for (const Course& one : courses) {
    Series& series = records[one.record].outputs.at(one.signal);
    std::vector<double> values = *series.values;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] -= one.At((*series.time)[i]);
    series.values = std::make_shared<const std::vector<double>>(std::move(values));
  }
}

}  // namespace dynoproof::diagnosis
