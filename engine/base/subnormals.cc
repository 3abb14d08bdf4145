#include "base/subnormals.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace dynoproof {
namespace {

#if defined(__x86_64__)
constexpr std::uint64_t kFlush = 0x8040;  // MXCSR: flush to zero (bit 15), denormals are zero (bit 6)
std::uint64_t ReadControl() { return _mm_getcsr(); }
void WriteControl(std::uint64_t value) { _mm_setcsr(static_cast<unsigned>(value)); }
#elif defined(__aarch64__)
constexpr std::uint64_t kFlush = std::uint64_t{1} << 24;  // FPCR: FZ
std::uint64_t ReadControl() {
  std::uint64_t value;
  asm volatile("mrs %0, fpcr" : "=r"(value));
  return value;
}
void WriteControl(std::uint64_t value) { asm volatile("msr fpcr, %0" : : "r"(value)); }
#else
constexpr std::uint64_t kFlush = 0;
std::uint64_t ReadControl() { return 0; }
void WriteControl(std::uint64_t) {}
#endif

}  // namespace

FlushSubnormals::FlushSubnormals() : saved_(ReadControl()) { WriteControl(saved_ | kFlush); }

// Only the flush bits go back: exception flags raised meanwhile stay visible.
FlushSubnormals::~FlushSubnormals() { WriteControl((ReadControl() & ~kFlush) | (saved_ & kFlush)); }

}  // namespace dynoproof
