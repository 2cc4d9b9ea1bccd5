// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "page_style.h"
#include "sample_reports.h"
#include "trocar/report/document.h"
#include "trocar/report/trainee_report.h"

namespace trocar::report {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t Count(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + word.size()))
    ++count;
  return count;
}

std::string MakePage() {
  AttemptReport report = test::MakeOperationReport();
  report.doublet = DoubletView{"\x89PNG front", "\x89PNG back", 93.6, 121.2, "Three criteria, both views."};
  return FormatHtml(MakeDocument(report));
}

/// Names of the attributes of all tags.
std::set<std::string> ListAttributes(const std::string& page) {
  std::set<std::string> names;
  bool is_tag = false, is_quoted = false;
  std::string word;
  for (const char c : page) {
    if (!is_tag) {
      is_tag = c == '<';
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted) {
      if (c == '=') names.insert(word);
      word = c == ' ' || c == '>' || c == '=' ? "" : word + c;
      is_tag = c != '>';
    }
  }
  return names;
}

// RFC 4648, section 10.
TEST(EncodeBase64, AgreesWithTheStandardsVectors) {
  EXPECT_EQ(EncodeBase64(""), "");
  EXPECT_EQ(EncodeBase64("f"), "Zg==");
  EXPECT_EQ(EncodeBase64("fo"), "Zm8=");
  EXPECT_EQ(EncodeBase64("foo"), "Zm9v");
  EXPECT_EQ(EncodeBase64("foob"), "Zm9vYg==");
  EXPECT_EQ(EncodeBase64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(EncodeBase64("\xff\xff\xff"), "////");
}

TEST(Page, NeedsNoNetworkAndRunsNothing) {
  const std::string page = MakePage();
  for (const char* word : {"http://", "https://", "<script", "<link", "@import", "url(", "<iframe",
                           "javascript:", " style=", "<object"})
    EXPECT_THAT(page, Not(HasSubstr(word)));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  for (const std::string& name : ListAttributes(page)) EXPECT_NE(name.substr(0, 2), "on") << name;
}

TEST(Page, ItsPolicyAllowsItsOwnStyleAndNoOther) {
  const std::string page = MakePage();
  std::smatch hash;
  ASSERT_TRUE(std::regex_search(page, hash, std::regex("style-src 'sha256-([A-Za-z0-9+/=]{44})'")));
  const std::size_t begin = page.find("<style>") + 7, end = page.find("</style>");
  EXPECT_EQ(page.substr(begin, end - begin), FormatPageStyle());
  EXPECT_EQ(Count(page, "<style"), 1u);
  EXPECT_THAT(page, Not(HasSubstr("unsafe")));
}

TEST(Page, CanBeReadWithoutSeeingIt) {
  const std::string page = MakePage();
  EXPECT_THAT(page, HasSubstr("<html lang=\"en\">"));
  EXPECT_EQ(Count(page, "<h1>"), 1u);
  EXPECT_EQ(Count(page, "<section aria-labelledby="), Count(page, "<h2 id="));
  EXPECT_EQ(Count(page, "<svg role=\"img\""), Count(page, "<desc id="));
  EXPECT_EQ(Count(page, "<table>"), Count(page, "<caption>"));
  EXPECT_EQ(Count(page, "<img "), Count(page, "<img alt=\""));
  EXPECT_GT(Count(page, "<th scope=\"col\""), 10u);
  EXPECT_EQ(Count(page, "<tbody>"), Count(page, "<table>"));
  // every id once, and each that is referred to is there
  std::set<std::string> ids;
  const std::regex id(" id=\"([^\"]*)\"");
  for (auto it = std::sregex_iterator(page.begin(), page.end(), id); it != std::sregex_iterator(); ++it)
    EXPECT_TRUE(ids.insert((*it)[1]).second) << (*it)[1];
  const std::regex labelled("aria-labelledby=\"([^\"]*)\"");
  for (auto it = std::sregex_iterator(page.begin(), page.end(), labelled); it != std::sregex_iterator();
       ++it) {
    const std::string names = (*it)[1];
    const std::size_t space = names.find(' ');
    EXPECT_TRUE(ids.count(names.substr(0, space)) == 1) << names;
    if (space != std::string::npos) {
      EXPECT_TRUE(ids.count(names.substr(space + 1)) == 1) << names;
    }
  }
}

TEST(Page, IsTheSameEachTime) {
  EXPECT_EQ(MakePage(), MakePage());
}

TEST(Page, HasThePicturesInItself) {
  EXPECT_THAT(MakePage(), HasSubstr("src=\"data:image/png;base64,iVBORyBmcm9udA==\""));
}

TEST(Page, ANameOfAFilmIsNoAddress) {
  AttemptReport report = test::MakeTaskReport();
  report.film = "javascript:alert(1)//.webm";
  const std::string page = FormatHtml(MakeDocument(report));
  EXPECT_THAT(page, HasSubstr("href=\"./javascript:"));
  EXPECT_THAT(page, HasSubstr("media-src 'self' file:"));
  EXPECT_THAT(MakePage(), Not(HasSubstr("media-src")));
}

TEST(PageStyle, KnowsBothGroundsAndPaper) {
  const std::string style = FormatPageStyle();
  EXPECT_THAT(style, HasSubstr("prefers-color-scheme: dark"));
  EXPECT_THAT(style, HasSubstr("@media print"));
  EXPECT_THAT(style, HasSubstr("@page"));
  EXPECT_THAT(style, HasSubstr(".l-left { stroke: var(--left)"));
}

}  // namespace
}  // namespace trocar::report
