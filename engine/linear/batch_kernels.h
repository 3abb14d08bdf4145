// The inner loop of a batch step, once for each class of vector instructions. Internal to BatchPropagator.
#pragma once

#include "linear/batch_propagator.h"

namespace dynoproof::mechanics {

/// `rows` and `inputs` of the plan.
BatchKernel BatchKernelFor(CpuClass cpu_class, int rows, int inputs);

}  // namespace dynoproof::mechanics
