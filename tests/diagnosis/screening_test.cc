// Candidates on top of what was found already.
#include "diagnosis/screening.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "experiment/prepare.h"
#include "scenario/load.h"

namespace dynoproof::diagnosis {
namespace {

Series Made(double size, std::uint64_t stream) {
  std::vector<double> time, values;
  for (std::uint64_t i = 0; i <= 200; ++i) {
    time.push_back(1e-4 * static_cast<double>(i));
    values.push_back(size * RandomNormal(5, stream, i));
  }
  return {std::make_shared<const std::vector<double>>(std::move(time)),
          std::make_shared<const std::vector<double>>(std::move(values))};
}

// A distributed rotor stands for the inertias of its run: they are no place for a second effect any more.
TEST(SlowScreening, PlacesThatAnEffectHasReplacedArePassedOver) {
  Registry registry;
  RegisterBuiltIns(registry);
  Diagnostics diagnostics;
  const std::optional<Plan> plan = LoadPlan("scenarios/diagnose/heavy_duty_lumped.toml", {}, diagnostics);
  ASSERT_TRUE(plan) << diagnostics.Format();
  MappedRecord record;
  record.inputs["T_airgap"] = Made(300.0, 1);
  record.outputs["T_shaft"] = Made(300.0, 2);
  record.outputs["omega_1"] = Made(0.1, 3);
  record.end_s = 0.02;
  const EstimationProblem problem(*plan, {record}, registry);
  const std::vector<Candidate> candidates = CandidatesFor(problem, MagnitudesOf(problem));
  const auto rotor = std::find_if(candidates.begin(), candidates.end(), [](const Candidate& candidate) {
    return candidate.effect->info().name == "distributed_inertia";
  });
  ASSERT_NE(rotor, candidates.end());
  Estimate base =
      EstimateAt(problem, {std::vector<double>(problem.nuisances().size(), 0.0), {rotor->At(rotor->starts.front())}});
  ASSERT_TRUE(base.ok()) << base.broken;
  const Result<NuisanceModel> nuisances = LineariseNuisances(problem, base.hypothesis, base.nuisances.freedom);
  ASSERT_TRUE(nuisances.ok());
  base.nuisances = *nuisances;
  const Estimator estimator(problem, WhitenerOf(problem, base, 0));
  estimator.Score(base);
  const std::vector<Screened> screened = Screen(problem, estimator, base, candidates, 50.0, [](double) {});
  int gone = 0, there = 0;
  for (const Screened& one : screened) {
    const std::string place = candidates[one.candidate].place.ToString();
    if (place == "inertia:I1" || place == "inertia:I2" || place == "shaft:k1") {
      EXPECT_FALSE(std::isfinite(one.chi2)) << candidates[one.candidate].ToString();
      ++gone;
    } else if (place.starts_with("output:")) {
      there += one.simulations > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(gone, 10);
  EXPECT_GT(there, 5);
}

}  // namespace
}  // namespace dynoproof::diagnosis
