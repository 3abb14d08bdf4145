#include "plugins/source/chirp/chirp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dynoproof::sources {

PluginInfo Chirp::Info() {
  return {"source",
          "chirp",
          "sine with linearly changing frequency",
          "offset + amplitude sin(2 pi (f_0 tau + kappa tau^2/2) + phase), tau = t - start_time",
          "thesis (2.7)",
          {}};
}

void Chirp::Params::Check(Faults& faults) const {
  if ((rate_Hz_per_s > 0.0) == (duration_s > 0.0)) {
    faults.At(rate_Hz_per_s > 0.0 ? "duration_s" : "rate_Hz_per_s", "give either rate_Hz_per_s or duration_s",
              "one of the two, > 0");
  }
  if (rate_Hz_per_s > 0.0 && start_Hz == end_Hz) {
    faults.At("end_Hz", "start and end frequency are equal, so the rate says nothing", "give duration_s instead");
  }
}

Chirp::Chirp(const Params& params) : p_(params) {
  const double span = p_.end_Hz - p_.start_Hz;
  duration_ = p_.duration_s > 0.0 ? p_.duration_s : std::abs(span) / p_.rate_Hz_per_s;
  kappa_ = span / duration_;
}

std::unique_ptr<Chirp> Chirp::Create(const Params& params, const dynoproof::Value& table, BuildContext& context) {
  WarnAboveHalfTheRate(std::max(params.start_Hz, params.end_Hz), "end_Hz", table, context);
  return std::make_unique<Chirp>(params);
}

double Chirp::Value(double time_s) const {
  const double tau = time_s - p_.start_time_s;
  const bool over = tau > duration_ + kTimeSlack;
  if (tau < 0.0 || (over && p_.after == "silent")) return p_.offset;
  const double sweep = std::min(tau, duration_);
  double cycles = p_.start_Hz * sweep + 0.5 * kappa_ * sweep * sweep;
  if (over) cycles += p_.end_Hz * (tau - duration_);
  // Whole cycles are taken off before the multiplication by 2 pi: its rounding error grows with the argument.
  return p_.offset + p_.amplitude * std::sin(2.0 * std::numbers::pi * (cycles - std::floor(cycles)) + p_.phase_rad);
}

}  // namespace dynoproof::sources
