// What a curve loses on its way into the page: nothing that a reader could see.
#include "reports/packed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace dynoproof::reports {
namespace {

std::string Base64Of(std::string_view text) { return Base64(std::as_bytes(std::span(text))); }

std::vector<std::uint8_t> Decode(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned group = 0, bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6U | static_cast<unsigned>(digits.find(c));
    if ((bits += 6) >= 8) bytes.push_back(static_cast<std::uint8_t>(group >> (bits -= 8)));
  }
  return bytes;
}

/// drawing.js, once more.
std::vector<double> Unpack(const nlohmann::json& packed) {
  std::vector<double> values(packed.at("n").get<std::size_t>());
  if (!packed.contains("q")) {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = packed.at("from").get<double>() + packed.at("step").get<double>() * static_cast<double>(i);
    return values;
  }
  const std::vector<std::uint8_t> bytes = Decode(packed.at("q"));
  std::size_t at = 0;
  for (std::size_t i = 0; i < values.size();) {
    double block[2];
    std::memcpy(block, &bytes.at(at), sizeof block);
    at += sizeof block;
    for (const std::size_t end = std::min(values.size(), i + 256); i < end; ++i, at += 2) {
      const unsigned q = bytes.at(at) + 256U * bytes.at(at + 1);
      values[i] = q == 65535 ? NAN : block[0] + block[1] * q;
    }
  }
  EXPECT_EQ(at, bytes.size());
  return values;
}

TEST(Base64, IsThatOfTheRfc) {
  EXPECT_EQ(Base64Of(""), "");
  EXPECT_EQ(Base64Of("f"), "Zg==");
  EXPECT_EQ(Base64Of("fo"), "Zm8=");
  EXPECT_EQ(Base64Of("foo"), "Zm9v");
  EXPECT_EQ(Base64Of("foobar"), "Zm9vYmFy");
}

TEST(Pack, KeepsTheShapeOfSmallPartsOfALargeSignal) {
  std::vector<double> values;
  for (int i = 0; i < 3000; ++i) values.push_back((i < 1000 ? 1e3 : 1e-3) * std::sin(0.05 * i));
  const std::vector<double> back = Unpack(Pack(values));
  ASSERT_EQ(back.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    // Half a step of the block's range; blocks that hold both parts have the larger range.
    EXPECT_NEAR(back[i], values[i], (i < 1024 ? 2e3 : 2e-3) / 65534.0 * 0.501) << i;
  }
}

TEST(Pack, TellsGapsConstantsAndEvenSteps) {
  const std::vector<double> back = Unpack(Pack({1.0, NAN, 3.0, INFINITY, 3.0}));
  EXPECT_DOUBLE_EQ(back[0], 1.0);
  EXPECT_TRUE(std::isnan(back[1]));
  EXPECT_DOUBLE_EQ(back[2], 3.0);
  EXPECT_TRUE(std::isnan(back[3]));
  EXPECT_EQ(Unpack(Pack({7.0, 7.0, 7.0})), (std::vector<double>{7.0, 7.0, 7.0}));
  EXPECT_EQ(Unpack(Pack({5.0})), (std::vector<double>{5.0}));
  EXPECT_TRUE(Unpack(Pack({})).empty());
  EXPECT_TRUE(std::isnan(Unpack(Pack({NAN}))[0]));
  std::vector<double> time;
  for (int i = 0; i < 100'000; ++i) time.push_back(i * 1e-4);
  EXPECT_LT(Pack(time).dump().size(), 100u) << "a time base costs nothing";
}

TEST(Pack, OfATenSecondChirpWithFiveSignalsIsWellBelowThreeMegabytes) {
  std::size_t bytes = 0;
  for (int k = 0; k < 5; ++k) {
    std::vector<double> values;
    for (int i = 0; i < 100'001; ++i) values.push_back(std::sin(1e-4 * k * i * i));
    bytes += Pack(values).dump().size();
  }
  EXPECT_LT(bytes, 1'500'000u);
}

TEST(Thin, KeepsEveryPeakAndTheOrder) {
  std::vector<double> x, y;
  for (int i = 0; i < 100'000; ++i) {
    x.push_back(i);
    y.push_back(std::sin(0.7 * i));
  }
  y[31'234] = 50.0;
  y[77'001] = -40.0;
  const auto [tx, ty] = Thin(x, y, 2000);
  EXPECT_LE(ty.size(), 2000u);
  EXPECT_GE(ty.size(), 1900u);
  EXPECT_TRUE(std::is_sorted(tx.begin(), tx.end()));
  const auto peak = std::max_element(ty.begin(), ty.end()), dip = std::min_element(ty.begin(), ty.end());
  EXPECT_EQ(*peak, 50.0);
  EXPECT_EQ(tx[static_cast<std::size_t>(peak - ty.begin())], 31'234.0);
  EXPECT_EQ(*dip, -40.0);
  for (std::size_t i = 0; i < tx.size(); ++i) EXPECT_EQ(ty[i], y[static_cast<std::size_t>(tx[i])]) << "a sample of it";
}

TEST(Thin, LeavesShortCurvesAndStepsOverGaps) {
  const std::vector<double> x = {0, 1, 2, 3}, y = {4, NAN, 6, 7};
  EXPECT_EQ(Thin(x, y, 4).second.size(), 4u);
  const auto [tx, ty] = Thin(x, y, 2);
  EXPECT_EQ(tx, (std::vector<double>{0, 3}));
  EXPECT_EQ(ty, (std::vector<double>{4, 7}));
  EXPECT_TRUE(Thin({}, {}, 10).second.empty());
}

}  // namespace
}  // namespace dynoproof::reports
