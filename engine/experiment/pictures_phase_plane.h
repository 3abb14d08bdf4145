// Pictures of shafts with play: twist and rate, with the areas of the law.
#pragma once

#include "experiment/pictures.h"

namespace dynoproof {

void AddPhasePlanes(const Prepared& prepared, const Course& course, RunPictures& pictures);

}  // namespace dynoproof
