#include "reports/packed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

namespace dynoproof::reports {
namespace {

static_assert(std::endian::native == std::endian::little, "packed numbers are little-endian");

constexpr std::size_t kBlock = 256;
constexpr std::uint16_t kGap = 65535;

template <class T>
void Append(std::vector<std::byte>& bytes, T value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// Whether the values are from + step i to a millionth of a step (round-off of time stamps).
bool IsEven(const std::vector<double>& values) {
  if (values.size() < 2 || !std::isfinite(values.front()) || !std::isfinite(values.back())) return false;
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double error = values[i] - (values.front() + step * static_cast<double>(i));
    if (!(std::abs(error) <= 1e-6 * std::abs(step))) return false;
  }
  return true;
}

}  // namespace

std::string Base64(std::span<const std::byte> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (k < count ? static_cast<std::uint32_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

nlohmann::json Pack(const std::vector<double>& values) {
  if (IsEven(values)) {
    const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
    return {{"from", values.front()}, {"step", step}, {"n", values.size()}};
  }
  std::vector<std::byte> bytes;
  bytes.reserve(2 * values.size() + 16 * (values.size() / kBlock + 1));
  for (std::size_t begin = 0; begin < values.size(); begin += kBlock) {
    const std::size_t end = std::min(values.size(), begin + kBlock);
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = begin; i < end; ++i) {
      if (!std::isfinite(values[i])) continue;
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    if (low > high) low = high = 0.0;
    const double step = (high - low) / (kGap - 1);
    Append(bytes, low);
    Append(bytes, step);
    for (std::size_t i = begin; i < end; ++i) {
      const bool gap = !std::isfinite(values[i]);
      Append(bytes, gap ? kGap : static_cast<std::uint16_t>(step > 0.0 ? std::lround((values[i] - low) / step) : 0));
    }
  }
  return {{"n", values.size()}, {"q", Base64(bytes)}};
}

std::pair<std::vector<double>, std::vector<double>> Thin(const std::vector<double>& x, const std::vector<double>& y,
                                                         std::size_t most) {
  if (y.size() <= std::max<std::size_t>(2, most)) return {x, y};
  const std::size_t stretches = std::max<std::size_t>(1, most / 2);
  std::pair<std::vector<double>, std::vector<double>> thin;
  for (std::size_t k = 0; k < stretches; ++k) {
    const std::size_t begin = y.size() * k / stretches, end = y.size() * (k + 1) / stretches;
    std::size_t low = begin, high = begin;
    for (std::size_t i = begin; i < end; ++i) {
      if (y[i] < y[low] || std::isnan(y[low])) low = i;
      if (y[i] > y[high] || std::isnan(y[high])) high = i;
    }
    for (const std::size_t i : {std::min(low, high), std::max(low, high)}) {
      if (!thin.first.empty() && thin.first.back() == x[i] && low == high) continue;  // one sample is both
      thin.first.push_back(x[i]);
      thin.second.push_back(y[i]);
    }
  }
  return thin;
}

}  // namespace dynoproof::reports
