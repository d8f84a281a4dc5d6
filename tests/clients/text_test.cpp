#include <gtest/gtest.h>

#include <limits>

#include "clients/table.hpp"
#include "clients/text.hpp"

namespace dwell::client {
namespace {

TEST(Text, ControlCharactersDoNotReachTheTerminal) {
  EXPECT_EQ(printable("a\x1b[31mb\n\x7f"), "a?[31mb??");
  EXPECT_EQ(printable("c1 \xc2\x9b, right-to-left \xe2\x80\xae"), "c1 ?, right-to-left ?");
  EXPECT_EQ(printable("cut short \xe2\x82"), "cut short ??");
  EXPECT_EQ(printable("zürich 東京 𝛑"), "zürich 東京 𝛑");
}

TEST(Text, WidthCountsCellsNotBytes) {
  EXPECT_EQ(display_width("zürich"), 6);
  EXPECT_EQ(display_width("東京"), 4);
  EXPECT_EQ(display_width("u\xcc\x88"), 1);  // u and a combining diaeresis
  EXPECT_EQ(display_width(""), 0);
}

TEST(Text, ClipCutsBetweenCharacters) {
  EXPECT_EQ(clip("zürich", 2), "zü");
  EXPECT_EQ(clip("東京", 3), "東");
  EXPECT_EQ(clip("abc", 0), "");
  EXPECT_EQ(clip("abc", 9), "abc");
}

TEST(Text, NumbersThatAreNotFiniteAreDashes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(fixed(nan, 1) + fixed(infinity, 1) + general(nan) + general(-infinity), "----");
  EXPECT_EQ(fixed(-12.345, 1), "-12.3");
  EXPECT_LT(fixed(std::numeric_limits<double>::max(), 2).size(), 12u);
}

TEST(Text, WrapBreaksAtSpacesAndIndents) {
  const Lines lines = wrap("why  a look by west is best", 14, 5);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].text, "why  a look by");
  EXPECT_EQ(lines[1].text, "     west is");
  EXPECT_EQ(lines[2].text, "     best");
  EXPECT_EQ(wrap("a b", kUnlimited, 0).size(), 1u);
}

TEST(Text, PaintMarksOnlyWhereColourIsWanted) {
  EXPECT_EQ(paint({"lost", Mark::kAlarm}, 80, false), "lost");
  EXPECT_EQ(paint({"lost", Mark::kAlarm}, 2, true), "\x1b[31mlo\x1b[0m");
  EXPECT_EQ(paint({"fine"}, 80, true), "fine");
}

Table three_columns() {
  Table table({{"id", true, 0}, {"name", false, 1}, {"last", false, 2}});
  table.add({"7", "zürich", "x"});
  table.add({"12", "two", "longer"});
  return table;
}

TEST(Table, ColumnsAreAsWideAsTheirCells) {
  const Lines lines = three_columns().lines({}, "rows");
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].text, "id  name    last");
  EXPECT_EQ(lines[1].text, " 7  zürich  x");
  EXPECT_EQ(lines[2].text, "12  two     longer");
}

TEST(Table, ColumnsOfTheHighestRankGoFirst) {
  EXPECT_EQ(three_columns().lines({18, kUnlimited}, "rows")[0].text, "id  name    last");
  EXPECT_EQ(three_columns().lines({17, kUnlimited}, "rows")[0].text, "id  name");
  EXPECT_EQ(three_columns().lines({9, kUnlimited}, "rows")[0].text, "id");
  EXPECT_EQ(three_columns().lines({1, kUnlimited}, "rows")[0].text, "id");  // rank 0 stays
}

TEST(Table, RowsBeyondThePageAreCounted) {
  Table table({{"id", true, 0}});
  for (int i = 0; i < 100; ++i) table.add({"1"});
  const Lines lines = table.lines({80, 10}, "tracks");
  ASSERT_EQ(lines.size(), 10u);
  EXPECT_EQ(lines.back().text, "... 92 more tracks");
  EXPECT_EQ(table.lines({80, 101}, "tracks").size(), 101u);  // exactly full: nothing to count
  EXPECT_EQ(table.lines({}, "tracks").size(), 101u);
}

}  // namespace
}  // namespace dwell::client
