#include "base/cpu.h"

#include <algorithm>
#include <cstdlib>

namespace dynoproof {
namespace {

CpuClass OfMachine() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (avx2 && avx512) return CpuClass::kAvx512;
  if (avx2) return CpuClass::kAvx2Fma;
#endif
  return CpuClass::kBaseline;
}

CpuClass Wanted() {
  const char* name = std::getenv("DYNOPROOF_CPU_CLASS");
  for (const CpuClass cpu_class : {CpuClass::kBaseline, CpuClass::kAvx2Fma}) {
    if (name != nullptr && name == ToString(cpu_class)) return cpu_class;
  }
  return CpuClass::kAvx512;
}

}  // namespace

CpuClass DetectCpuClass() {
  static const CpuClass cpu_class = std::min(OfMachine(), Wanted());
  return cpu_class;
}

std::string_view ToString(CpuClass cpu_class) {
  switch (cpu_class) {
    case CpuClass::kAvx512:
      return "x86-64-avx512";
    case CpuClass::kAvx2Fma:
      return "x86-64-avx2-fma";
    case CpuClass::kBaseline:
      break;
  }
#if defined(__x86_64__)
  return "x86-64";
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "generic";
#endif
}

std::string_view CpuFeatureClass() { return ToString(DetectCpuClass()); }

}  // namespace dynoproof
