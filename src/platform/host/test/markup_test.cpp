// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/markup.h"

#include <gtest/gtest.h>

namespace trocar::host {
namespace {

TEST(EscapeMarkup, ReplacesWhatMarkupUses) {
  EXPECT_EQ(EscapeMarkup("<script>\"a\" & 'b'</script>"),
            "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39;&lt;/script&gt;");
}

TEST(EscapeMarkup, LeavesEverythingElse) {
  EXPECT_EQ(EscapeMarkup(""), "");
  EXPECT_EQ(EscapeMarkup("Gallenblase, 12 mm\n#;/"), "Gallenblase, 12 mm\n#;/");
  EXPECT_EQ(EscapeMarkup("L\xC3\xBC"
                         "beck \xE2\x89\xA4 3"),
            "L\xC3\xBC"
            "beck \xE2\x89\xA4 3");
  EXPECT_EQ(EscapeMarkup("&amp;"), "&amp;amp;") << "what is escaped already is text like any other";
}

TEST(EscapeMarkup, ShowsWhatXmlDoesNotAllowAndWhatTurnsTheText) {
  EXPECT_EQ(EscapeMarkup(std::string("\0\x1b", 2)), "\\x00\\x1B");
  EXPECT_EQ(EscapeMarkup("a\xff"), "a\\xFF");
  EXPECT_EQ(EscapeMarkup("\u202egnp"), "\\u202egnp");
}

}  // namespace
}  // namespace trocar::host
