// Texts of `dynoproof new`.
#pragma once

namespace dynoproof::app {

extern const char* const kScenarioTemplate;
extern const char* const kPluginCmake;
extern const char* const kLawTemplate;
extern const char* const kEffectTemplate;

}  // namespace dynoproof::app
