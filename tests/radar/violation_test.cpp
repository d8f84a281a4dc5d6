#include "radar/violation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dwell {
namespace {

TEST(Violation, SaysWhereWhatWhichValueAndWhichRule) {
  EXPECT_EQ(to_string("radars.textproto", {"beamwidth_deg", "0", "must be over 0", 12, 3}),
            "radars.textproto:12:3: beamwidth_deg = 0: must be over 0");
}

TEST(Violation, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ(to_string("f.csv", {"lat", "91", "too large", 4, 0}), "f.csv:4: lat = 91: too large");
  EXPECT_EQ(to_string("f.csv", {"lat", "91", "too large", 0, 7}), "f.csv: lat = 91: too large");
  EXPECT_EQ(to_string("", {"lat", "91", "too large", 0, 0}), "lat = 91: too large");
  EXPECT_EQ(to_string("", {"", "", "is empty", 0, 0}), ": is empty");
  EXPECT_EQ(to_string("f.csv", {"radar", "", "is required", 0, 0}), "f.csv: radar: is required");
}

TEST(InvalidInput, ListsEveryViolationOneALine) {
  const InvalidInput error("f.csv", {{"lat", "91", "too large", 4, 0}, {"lon", "x", "not a number", 9, 0}});
  EXPECT_STREQ(error.what(), "f.csv:4: lat = 91: too large\nf.csv:9: lon = x: not a number");
  EXPECT_EQ(error.source(), "f.csv");
  ASSERT_EQ(error.violations().size(), 2U);
  EXPECT_EQ(error.violations()[1].field, "lon");
}

TEST(InvalidInput, IsARuntimeError) {
  const auto refuse = [] { throw InvalidInput("f.csv", {{"file", "", "is empty", 0, 0}}); };
  EXPECT_THROW(refuse(), std::runtime_error);
}

}  // namespace
}  // namespace dwell
