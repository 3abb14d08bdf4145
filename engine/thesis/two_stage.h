// The method `two_stage` of `identify`, thesis (2.69) to (2.72).
#pragma once

namespace dynoproof::identification {

/// Brings it along: what is no damping by the resonances and zeros, then dampings by the resonances' gains. It gives no
/// intervals. It fails as MeasuredLandmarks and Minimise do.
void AddTwoStage();

}  // namespace dynoproof::identification
