// SPDX-License-Identifier: Apache-2.0
/// \file command_fixture.h  Runs the trocar command in an empty folder's sight.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "trocar/host/safe_file.h"
#include "trocar_test/process.h"
#include "trocar_test/temporary_folder.h"

namespace trocar {

/// TROCAR_PROGRAM is the command that was built, TROCAR_SOURCE_DIR the repository.
class Command : public testing::Test {
 protected:
  static test::ProcessResult Run(std::vector<std::string> arguments,
                                 const std::vector<std::string>& environment = {}) {
    arguments.insert(arguments.begin(), TROCAR_PROGRAM);
    return test::RunProcess(std::move(arguments), environment);
  }
  static std::string Source(const std::string& path) { return std::string(TROCAR_SOURCE_DIR) + "/" + path; }
  std::string Path(const std::string& name) const { return folder_.Path() / name; }
  void Write(const std::string& name, const std::string& text) const {
    ASSERT_TRUE(host::WriteFile(folder_.Path() / name, text).ok());
  }
  std::string Read(const std::string& path) const {
    auto text = host::ReadFile(path);
    EXPECT_TRUE(text.ok()) << text.error().Text();
    return text.ok() ? *text : std::string();
  }
  /// Names of everything in the folder, at any depth.
  std::vector<std::string> List() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.Path())) {
      names.push_back(std::filesystem::relative(entry.path(), folder_.Path()).generic_string());
    }
    return names;
  }
  /// An error with this code: one line on standard error, nothing on standard output, this exit status.
  static void ExpectError(const test::ProcessResult& result, const std::string& code, int status = 1) {
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_THAT(result.err, testing::StartsWith("trocar: " + code + " "));
    EXPECT_EQ(result.out, "");
  }

 private:
  test::TemporaryFolder folder_;
};

}  // namespace trocar
