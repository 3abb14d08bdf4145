// The error along one parameter has one minimum where a run is corrected by its record, and many in the free run.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/predictor.h"
#include "tests/estimation/four_masses.h"
#include "tests/estimation/made_record.h"

namespace dynoproof::estimation {
namespace {

/// What a record of `truth` says of models along one parameter of an effect.
class Landscape {
 public:
  Landscape(const Plan& nominal, const Plan& truth, const std::vector<std::string>& outputs)
      : nominal_(nominal), data_({RecordOf(truth, 0.005, outputs)}, nominal, {.most_rows = 4000}) {
    Result<LinearModel> model = LinearModel::Of(nominal, data_.records().front(), testing::BuiltIns());
    EXPECT_TRUE(model.ok());
    if (model.ok()) model_ = *std::move(model);
  }

  struct Course {
    int minima = 0;        // inside, of 50 intervals
    double best = 0.0;     // the parameter there
    double removed = 0.0;  // of the error beyond the noise's own, at the first point
  };
  /// `memory_s`: nothing for the free run.
  Course Along(const std::string& effect, const std::string& at, double from, double to,
               std::optional<double> memory_s) const {
    constexpr int kIntervals = 50;
    const Predictor predictor(data_, model_, testing::BuiltIns(), memory_s, decompositions_);
    std::vector<double> errors;
    for (int i = 0; i <= kIntervals; ++i)
      errors.push_back(ErrorOf(predictor, WithEffect(nominal_, effect, at, {from + (to - from) * i / kIntervals})));
    Course course;
    std::size_t best = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (errors[i] < errors[best]) best = i;
      if (i > 0 && i + 1 < errors.size() && errors[i] < errors[i - 1] && errors[i] <= errors[i + 1]) ++course.minima;
    }
    course.best = from + (to - from) * static_cast<double>(best) / kIntervals;
    course.removed = 1.0 - errors[best] / errors[0];
    return course;
  }

 private:
  double ErrorOf(const Predictor& predictor, const Plan& plan) const {
    const Result<Prediction> there = predictor.Predict(plan);
    EXPECT_TRUE(there.ok());
    if (!there.ok()) return INFINITY;
    double sum = 0.0;
    for (std::size_t c = 0; c < data_.channels().size(); ++c) {
      const Channel& channel = data_.channels()[c];
      const double power =
          there->innovations.segment(channel.begin, channel.count).squaredNorm() / static_cast<double>(channel.count);
      sum += (power - std::pow(there->noise_alone[static_cast<Eigen::Index>(c)], 2)) / std::pow(channel.spread, 2);
    }
    return sum;
  }

  Plan nominal_;
  DataSet data_;
  LinearModel model_;
  std::shared_ptr<mechanics::Decompositions> decompositions_ = std::make_shared<mechanics::Decompositions>();
};

Plan Finely(Plan plan) {
  SetSubsteps(plan, 16);
  return plan;
}

TEST(Landscape, AStiffnessHasOneMinimumCorrectedAndManyInTheFreeRun) {
  const Plan plan = FourMasses(1.2);
  const Landscape landscape(plan, WithEffect(plan, "stiffness_change", "shaft:k2", {-0.12}), {"T_shaft", "omega_1"});
  for (const double memory_s : {0.005, 0.025, 0.25}) {
    const auto course = landscape.Along("stiffness_change", "shaft:k2", -0.25, 0.25, memory_s);
    EXPECT_EQ(course.minima, 1) << memory_s;
    EXPECT_NEAR(course.best, -0.12, 0.0101) << memory_s;
  }
  EXPECT_GT(landscape.Along("stiffness_change", "shaft:k2", -0.25, 0.25, std::nullopt).minima, 8);
}

TEST(Landscape, AFrictionAtAWrongPlaceExplainsNothingCorrectedAndMuchInTheFreeRun) {
  const Plan plan = FourMasses(1.2);
  const Landscape landscape(plan, Finely(WithEffect(plan, "coulomb_friction", "inertia:I4", {8.0})),
                            {"T_shaft", "omega_1"});
  for (const double memory_s : {0.005, 0.025}) {
    const auto course = landscape.Along("coulomb_friction", "inertia:I4", 0.0, 20.0, memory_s);
    EXPECT_EQ(course.minima, 1) << memory_s;
    EXPECT_NEAR(course.best, 8.0, 0.41) << memory_s;
  }
  for (const char* wrong : {"inertia:I1", "inertia:I2", "inertia:I3"}) {
    EXPECT_LT(landscape.Along("coulomb_friction", wrong, 0.0, 20.0, 0.025).removed, 0.02) << wrong;
    EXPECT_LT(landscape.Along("coulomb_friction", wrong, 0.0, 20.0, 0.25).removed, 0.02) << wrong;
    EXPECT_GT(landscape.Along("coulomb_friction", wrong, 0.0, 20.0, std::nullopt).removed, 0.35) << wrong;
  }
}

TEST(SlowLandscape, OnASoftRotorAWrongPlaceOfFrictionExplainsNearlyAllInTheFreeRun) {
  const Plan plan = Reversing();
  const Landscape landscape(plan, Finely(WithEffect(plan, "coulomb_friction", "inertia:I5", {10.0})),
                            {"T_shaft", "omega_1"});
  const auto right = landscape.Along("coulomb_friction", "inertia:I5", 0.0, 25.0, 0.025);
  EXPECT_EQ(right.minima, 1);
  EXPECT_NEAR(right.best, 10.0, 0.51);
  for (const char* wrong : {"rotor:I1", "inertia:I4"}) {
    EXPECT_LT(landscape.Along("coulomb_friction", wrong, 0.0, 25.0, 0.01).removed, 0.02) << wrong;
    EXPECT_LT(landscape.Along("coulomb_friction", wrong, 0.0, 25.0, 0.025).removed, 0.06) << wrong;
    EXPECT_GT(landscape.Along("coulomb_friction", wrong, 0.0, 25.0, std::nullopt).removed, 0.9) << wrong;
  }
}

TEST(Landscape, PlayHasOneMinimumWhereTheSideBehindItIsSeen) {
  const Plan plan = FourMasses(1.2);
  const Plan truth = WithEffect(plan, "backlash", "shaft:k2", {1e-4});
  const Landscape seen(plan, truth, {"T_shaft", "omega_1", "omega_4"}), unseen(plan, truth, {"T_shaft", "omega_1"});
  const auto course = seen.Along("backlash", "shaft:k2", 0.0, 2.5e-4, 0.001);
  EXPECT_EQ(course.minima, 1);
  EXPECT_NEAR(course.best, 1e-4, 5.1e-6);
  EXPECT_GT(unseen.Along("backlash", "shaft:k2", 0.0, 2.5e-4, 0.005).minima, 2);
  EXPECT_GT(seen.Along("backlash", "shaft:k2", 0.0, 2.5e-4, std::nullopt).minima, 8);
}

}  // namespace
}  // namespace dynoproof::estimation
