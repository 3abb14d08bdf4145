// What tells the effects of a pressure plant apart.
#pragma once

namespace dynoproof {

inline constexpr const char* kSeparatingFlows =
    "repeat the record at another working point, half and twice the flow, with single steps of one actuator at a time "
    "and rests in between: areas grow with the opening, leaks with the pressure, play with each reversal";

}  // namespace dynoproof
