// Pictures over frequency: spectra, and the responses and poles of [analysis].
#pragma once

#include <vector>

#include "experiment/analysis.h"
#include "experiment/pictures.h"

namespace dynoproof {

void AddSpectra(const Prepared& prepared, const Course& course, RunPictures& pictures);
void AddResponses(const Prepared& prepared, const Course& course, RunPictures& pictures);

/// Without a run: the plant's response from the analysed input to its output, its poles and zeros, and the shapes of its modes.
std::vector<Picture> PicturesOfModes(const Prepared& prepared, const AnalysisSettings& settings,
                                     const LinearAnalysis& analysis);

}  // namespace dynoproof
