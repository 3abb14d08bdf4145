// Pictures of the control loop of chapter 5: appended where they apply.
#pragma once

#include "experiment/pictures.h"

namespace dynoproof {

void AddLoop(const Prepared& prepared, const Course& course, RunPictures& pictures);

}  // namespace dynoproof
