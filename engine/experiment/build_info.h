// What this program was built from.
#pragma once

#include <string>

namespace dynoproof::build_info {

extern const char* const kVersion;   // "0.1.0"
extern const char* const kCompiler;  // "GNU 12.2.0, Release"
/// The commit of the source tree at build time; "unknown" outside a checkout, with "+" behind it for a changed tree.
std::string Commit();

}  // namespace dynoproof::build_info
