// A diagnosis speaks in the terms of the estimation kernel.
#pragma once

namespace dynoproof::identification {}

namespace dynoproof::diagnosis {

using namespace identification;  // NOLINT(google-build-using-namespace): one place, instead of a prefix on every line

}  // namespace dynoproof::diagnosis
