#include "estimation/parameter.h"

#include <cmath>

namespace dynoproof::estimation {

double Parameter::ValueAt(double q) const {
  return logarithmic ? reference * std::exp(scale * q) : reference + scale * q;
}

double Parameter::CoordinateOf(double value) const {
  return logarithmic ? std::log(value / reference) / scale : (value - reference) / scale;
}

}  // namespace dynoproof::estimation
