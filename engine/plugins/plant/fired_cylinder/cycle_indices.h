// Knock and NOx of a cycle as plain indices, so that the controls of thesis Sec. 6.1.3 have something to act on. Both are
// synthetic; shared by the cylinder with an ideal cycle and by the one whose cycle is resolved.
//
//   lambda = m_air/(L m_fuel)      knock = exp((theta_u - theta_knock)/theta_scale)
//   NOx/limit = exp(-a (lambda - lambda_0) - b retard)
#pragma once

#include <cmath>

#include "model/params.h"

namespace dynoproof {

struct CycleIndices {
  double air_need = 16.8, knock_theta_K = 800.0, knock_scale_K = 25.0, nox_air_ratio = 1.8, nox_per_air_ratio = 12.0,
         nox_per_deg = 0.1;
  void Visit(auto& v) {
    v.Optional("air_need", air_need, Positive("1"), "stoichiometric air, kg per kg of fuel");
    v.Optional("knock_theta_K", knock_theta_K, Positive(), "end gas that is just about to knock");
    v.Optional("knock_scale_K", knock_scale_K, Positive(), "by which knock grows e-fold");
    v.Optional("nox_air_ratio", nox_air_ratio, Positive("1"), "air ratio with NOx at its limit, without retard");
    v.Optional("nox_per_air_ratio", nox_per_air_ratio, NonNegative("1"), "its fall over the air ratio, logarithmic");
    v.Optional("nox_per_deg", nox_per_deg, NonNegative("1"), "its fall over the retard, logarithmic");
  }
  /// lambda of air and fuel [kg], at most 10.
  double AirRatio(double air, double fuel) const {
    return 10.0 * air_need * fuel <= air ? 10.0 : air / (air_need * fuel);
  }
  /// Of the unburnt end gas at its hottest [K].
  double Knock(double theta_unburnt) const { return std::exp((theta_unburnt - knock_theta_K) / knock_scale_K); }
  double Nox(double air_ratio, double retard_deg) const {
    return std::exp(-nox_per_air_ratio * (air_ratio - nox_air_ratio) - nox_per_deg * retard_deg);
  }
};

}  // namespace dynoproof
