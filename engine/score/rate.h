// A share of counted cases with its interval.
#pragma once

namespace dynoproof::score {

/// A rate with its 95 % Wilson interval.
struct Rate {
  long hits = 0, of = 0;
  double value() const { return of > 0 ? static_cast<double>(hits) / static_cast<double>(of) : 0.0; }
  double lower() const { return Wilson(-1.0); }
  double upper() const { return Wilson(1.0); }

 private:
  double Wilson(double sign) const;
};

}  // namespace dynoproof::score
