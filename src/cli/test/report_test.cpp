// SPDX-License-Identifier: Apache-2.0
#include "report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "trocar/training/metric_definition.h"

namespace trocar::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

ReportContent MakeContent() {
  ReportContent content;
  content.scene = "First <look>";
  content.patient = "Test & patient";
  content.seed = 7;
  content.hash = "0123456789abcdef";
  content.ticks = 240;
  content.tick_seconds = 1.0 / 120;
  content.version = "0.1.0";
  content.video = "demo.webm";
  content.pictures = {{"at 1 s", "\x89PNG"}};
  content.metrics.values = {{"time", "", "", 2.0, ""}, {"path_length", "left", "", 0.123, ""}};
  content.times = {0, 1, 2};
  content.hands = {{"left", {0, 1, 2}, {{0, 0, 0}, {0.01, 0, 0}, {0.02, 0.01, 0}}}, {"right", {0, 0, 0}, {}}};
  return content;
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

TEST(FormatReportPage, HoldsWhatAPersonAsksFor) {
  const std::string page = FormatReportPage(MakeContent());
  EXPECT_THAT(page, HasSubstr("training feedback, not certified assessment"));
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,iVBORw=="));
  EXPECT_THAT(page, HasSubstr("<video controls"));
  EXPECT_THAT(page, HasSubstr("0123456789abcdef"));
  EXPECT_THAT(page, HasSubstr("Force of the tissue"));
  EXPECT_THAT(page, HasSubstr("Path length"));
  EXPECT_THAT(page, HasSubstr("<td class=\"number\">123</td>"));  // 0.123 m in mm
}

TEST(FormatReportPage, EveryMetricStandsInIt) {
  const std::string page = FormatReportPage(MakeContent());
  for (const auto& definition : training::MetricDefinitions()) {
    EXPECT_THAT(page, HasSubstr("<td>" + definition.name));
  }
}

TEST(FormatReportPage, EscapesNamesAndNeedsNoNetwork) {
  const std::string page = FormatReportPage(MakeContent());
  EXPECT_THAT(page, HasSubstr("First &lt;look&gt;"));
  EXPECT_THAT(page, HasSubstr("Test &amp; patient"));
  EXPECT_THAT(page, Not(HasSubstr("http://")));
  EXPECT_THAT(page, Not(HasSubstr("https://")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

}  // namespace
}  // namespace trocar::cli
