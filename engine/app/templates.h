// Texts of `dynoproof new`.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace dynoproof::app {

extern const char* const kScenarioTemplate;
extern const char* const kPluginCmake;
extern const char* const kLawTemplate;
extern const char* const kEffectTemplate;
extern const char* const kCheckHeader;
extern const char* const kCheckTemplate;
extern const char* const kCheckReadme;
// What makes the scenario of kScenarioTemplate one that uses the law (in its shaft k2), the effect, the kind of
// check, a golden trace.
extern const char* const kLawUse;
extern const char* const kEffectUse;
extern const char* const kCheckUse;
extern const char* const kGoldenUse;

/// The files of ci/templates/project by name: what `new project` writes besides the scenario.
const std::vector<std::pair<std::string, std::string>>& ProjectFiles();

}  // namespace dynoproof::app
