// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/printable.h"

#include <gtest/gtest.h>

namespace trocar::host {
namespace {

TEST(Printable, LeavesOrdinaryNamesAlone) {
  for (const char* name : {"", "image-0430.jpeg", "Brüste, 肝臓 #3.dcm", "a b'\"$`;"})
    EXPECT_EQ(Printable(name), name);
}

TEST(Printable, EscapesWhatWouldMisleadATerminal) {
  EXPECT_EQ(Printable("a\nb\x1b[31m\x7f"), "a\\x0Ab\\x1B[31m\\x7F");
  EXPECT_EQ(Printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(Printable("exe.\u202Egpj"), "exe.\\u{202E}gpj");
  EXPECT_EQ(Printable("\u2066x\u2069\u200F"), "\\u{2066}x\\u{2069}\\u{200F}");
}

TEST(Printable, EscapesWhatIsNoUtf8) {
  EXPECT_EQ(Printable("\xff"
                      "a"),
            "\\xFFa");
  EXPECT_EQ(Printable("\xc0\xaf"), "\\xC0\\xAF");           // overlong
  EXPECT_EQ(Printable("\xed\xa0\x80"), "\\xED\\xA0\\x80");  // surrogate
  EXPECT_EQ(Printable("\xe2\x82"), "\\xE2\\x82");           // cut
  EXPECT_EQ(Printable("\xf5\x80\x80\x80"), "\\xF5\\x80\\x80\\x80");
}

TEST(Printable, ShortensInTheMiddle) {
  const std::string text = std::string(200, 'a') + std::string(200, 'b');
  const std::string printed = Printable(text, 43);
  EXPECT_EQ(printed, std::string(20, 'a') + "..." + std::string(20, 'b'));
  EXPECT_EQ(Printable(std::string(300, '\n'), 16).size(), 12 * 4 + 3u);
}

}  // namespace
}  // namespace trocar::host
