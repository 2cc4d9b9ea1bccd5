// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/printable_output.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "trocar/host/console.h"
#include "trocar/host/json_text.h"
#include "trocar/host/log.h"
#include "trocar/host/text_table.h"

namespace trocar::host {
namespace {

constexpr const char* kClear = "\x1b[2J\x1b[1;1H\x1b[32mVERIFIED\x1b[0m";

bool IsPlain(const std::string& text) {
  return PrintableText(text) == text;
}

TEST(PrintableText, ShowsWhatSteersATerminalAndKeepsTheRest) {
  EXPECT_EQ(PrintableText("\x1b[2J"), "\\x1B[2J");
  EXPECT_EQ(PrintableText("a\rb\x07\b\x7f"), "a\\x0Db\\x07\\x08\\u007f");
  EXPECT_EQ(PrintableText("\u009b2J"), "\\u009b2J") << "C1";
  EXPECT_EQ(PrintableText("\u202egnp\u2066"), "\\u202egnp\\u2066") << "bidi";
  EXPECT_EQ(PrintableText("\U000E0041"), "\\udb40\\udc41") << "tags";
  EXPECT_EQ(PrintableText("\x9b\xff\xc3"), "\\x9B\\xFF\\xC3") << "no UTF-8";
  EXPECT_EQ(PrintableText(std::string("\0x", 2)), "\\x00x");
  const std::string good = "vesícula \"日本\" 🫀 \t col\nline\n";
  EXPECT_EQ(PrintableText(good), good);
  EXPECT_EQ(PrintableLine("a\nVERIFIED\tb"), "a\\x0AVERIFIED\\x09b");
  const std::string once = PrintableText(kClear);
  EXPECT_EQ(PrintableText(once), once) << "twice does no more";
}

TEST(PrintableText, LeavesJsonTheSameText) {
  const nlohmann::json json = {{"name", "\x1b[2J \u009b \u202e \U000E0041 \x7f é"}};
  const std::string shown = PrintableText(json.dump());
  EXPECT_TRUE(IsPlain(shown));
  EXPECT_EQ(nlohmann::json::parse(shown), json);
}

TEST(FormatJson, WritesBytesThatAreNoUtf8) {
  const nlohmann::json json = {{"name", "a\xff\xc0\"\n"}};
  EXPECT_THROW((void)json.dump(), nlohmann::json::exception) << "the control";
  EXPECT_EQ(nlohmann::json::parse(FormatJson(json, 2))["name"], "a\ufffd\ufffd\"\n");
  EXPECT_EQ(QuoteJson("a\"\\\xff\x1b"), "\"a\\\"\\\\\ufffd\\u001b\"");
}

/// What `print` brings to descriptors 1 and 2 through the fence.
template <typename Print>
std::string Captured(Print&& print) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  {
    const PrintableOutput fence;
    print();
  }
  const std::string out = testing::internal::GetCapturedStdout();
  return out + testing::internal::GetCapturedStderr();
}

TEST(PrintableOutput, StandsBeforeEveryWayToTheTerminal) {
  const std::string hostile = kClear;
  const std::string all = Captured([&] {
    std::printf("1%s\n", hostile.c_str());
    std::fprintf(stderr, "2%s\n", hostile.c_str());
    std::fputs(hostile.c_str(), stdout);
    std::puts(hostile.c_str());
    std::fwrite(hostile.data(), 1, hostile.size(), stderr);
    std::cout << "3" << hostile << std::endl;
    std::cerr << "4" << hostile;
    std::clog << "5" << hostile;
    Print("6" + hostile);
    Say("{1}\n", hostile);
    PrintTable({{"hand"}, {hostile}});
    Log(LogLevel::kError, "7" + hostile);
  });
  EXPECT_TRUE(IsPlain(all)) << PrintableText(all);
  std::size_t count = 0;
  for (std::size_t at = all.find("\\x1B[2J"); at != std::string::npos; at = all.find("\\x1B[2J", at + 1))
    ++count;
  EXPECT_EQ(count, 12u) << "each is shown";
  // the control: without the fence it would come through
  testing::internal::CaptureStdout();
  std::fputs(hostile.c_str(), stdout);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), hostile);
}

TEST(PrintableOutput, MindsLettersThatComeInPieces) {
  const std::string good = "vesícula 日本 🫀\n";
  EXPECT_EQ(Captured([&] {
              for (const char byte : good) {
                std::fputc(byte, stdout);
                std::fflush(stdout);
              }
            }),
            good);
  EXPECT_EQ(Captured([] { std::fputs("cut \xF0\x9F", stdout); }), "cut \\xF0\\x9F");
  EXPECT_EQ(Captured([] {
              std::fputc('\xc2', stdout);
              std::fflush(stdout);
              std::fputs(
                  "\x9b"
                  "2J",
                  stdout);
            }),
            "\\u009b2J");
  const std::string large(300'000, 'x');
  EXPECT_EQ(Captured([&] { std::fputs(large.c_str(), stdout); }), large);
}

TEST(PrintableOutput, LetsOurOwnSequencesThroughInTheirPlace) {
  EXPECT_EQ(Captured([] {
              std::fputs("before ", stdout);
              WriteControl(stdout, "\r\033[K");
              std::fputs("behind \x1b[K", stdout);
            }),
            "before \r\033[Kbehind \\x1B[K");
}

TEST(PrintableOutput, TellsOfAFullDisk) {
  const int kept = ::dup(STDOUT_FILENO);
  std::fflush(stdout);
  std::FILE* full = std::fopen("/dev/full", "w");
  ASSERT_NE(full, nullptr);
  ::dup2(::fileno(full), STDOUT_FILENO);
  bool is_told = false;
  {
    const PrintableOutput fence;
    std::fputs("something\n", stdout);
    is_told = std::fflush(stdout) != 0 && std::ferror(stdout) != 0;
  }
  ::dup2(kept, STDOUT_FILENO);
  ::close(kept);
  std::fclose(full);
  EXPECT_TRUE(is_told);
}

TEST(FormatTable, KeepsACellWithinItsLine) {
  const std::string table = FormatTable({{"name", "1"}, {"x\nVERIFIED", "2"}});
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 2);
  EXPECT_EQ(SaidText("{1}", {"x\nVERIFIED"}), "x\\x0AVERIFIED");
}

}  // namespace
}  // namespace trocar::host
