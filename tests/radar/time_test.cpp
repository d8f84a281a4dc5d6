#include "radar/time.hpp"

#include <gtest/gtest.h>

namespace dwell {
namespace {

TEST(Time, WholeNanosecondsAreExact) {
  EXPECT_EQ(from_seconds(1e-9).count(), 1);
  EXPECT_EQ(from_seconds(0.1).count(), 100'000'000);
  EXPECT_EQ(from_seconds(-2.5).count(), -2'500'000'000);
  EXPECT_EQ(from_seconds(8e9).count(), 8'000'000'000'000'000'000);
}

TEST(Time, RoundsToTheNearestNanosecond) {
  EXPECT_EQ(from_seconds(1.4e-9).count(), 1);
  EXPECT_EQ(from_seconds(1.6e-9).count(), 2);
  EXPECT_EQ(from_seconds(-1.6e-9).count(), -2);
}

// Ten million scans of 0.1 s end at 1e6 s to the nanosecond; a double accumulated the same way is off by 1e-4
// s.
TEST(Time, ScansAddUpExactly) {
  TimePoint time = kStreamStart;
  for (int scan = 0; scan < 10'000'000; ++scan) time += from_seconds(0.1);
  EXPECT_EQ(time, kStreamStart + from_seconds(1e6));
}

// A double of 1.5e9 s has steps of 2.4e-7 s; a quarter of a second is one of its values.
TEST(Time, UnixTimesKeepTheirFraction) {
  EXPECT_EQ(from_seconds(1527693700.25).count(), 1'527'693'700'250'000'000);
  EXPECT_EQ(from_seconds(-1527693700.25).count(), -1'527'693'700'250'000'000);
}

TEST(Time, SecondsRoundTrip) {
  for (const double seconds : {0.0, 1e-9, 0.1, 1.0 / 3.0, 86400.0, 1.6e9}) {
    EXPECT_NEAR(to_seconds(from_seconds(seconds)), seconds, 0.5e-9 + 3e-16 * seconds);
  }
}

TEST(Time, MillisecondsComeBackAsTheSameDouble) {
  for (int milliseconds = 0; milliseconds < 100'000; ++milliseconds) {
    EXPECT_EQ(to_seconds(from_seconds(milliseconds / 1000.0)), milliseconds / 1000.0);
  }
}

}  // namespace
}  // namespace dwell
