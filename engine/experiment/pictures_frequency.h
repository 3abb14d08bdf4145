// Pictures over frequency: spectra, and the responses and poles of [analysis].
#pragma once

#include "experiment/pictures.h"

namespace dynoproof {

void AddSpectra(const Prepared& prepared, const Course& course, RunPictures& pictures);
void AddResponses(const Prepared& prepared, const Course& course, RunPictures& pictures);

}  // namespace dynoproof
