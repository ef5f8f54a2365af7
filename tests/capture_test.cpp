// Statistics of repeated measurements against values worked out by hand.
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

#include "capture/statistics.h"

namespace nf::capture {
namespace {

std::vector<double> count_to(size_t n) {
  std::vector<double> values(n);
  std::iota(values.begin(), values.end(), 1.0);
  return values;
}

// The worked example of the nearest-rank method: 15 20 35 40 50.
TEST(StatisticsTest, NearestRankByHand) {
  const std::vector<double> five = {15, 20, 35, 40, 50};
  EXPECT_EQ(nearest_rank(five, 0), 15);
  EXPECT_EQ(nearest_rank(five, 5), 15);
  EXPECT_EQ(nearest_rank(five, 20), 15);
  EXPECT_EQ(nearest_rank(five, 20.001), 20);
  EXPECT_EQ(nearest_rank(five, 30), 20);
  EXPECT_EQ(nearest_rank(five, 40), 20);
  EXPECT_EQ(nearest_rank(five, 50), 35);
  EXPECT_EQ(nearest_rank(five, 95), 50);
  EXPECT_EQ(nearest_rank(five, 100), 50);
  EXPECT_EQ(nearest_rank({7}, 0), 7);
  EXPECT_EQ(nearest_rank({7}, 100), 7);
}

// Rounding must not push a percentage that falls on a sample exactly to the next one.
TEST(StatisticsTest, NearestRankIsExactForWholePercentages) {
  for (size_t n = 1; n <= 400; ++n) {
    const std::vector<double> values = count_to(n);
    for (size_t percent = 0; percent <= 100; ++percent) {
      const size_t rank = std::max<size_t>((percent * n + 99) / 100, 1);
      ASSERT_EQ(nearest_rank(values, double(percent)), double(rank)) << percent << " % of " << n;
    }
  }
}

TEST(StatisticsDeathTest, NearestRankRefusesNonsense) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(nearest_rank({}, 50), "0 samples");
  EXPECT_DEATH(nearest_rank({1}, 101), "101 %");
}

// Sorted 1 2 3 4 5 7 9 17: mean 6, squared deviations 25 16 9 4 1 1 9 121 = 186; median 4 (rank 4 of 8);
// distances from it 3 2 1 0 1 3 5 13, sorted 0 1 1 2 3 3 5 13, their rank 4 is 2.
TEST(StatisticsTest, EightSamplesInAnyOrder) {
  const Statistics s = statistics({9, 1, 17, 4, 2, 7, 3, 5});
  EXPECT_EQ(s.count, 8u);
  EXPECT_EQ(s.min, 1);
  EXPECT_EQ(s.max, 17);
  EXPECT_EQ(s.median, 4);
  EXPECT_EQ(s.p95, 17);
  EXPECT_EQ(s.p99, 17);
  EXPECT_DOUBLE_EQ(s.mean, 6);
  EXPECT_DOUBLE_EQ(s.stddev, std::sqrt(186.0 / 7));
  EXPECT_EQ(s.mad, 2);
}

TEST(StatisticsTest, PercentilesOfTwoHundred) {
  const Statistics s = statistics(count_to(200));
  EXPECT_EQ(s.median, 100);
  EXPECT_EQ(s.p95, 190);
  EXPECT_EQ(s.p99, 198);
  EXPECT_DOUBLE_EQ(s.mean, 100.5);
  EXPECT_EQ(s.mad, 50);
}

// One wild sample moves the mean and the deviation, not the median and the MAD.
TEST(StatisticsTest, MadIsRobust) {
  const Statistics s = statistics({2, 2, 2, 3, 3, 3, 3, 4, 4, 1000});
  EXPECT_EQ(s.median, 3);
  EXPECT_EQ(s.mad, 1);
  EXPECT_GT(s.stddev, 300);
}

TEST(StatisticsTest, OneSample) {
  const Statistics s = statistics({2.5});
  EXPECT_EQ(s.count, 1u);
  for (const double value : {s.min, s.median, s.p95, s.p99, s.max, s.mean}) EXPECT_EQ(value, 2.5);
  EXPECT_EQ(s.stddev, 0);
  EXPECT_EQ(s.mad, 0);
}

TEST(StatisticsTest, NoSample) {
  const Statistics s = statistics({});
  EXPECT_EQ(s.count, 0u);
  for (const double value : {s.min, s.median, s.p95, s.p99, s.max, s.mean, s.stddev, s.mad}) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace nf::capture
