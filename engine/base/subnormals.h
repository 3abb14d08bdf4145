// Subnormal numbers cost a decaying oscillation about twice its time and carry nothing: a 10 kHz step runs with them
// flushed to zero.
#pragma once

#include <cstdint>

namespace dynoproof {

/// While it lives, this thread takes subnormal operands as zero and rounds subnormal results to zero (x86-64: FTZ and
/// DAZ of MXCSR; aarch64: FZ of FPCR; elsewhere nothing happens). The destructor restores what it found. Results then
/// differ from the IEEE standard below 2.3e-308 only.
class FlushSubnormals {
 public:
  FlushSubnormals();
  ~FlushSubnormals();
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;

 private:
  std::uint64_t saved_;
};

}  // namespace dynoproof
