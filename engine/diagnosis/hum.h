// Hum: a tone in what a model leaves of an output, which no machine of the model's kind makes.
#pragma once

#include <string>
#include <vector>

#include "experiment/records.h"
#include "identification/estimation_problem.h"
#include "model/plan.h"

namespace dynoproof::diagnosis {

/// value(t) = sine sin(2 pi f t) + cosine cos(2 pi f t), of one output of one record, t as in its series.
struct Hum {
  std::size_t record = 0;
  std::string signal;
  double frequency_hz = 0.0;
  double sine = 0.0, cosine = 0.0;  // unit of the signal
  double share = 0.0;               // RMS of the tone over the signal's spread

  double At(double time_s) const;
};

/// The hum in what a plan leaves in its free run, nothing where that breaks: of each channel a tone above 5 Hz, the same in both halves of the record, that stands five
/// times above everything further off than 5 Hz, leaves a third of itself at most where it was, and is a fifth of the output at most. Where an input is a tone itself, its
/// multiples are none. A channel whose steps are not equal has none.
std::vector<Hum> FindHum(const identification::EstimationProblem& problem, const Plan& plan);

/// "a tone of 50.2 Hz, 3 % of T_shaft, ...", for a person.
std::string ToText(const std::vector<Hum>& hum);

}  // namespace dynoproof::diagnosis
