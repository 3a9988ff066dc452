#include "base/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/timer.hpp"

namespace packmpi {
namespace {

TEST(Text, EditDistance) {
  EXPECT_EQ(text::edit_distance("", ""), 0U);
  EXPECT_EQ(text::edit_distance("", "abc"), 3U);
  EXPECT_EQ(text::edit_distance("abc", ""), 3U);
  EXPECT_EQ(text::edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(text::edit_distance("thickness", "thickenss"), 1U);  // two neighbours swapped
  EXPECT_EQ(text::edit_distance("sprread", "spread"), 1U);
  EXPECT_EQ(text::edit_distance("same", "same"), 0U);
}

TEST(Text, ClosestSuggestsOnlyWhatIsNear) {
  const std::vector<std::string> keys{"thickness", "fraction", "duration", "height", "r"};
  EXPECT_EQ(text::closest("thicknes", keys), "thickness");
  EXPECT_EQ(text::closest("fracton", keys), "fraction");
  EXPECT_EQ(text::closest("frattion", keys), "fraction");
  EXPECT_EQ(text::closest("gravity", keys), std::nullopt);
  EXPECT_EQ(text::closest("thickness", {}), std::nullopt);
  const std::vector<std::string> twins{"abcd", "abce"};
  EXPECT_EQ(text::closest("abcx", twins), "abcd");
}

TEST(Text, Durations) {
  EXPECT_EQ(text::duration(0.0), "0.00 s");
  EXPECT_EQ(text::duration(0.424), "0.42 s");
  EXPECT_EQ(text::duration(9.999), "10.0 s");
  EXPECT_EQ(text::duration(12.34), "12.3 s");
  EXPECT_EQ(text::duration(59.96), "1 min 00 s");
  EXPECT_EQ(text::duration(245.0), "4 min 05 s");
  EXPECT_EQ(text::duration(3599.9), "1 h 00 min");
  EXPECT_EQ(text::duration(11220.0), "3 h 07 min");
  EXPECT_EQ(text::duration(86400.0 * 2 + 3600.0 * 5), "2 d 05 h");
  EXPECT_EQ(text::duration(-1.0), "unknown");
  EXPECT_EQ(text::duration(std::nan("")), "unknown");
  EXPECT_EQ(text::duration(INFINITY), "unknown");
}

TEST(Text, Bytes) {
  EXPECT_EQ(text::bytes(0), "0 B");
  EXPECT_EQ(text::bytes(1023), "1023 B");
  EXPECT_EQ(text::bytes(1536), "1.5 KiB");
  EXPECT_EQ(text::bytes(1024 * 1024 - 1), "1.0 MiB");
  EXPECT_EQ(text::bytes(std::uint64_t{2} << 30U), "2.0 GiB");
  EXPECT_EQ(text::bytes(~std::uint64_t{0}), "16.0 EiB");
}

TEST(Timer, StopwatchRuns) {
  const Stopwatch watch;
  const double first = watch.seconds();
  while (watch.seconds() < first + 1e-3) {
  }
  EXPECT_GE(watch.seconds(), first + 1e-3);
}

}  // namespace
TEST(Trimmed, OfBlanksAndTabsAtItsEnds) {
  EXPECT_EQ(text::trimmed(" \ta b\t "), "a b");
  EXPECT_EQ(text::trimmed("a"), "a");
  EXPECT_EQ(text::trimmed(" \t"), "");
  EXPECT_EQ(text::trimmed(""), "");
}

TEST(Printable, KeepsLettersAndNothingThatATerminalObeys) {
  EXPECT_EQ(text::printable("a b, Größe, 東京, \U0001F600"), "a b, Größe, 東京, \U0001F600");
  EXPECT_EQ(text::printable("a\nb\tc\x1b[2J\x7f"), "a?b?c?[2J?");
  EXPECT_EQ(text::printable("\xc2\x9b"), "?") << "U+009B, the escape of one character";
  EXPECT_EQ(text::printable("a\u2028b\u202ec\u2066"), "a?b?c?") << "line end and directions";
  EXPECT_EQ(text::printable("\xff\xc3\x41\xe2\x82"), "??A??");
  EXPECT_EQ(text::printable("\xc0\xaf\xe0\x80\xaf\xed\xa0\x80\xf4\x90\x80\x80"), std::string(12, '?'))
      << "too long, surrogates, beyond Unicode";
}

TEST(Utf8, LengthOfTheFirstCharacter) {
  EXPECT_EQ(text::utf8_length("a"), 1U);
  EXPECT_EQ(text::utf8_length("é"), 2U);
  EXPECT_EQ(text::utf8_length("東"), 3U);
  EXPECT_EQ(text::utf8_length("\U0001F600"), 4U);
  EXPECT_EQ(text::utf8_length("\x80"), 0U);
  EXPECT_EQ(text::utf8_length("\xc3"), 0U);
}

}  // namespace packmpi
