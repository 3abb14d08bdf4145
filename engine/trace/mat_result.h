// Results of Modelica simulators (Dymola, OpenModelica, ...): MAT v4 files whose matrices hold a table of variables.
//
//   Aclass             text, "Atrajectory", "1.1", "", "binTrans" or "binNormal": whether what follows is transposed
//   name, description  text, a variable each
//   dataInfo           4 numbers a variable: which data_<k>, which of its signals (negative: with its sign turned),
//                      interpolation, extrapolation; 0 for <k>: the abscissa of all
//   data_<k>           the signals, of which the first is the time
#pragma once

#include <string>
#include <vector>

#include "trace/mat_matrix.h"

namespace dynoproof::trace::mat {

/// Whether the matrices are such a result.
bool IsResult(const std::vector<Matrix>& matrices);

/// Appends every variable that has samples, under its own name ("inertia1.w"), aliases too; the unit is what stands in
/// brackets at the end of its description. The time is the column "time", however it is written. Parameters and
/// constants, which data_1 holds by two values, are left out. Rows at one instant stay as they are. Returns what is
/// wrong; "" if nothing is.
std::string AddResult(const std::vector<Matrix>& matrices, Record& record);

}  // namespace dynoproof::trace::mat
