// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "run_trocar.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

// What docs/exams.md shows, from the keys to the verification, and each way to cheat.
TEST(ExamCommand, SealsRunsCertifiesAndVerifies) {
  test::TemporaryFolder folder;
  const auto path = [&](const std::string& name) { return (folder.Path() / name).string(); };
  const auto run = [&](std::vector<std::string> words) {
    const Printed printed = RunTrocar(std::move(words));
    EXPECT_EQ(printed.status, 0) << printed.out << printed.err;
    return printed;
  };
  const auto refuse = [&](const char* code, std::vector<std::string> words) {
    const Printed printed = RunTrocar(std::move(words));
    EXPECT_EQ(printed.status, 1) << printed.out;
    EXPECT_NE(printed.err.find(code), std::string::npos) << printed.err;
  };
  run({"certificate", "keygen", "-o", path("centre")});
  run({"certificate", "keygen", "-o", path("other")});
  run({"exam", "seal", "--task", "instrument_navigation", "--name", "Finals", "--thresholds",
       "instrument_navigation-normal", "-o", path("finals.json")});
  run({"exam", "run", path("finals.json"), "--surgeon", "expert", "--record", path("7.trocar")});
  run({"certificate", "issue", path("finals.json"), path("7.trocar"), "--examinee", "trainee-7", "--key",
       path("centre.key"), "-o", path("7.json")});
  run({"exam", "check", path("finals.json"), path("finals.published.json")});
  const Printed verified =
      run({"certificate", "verify", path("7.json"), path("7.trocar"), "--key", path("centre.pub")});
  for (const char* part : {"VERIFIED", "trainee-7", "Finals", "not certified assessment"})
    EXPECT_NE(verified.out.find(part), std::string::npos) << verified.out;

  for (const char* file : {"finals.json", "finals.published.json", "7.json"})
    EXPECT_EQ(std::system(("'" + std::string(TROCAR_SOURCE_DIR) + "/tools/check-schemas' '" + path(file) +
                           "' > /dev/null; test $? != 1")
                              .c_str()),
              0)
        << file;
  refuse("E-EXM-006",
         {"certificate", "verify", path("7.json"), path("7.trocar"), "--key", path("other.pub")});
  refuse("E-EXM-003",
         {"certificate", "verify", path("7.json"), path("7.trocar"), "--key", path("centre.key")});
  auto text = host::ReadFile(path("7.json"));
  ASSERT_TRUE(text.ok());
  std::string better = *text;
  better.replace(better.find("trainee-7"), 9, "trainee-8");
  ASSERT_TRUE(host::WriteFile(path("8.json"), better).ok());
  refuse("E-EXM-005", {"certificate", "verify", path("8.json"), path("7.trocar")});
  auto recording = host::ReadFile(path("7.trocar"));
  ASSERT_TRUE(recording.ok());
  recording->at(recording->size() / 2) ^= 1;
  ASSERT_TRUE(host::WriteFile(path("turned.trocar"), *recording).ok());
  refuse("E-EXM-007", {"certificate", "verify", path("7.json"), path("turned.trocar")});
  refuse("E-EXM-007", {"certificate", "issue", path("finals.json"), path("turned.trocar"), "--examinee", "x",
                       "--key", path("centre.key"), "-o", path("x.json")});
  // an easier exam after the announcement
  auto exam = host::ReadFile(path("finals.json"));
  Json json = Json::parse(*exam);
  json["passes"] = Json::array();
  ASSERT_TRUE(host::WriteFile(path("easier.json"), json.dump()).ok());
  refuse("E-EXM-002",
         {"exam", "run", path("easier.json"), "--surgeon", "expert", "--record", path("e.trocar")});
  run({"exam", "seal", "--task", "instrument_navigation", "--name", "Finals", "-o", path("later.json")});
  refuse("E-EXM-002", {"exam", "check", path("later.json"), path("finals.published.json")});
}

}  // namespace
}  // namespace trocar::cli
