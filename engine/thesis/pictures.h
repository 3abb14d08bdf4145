// Pictures of the thesis' chapters 4 and 5, each appending what applies to the scenario.
#pragma once

#include "experiment/pictures.h"

namespace dynoproof {

void AddCouplings(const Prepared& prepared, const Course& course, RunPictures& pictures);
void AddLoop(const Prepared& prepared, const Course& course, RunPictures& pictures);

}  // namespace dynoproof
