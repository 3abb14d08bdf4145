#include "score/share.h"

namespace dynoproof::score {

double ShareOfLimit(const Check& check) {
  return check.at_least ? check.limit / check.value : check.value / check.limit;
}

}  // namespace dynoproof::score
