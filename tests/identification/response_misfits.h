// A chirp of the lumped line, and what a misfit misses of it at the truth and beside it.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "identification/objective.h"
#include "tests/identification/line_record.h"
#include "tests/identification/lumped_line.h"

namespace dynoproof::identification {

class ResponseMisfits : public LumpedLine {
 protected:
  ResponseMisfits() : problem_(*plan_, {Chirp()}, registry_) {}

  /// 0 to 2000 Hz in 2 s, from a line that no engine code simulated. Its two outer shafts have a little damping here:
  /// their resonances ring down within the record.
  static MappedRecord Chirp(double noise = 1e-4) {
    blind::IndependentLine line;
    line.damping = {850.4, 800.0, kDamping, kDamping};
    std::vector<double> torque;
    for (std::size_t i = 0; i < 20001; ++i) {
      const double t = 1e-4 * static_cast<double>(i);
      torque.push_back(t < 1.9 ? 1000.0 * std::sin(2.0 * M_PI * 0.5 * 1050.0 * t * t) : 0.0);
    }
    return LineRecord(line, std::move(torque), noise);
  }
  /// The plan of the line that was measured, with one number times `factor`.
  Plan Of(const char* key, double factor) const {
    Plan plan = *plan_;
    for (const char* shaft : {"plant.shaft.k3.damping_Nms_per_rad", "plant.shaft.k4.damping_Nms_per_rad"})
      *plan.root.FindPath(shaft) = Value(kDamping);
    *plan.root.FindPath(key) = Value(factor * plan.root.FindPath(key)->number());
    return plan;
  }
  /// Root mean square of what is missed.
  double Missed(const Objective& objective, const char* key, double factor) const {
    const Result<Eigen::VectorXd> error = objective.Of(Of(key, factor));
    EXPECT_TRUE(error.ok()) << error.failure().ToString();
    EXPECT_EQ(error->size(), objective.size());
    return std::sqrt(error->squaredNorm() / static_cast<double>(error->size()));
  }

  static constexpr double kDamping = 15.0;
  static constexpr const char* kStiffness = "plant.shaft.k4.stiffness_Nm_per_rad";
  static constexpr const char* kLoss = "plant.shaft.k4.damping_Nms_per_rad";
  EstimationProblem problem_;
};

}  // namespace dynoproof::identification
