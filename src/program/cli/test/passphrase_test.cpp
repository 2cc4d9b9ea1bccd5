// SPDX-License-Identifier: Apache-2.0
#include "passphrase.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "run_trocar.h"
#include "trocar/assessment/signing_key.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kPassphrase = "seven green herons";

class Passphrase : public testing::Test {
 protected:
  void SetUp() override { ::unsetenv("TROCAR_KEY_PASSPHRASE"); }
  void TearDown() override { ::unsetenv("TROCAR_KEY_PASSPHRASE"); }
  std::string Path(const char* name) const { return (folder_.Path() / name).string(); }
  bool IsEncrypted() const {
    const auto is_encrypted = assessment::IsKeyEncrypted(Path("centre.key"));
    return is_encrypted.ok() && *is_encrypted;
  }

  struct Typed {
    int status = -1;
    std::string screen;  // what a person saw
  };
  /// Runs keygen at a terminal of its own, and types a line after each question.
  Typed KeygenAtATerminal(const std::vector<std::string>& lines) const {
    Typed typed;
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
      std::string words[] = {"trocar", "certificate", "keygen", "-o", Path("centre")};
      char* argv[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), words[4].data()};
      ::_exit(RunCommand(5, argv));
    }
    EXPECT_GT(child, 0);
    std::size_t asked = 0;
    char part[256];
    for (ssize_t count = 0; (count = ::read(terminal, part, sizeof part)) > 0;) {
      typed.screen.append(part, static_cast<std::size_t>(count));
      // the question ends with ": "; the terminal is silent before it is asked
      if (asked < lines.size() && typed.screen.ends_with(": ")) {
        const std::string line = lines[asked++] + "\n";
        EXPECT_EQ(::write(terminal, line.data(), line.size()), static_cast<ssize_t>(line.size()));
      }
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(terminal);
    typed.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return typed;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Passphrase, IsAskedForAtATerminalAndNotShown) {
  const Typed typed = KeygenAtATerminal({kPassphrase, kPassphrase});
  EXPECT_EQ(typed.status, 0) << typed.screen;
  EXPECT_THAT(typed.screen, HasSubstr("Passphrase for"));
  EXPECT_THAT(typed.screen, Not(HasSubstr("heron")));
  EXPECT_THAT(typed.screen, Not(HasSubstr("warning")));
  EXPECT_TRUE(IsEncrypted());
}

TEST_F(Passphrase, TypedDifferentlyMakesNoKey) {
  const Typed typed = KeygenAtATerminal({kPassphrase, "seven green hens"});
  EXPECT_EQ(typed.status, 2) << typed.screen;
  EXPECT_THAT(typed.screen, HasSubstr("differ"));
  EXPECT_FALSE(std::filesystem::exists(Path("centre.key")));
}

TEST_F(Passphrase, NoneIsWarnedOf) {
  const Typed typed = KeygenAtATerminal({""});
  EXPECT_EQ(typed.status, 0) << typed.screen;
  EXPECT_THAT(typed.screen, HasSubstr("is not encrypted"));
  EXPECT_TRUE(std::filesystem::exists(Path("centre.key")));
  EXPECT_FALSE(IsEncrypted());
}

TEST_F(Passphrase, OfTheEnvironmentNeedsNoTerminal) {
  ::setenv("TROCAR_KEY_PASSPHRASE", kPassphrase, 1);
  const Printed made = RunTrocar({"certificate", "keygen", "-o", Path("centre")});
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.err, Not(HasSubstr("warning")));
  EXPECT_TRUE(IsEncrypted());
  const auto found = FindPassphrase(Path("centre.key"));
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(*found, kPassphrase);
}

}  // namespace
}  // namespace trocar::cli
