// SPDX-License-Identifier: Apache-2.0
// Names and texts that strangers chose, in every place of a report: they are read, and do nothing. Fault N6.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "sample_reports.h"
#include "trocar/host/safe_file.h"
#include "trocar/report/rating.h"
#include "trocar/report/report_files.h"
#include "trocar/report/trainee_report.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::report {
namespace {

// an action that shows in the document where it runs
constexpr const char* kAction = "document.documentElement.setAttribute(`data-ran`,`1`)";

/// 240 payloads: twenty ways to run something, each in twelve ways out of the place it stands in.
std::vector<std::string> MakePayloads() {
  const std::string action = kAction;
  const std::vector<std::string> bodies = {
      "<script>" + action + "</script>",
      "<ScRiPt >" + action + "</sCrIpT>",
      "<script/x>" + action + "</script/x>",
      "<img src=x onerror=" + action + ">",
      "<img/src/onerror=" + action + "//>",
      "<svg onload=" + action + ">",
      "<svg><script>" + action + "</script></svg>",
      "<svg><animate onbegin=" + action + " attributeName=x dur=1s>",
      "<body onload=" + action + ">",
      "<iframe srcdoc='<script>parent." + action + "</script>'></iframe>",
      "<iframe src=\"javascript:parent." + action + "\"></iframe>",
      "<a href=\"javascript:" + action + "\" autofocus onfocus=" + action + ">x</a>",
      "<input autofocus onfocus=" + action + ">",
      "<details open ontoggle=" + action + "><summary>x</summary></details>",
      "<video><source onerror=" + action + "></video>",
      "<math><mtext><table><mglyph><style><img src=x onerror=" + action + ">",
      "<object data=\"javascript:" + action + "\"></object>",
      "<meta http-equiv=refresh content=\"0;url=javascript:" + action + "\">",
      "<style>@import 'javascript:" + action + "';</style>",
      "<base href=\"javascript:/" + action + "//\">"};
  const std::vector<std::string> ways_out = {"",
                                             "\">",
                                             "'>",
                                             "</title>",
                                             "</desc></svg>",
                                             "</style>",
                                             "-->",
                                             "]]>",
                                             "</td></table>",
                                             "&quot;>",
                                             std::string("\0", 1) + "\">",
                                             "\xff\xc0\x80\">"};
  std::vector<std::string> payloads;
  for (const std::string& body : bodies) {
    for (const std::string& way : ways_out) payloads.push_back(way + body);
  }
  return payloads;
}

/// Every text of an attempt that somebody chose.
AttemptReport Fill(AttemptReport report, const std::string& text) {
  AttemptFacts& facts = report.facts;
  for (std::string* one : {&facts.person, &facts.task, &facts.task_key, &facts.level, &facts.patient,
                           &facts.started, &facts.player, &facts.program, &facts.recording, &report.outcome})
    *one = text;
  for (GoalRow& goal : report.goals) goal.name = text;
  for (ErrorRow& error : report.errors) error.what = error.where = text;
  for (training::PhaseSpan& phase : report.phases) phase.name = text;
  for (Advice& advice : report.advice)
    advice.sentence = advice.why = advice.exercise = advice.practise = text;
  for (MetricRow& row : report.metrics) row.name = row.about = row.unit = text;
  report.group = GroupFacts{text, 7, report.is_operation ? text : ""};
  report.doublet = DoubletView{"p", "q", 1, 2, text};
  report.pictures = {{"p", text}};
  report.origin = {{text, text}};
  return report;
}

TraineeReport FillTrainee(const std::string& text) {
  TraineeReport trainee;
  trainee.person = trainee.program = trainee.from = trainee.until = text;
  trainee.attempts = {{text, text, text, text, text, true, true, 1.0, 1, 0, 0}};
  trainee.curves = {{text, text, text, {3, 2, 1}, CurveFit{1, 2, 1}, 1.0}};
  trainee.cusums = {{text, {0.1, 0.2}, -1, 1, text}};
  trainee.practise = {{text, text, 2}};
  return trainee;
}

/// The tags of a page with the names of their attributes, without their texts: what a browser would build.
std::string CalcSkeleton(const std::string& page) {
  std::string skeleton;
  bool is_tag = false, is_quoted = false, is_style = false;
  for (std::size_t i = 0; i < page.size(); ++i) {
    const char c = page[i];
    if (is_style) {
      if (page.compare(i, 8, "</style>") != 0) continue;
      is_style = false;
    }
    if (!is_tag && c == '<') {
      is_tag = true;
      is_style = false;
    }
    if (is_tag && c == '"') is_quoted = !is_quoted;
    if (is_tag && !is_quoted) skeleton += c;
    if (is_tag && !is_quoted && c == '>') {
      is_tag = false;
      is_style = skeleton.size() >= 7 && skeleton.compare(skeleton.size() - 7, 7, "<style>") == 0;
    }
  }
  return skeleton;
}

TEST(HostileText, ChangesNoTagOfAPage) {
  const std::vector<std::string> payloads = MakePayloads();
  ASSERT_GE(payloads.size(), 200u);
  AttemptReport sample = test::MakeOperationReport();
  sample.goals = {{"", 1.0}};
  // a few rows of every table will do
  sample.metrics.resize(40);
  for (HandSeries& hand : sample.hands) hand = {};
  const std::string attempt = CalcSkeleton(FormatHtml(MakeDocument(Fill(sample, "harmless"))));
  const std::string trainee = CalcSkeleton(FormatHtml(MakeDocument(FillTrainee("harmless"))));
  EXPECT_NE(CalcSkeleton("<p>a<script>b</script></p>"), CalcSkeleton("<p>a</p>")) << "the test can tell";
  for (const std::string& payload : payloads) {
    const std::string skeleton = CalcSkeleton(FormatHtml(MakeDocument(Fill(sample, payload))));
    // a label in a drawing is left out where it has no room
    const auto strip_labels = [](std::string text) {
      for (std::size_t at = text.find("<text"); at != std::string::npos; at = text.find("<text", at))
        text.erase(at, text.find("</text>", at) + 7 - at);
      return text;
    };
    EXPECT_EQ(strip_labels(skeleton), strip_labels(attempt)) << payload;
    EXPECT_EQ(CalcSkeleton(FormatHtml(MakeDocument(FillTrainee(payload)))), trainee) << payload;
  }
}

TEST(HostileText, IsStillReadable) {
  const std::string page =
      FormatHtml(MakeDocument(Fill(test::MakeTaskReport(), "<b>O'Neill & \"Sons\"</b>\xe2\x80\xae txt")));
  EXPECT_THAT(page, testing::HasSubstr("&lt;b&gt;O&#39;Neill &amp; &quot;Sons&quot;&lt;/b&gt;\\u{202E} txt"));
}

TEST(HostileText, IsDrawnInPdf) {
  AttemptReport sample = test::MakeTaskReport();
  sample.metrics.resize(8);  // long texts take many pages
  for (const std::string& payload :
       {std::string("\xff\xfe"), std::string("a\0b", 3), std::string(5000, 'W'), std::string("\xe2\x80\xae")})
    EXPECT_EQ(FormatPdf(MakeDocument(Fill(sample, payload))).substr(0, 5), "%PDF-");
}

TEST(HostileText, IsNoFormulaInASpreadsheet) {
  AttemptReport report = test::MakeTaskReport();
  for (const char* text : {"=HYPERLINK(\"x\")", "+1", "-1", "@SUM(A1)"}) {
    report.facts.person = text;
    const std::string csv = FormatCsv(report);
    const std::string line = csv.substr(csv.find('\n') + 1);
    EXPECT_TRUE(line[0] == '\'' || line.substr(0, 2) == "\"'") << line.substr(0, 40);
  }
}

/// What a browser makes of a page; empty without one. The policy is taken out, so that only the escaping protects.
std::string Render(const std::string& page) {
  const std::string browser = TROCAR_CHROMIUM_PROGRAM;
  if (browser.empty()) return "";
  trocar::test::TemporaryFolder folder;
  std::string unprotected = page;
  const std::size_t policy = unprotected.find("<meta http-equiv=\"Content-Security-Policy\"");
  if (policy != std::string::npos) unprotected.erase(policy, unprotected.find('>', policy) + 1 - policy);
  const auto file = folder.Path() / "page.html";
  if (!host::WriteFile(file, unprotected).ok()) return "";
  const std::string command = "HOME='" + folder.Path().string() + "' timeout 60 '" + browser +
                              "' --headless --no-sandbox --disable-gpu --disable-dev-shm-usage "
                              "--virtual-time-budget=2000 --user-data-dir='" +
                              folder.Path().string() + "/profile' --dump-dom 'file://" + file.string() +
                              "' 2>/dev/null";
  std::string dom;
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return "";
  std::array<char, 65536> buffer;
  for (std::size_t read = 0; (read = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    dom.append(buffer.data(), read);
  ::pclose(pipe);
  return dom;
}

TEST(HostileText, RunsNothingInABrowser) {
  if (std::string(TROCAR_CHROMIUM_PROGRAM).empty()) GTEST_SKIP() << "Chromium is not installed";
  // the control: unescaped, it runs
  const std::string control =
      Render("<!DOCTYPE html><html><body><img src=x onerror=" + std::string(kAction) + "></body></html>");
  if (control.find("<html") == std::string::npos) GTEST_SKIP() << "Chromium does not start here";
  ASSERT_THAT(control, testing::HasSubstr("data-ran"));
  // every payload in one page of attempts, and in one of advice
  TraineeReport trainee = FillTrainee("x");
  const std::vector<std::string> payloads = MakePayloads();
  for (const std::string& payload : payloads) {
    const AttemptRow row = FillTrainee(payload).attempts[0];
    trainee.attempts.push_back(row);
    trainee.practise.push_back({payload, payload, 1});
    trainee.curves.push_back({payload, payload, payload, {3, 2, 1}, {}, {}});
  }
  const std::string dom = Render(FormatHtml(MakeDocument(trainee)));
  ASSERT_THAT(dom, testing::HasSubstr("<main>"));
  EXPECT_EQ(dom.find("data-ran=\"1\""), std::string::npos);
  EXPECT_EQ(dom.find("<script"), std::string::npos);
  EXPECT_EQ(dom.find("<iframe"), std::string::npos);
}

}  // namespace
}  // namespace trocar::report
