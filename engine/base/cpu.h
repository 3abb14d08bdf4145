// Which vector instructions this machine offers: fast kernels choose by it once, and a run's record names it, because
// the same inputs give the same bits on the same class only.
#pragma once

#include <string_view>

namespace dynoproof {

/// Rising: each class runs the kernels of those before it.
enum class CpuClass { kBaseline, kAvx2Fma, kAvx512 };

/// The best class of the machine the program runs on, but none above the one that the environment variable
/// DYNOPROOF_CPU_CLASS names as ToString does: so a test sees on one machine what another would do. kBaseline wherever it
/// is not an x86-64.
CpuClass DetectCpuClass();

/// "x86-64", "x86-64-avx2-fma", "x86-64-avx512"; elsewhere kBaseline is named after the architecture.
std::string_view ToString(CpuClass cpu_class);

/// ToString(DetectCpuClass()), for the provenance of a run.
std::string_view CpuFeatureClass();

}  // namespace dynoproof
