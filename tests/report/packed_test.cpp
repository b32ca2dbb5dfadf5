// The numbers that a page holds for page.js: packed into few bytes, and thinned without losing
// their extremes.
#include "report/packed.hpp"
#include "report/page_data.hpp"

#include "support/nan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace goingrate {
namespace {

using test::nan;

std::string bytes_of(const std::string& base64) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : base64) {
    if (c == '=') break;
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    bits = bits << 6U | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xffU);
  }
  return bytes;
}

std::uint64_t number_at(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < size; ++i)
    number |= std::uint64_t{static_cast<unsigned char>(bytes.at(at + i))} << (8 * i);
  return number;
}

std::vector<double> unpacked(const std::string& text, std::size_t count) {
  const std::string bytes = bytes_of(text);
  std::vector<double> values;
  std::size_t at = 0;
  while (values.size() < count) {
    const double least = std::bit_cast<double>(number_at(bytes, at, 8));
    const double step = std::bit_cast<double>(number_at(bytes, at + 8, 8));
    at += 16;
    for (std::size_t i = 0; i < packed_block && values.size() < count; ++i, at += 2) {
      const std::uint64_t number = number_at(bytes, at, 2);
      values.push_back(number == 65535 ? nan : least + step * static_cast<double>(number));
    }
  }
  EXPECT_EQ(at, bytes.size());
  return values;
}

Figure long_figure(std::size_t count) {
  Series series{Series::Style::points, "</script>", {}, {}, {}, {}, 0};
  for (std::size_t i = 0; i < count; ++i) {
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(std::sin(static_cast<double>(i)));
  }
  series.y[count / 3] = 7.0;
  return {"test", "A title", "A caption", {"time", "s"}, {"rate", ""}, {series}};
}

TEST(PackedReportTest, KeepsEveryValueWithinHalfAStep) {
  std::vector<double> values;
  for (int i = 0; i < 3000; ++i)
    values.push_back(1e6 + i + std::sin(i));
  values[17] = nan;
  values[2500] = std::numeric_limits<double>::infinity();
  const auto back = unpacked(packed(values), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]))
      EXPECT_NEAR(back[i], values[i], 1026.0 / 131068.0 + 1e-9) << i; // half a step, and rounding
    else
      EXPECT_TRUE(std::isnan(back[i])) << i;
  }
}

TEST(PackedReportTest, TakesConstantAndMissingValues) {
  const std::vector<double> constant(5, 2.5);
  EXPECT_EQ(unpacked(packed(constant), 5), constant);
  for (const double value : unpacked(packed(std::vector<double>(4, nan)), 4))
    EXPECT_TRUE(std::isnan(value));
  EXPECT_EQ(packed(std::vector<double>{}), "");
}

TEST(PackedReportTest, StretchesKeepTheirExtremesInOrder) {
  const std::vector<double> values{1, 9, 3, -4, 5, 6, nan, nan, nan, 8};
  const auto kept = extremes(values, 3);
  EXPECT_EQ((std::vector<double>(kept.begin(), kept.begin() + 4)),
            (std::vector<double>{1, 9, -4, 6}));
  EXPECT_TRUE(std::isnan(kept[4]) && std::isnan(kept[5]));
  EXPECT_EQ(kept[6], 8.0);
  EXPECT_EQ(quarters(std::vector<double>{0, 1, 2, 3, 4}, 4), (std::vector<double>{1, 3, 4, 4}));
}

TEST(PackedReportTest, ALongSeriesIsThinnedWithItsExtremes) {
  const auto data = nlohmann::json::parse(page_data({long_figure(1'000'000)}));
  const auto& series = data["plots"][0]["panels"][0]["series"][0];
  const auto& y = data["arrays"][series["y"].get<std::size_t>()];
  const std::size_t count = y["count"];
  EXPECT_LE(count, 400'001U);
  EXPECT_GT(count, 390'000U);
  EXPECT_EQ(series["stretch"], 5);
  const auto values = unpacked(y["packed"], count);
  // The largest code is the largest value, to rounding.
  EXPECT_NEAR(*std::max_element(values.begin(), values.end()), 7.0, 1e-12);
}

TEST(PackedReportTest, AShortSeriesIsHeldWholeAndOnce) {
  Figure first = long_figure(500);
  Figure second = first;
  first.group = second.group = "both";
  const std::string text = page_data({first, second, long_figure(400)});
  EXPECT_EQ(text.find('<'), std::string::npos);
  const auto data = nlohmann::json::parse(text);
  EXPECT_EQ(data["arrays"].size(), 4U);
  EXPECT_EQ(data["arrays"][0].size(), 500U);
  ASSERT_EQ(data["plots"].size(), 2U);
  EXPECT_EQ(data["plots"][0]["panels"].size(), 2U);
}

} // namespace
} // namespace goingrate
