// The texts that every page is made of, as they stand in this folder; embed.cmake puts them into the program.
#pragma once

#include <string_view>

namespace dynoproof::reports::assets {

extern const std::string_view kPageHtml, kPageCss, kDrawingJs, kPageJs;
/// uPlot (MIT) from npm; all empty where it could not be fetched when the program was built.
extern const std::string_view kUPlotJs, kUPlotCss, kUPlotLicence;

}  // namespace dynoproof::reports::assets
