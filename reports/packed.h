// Curves as the page holds them: thinned to a number of samples that still shows every peak, and packed into a few
// bytes a value.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dynoproof::reports {

/// RFC 4648, with padding.
std::string Base64(std::span<const std::byte> bytes);

/// Numbers for drawing.js. Equal steps: { from, step, n }. Else { n, q }: base64 of blocks of 256 values, each the
/// block's offset and step (float64) and an uint16 a value, little-endian; value = offset + step q, 65535 is a gap. The
/// error is below half of 1/65534 of the range of the 256 neighbours, so that small parts of a large signal keep their
/// shape.
nlohmann::json Pack(const std::vector<double>& values);

/// At most `most` samples (or two, if that is more) of y over rising x: of equal stretches of samples the least and the
/// largest, each at its own x and in their order. NaN counts only in a stretch of nothing else. Shorter curves stay as
/// they are.
std::pair<std::vector<double>, std::vector<double>> Thin(const std::vector<double>& x, const std::vector<double>& y,
                                                         std::size_t most);

}  // namespace dynoproof::reports
