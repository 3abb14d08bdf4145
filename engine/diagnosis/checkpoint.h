// What a stopped diagnosis had reached: the screening's start points and the optima, in a file of the output folder.
// They are starting points only; every figure of a result is computed anew.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/screening.h"

namespace dynoproof::diagnosis {

class SavedFits {
 public:
  /// Reads what is there if `resume`, and it belongs to the same scenario and records.
  SavedFits(std::string file, bool resume, const EstimationProblem& problem);

  std::vector<Screened> Screening(const std::string& stage) const;
  void KeepScreening(const std::string& stage, const std::vector<Screened>& screened);
  /// Puts the saved optimum of these effects into their parameters; false when there is none.
  bool Recall(std::vector<EffectInstance>& effects) const;
  void Keep(const std::vector<EffectInstance>& effects);

 private:
  void Write() const;

  std::string file_, fingerprint_;
  std::vector<std::pair<std::string, std::vector<Screened>>> screenings_;
  std::vector<std::pair<std::string, std::vector<std::vector<double>>>> optima_;
};

}  // namespace dynoproof::diagnosis
