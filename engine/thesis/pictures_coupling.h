// Pictures of hydrodynamic couplings, chapter 4: appended where they apply.
#pragma once

#include "experiment/pictures.h"

namespace dynoproof {

void AddCouplings(const Prepared& prepared, const Course& course, RunPictures& pictures);

}  // namespace dynoproof
