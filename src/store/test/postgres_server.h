// SPDX-License-Identifier: Apache-2.0
/// \file postgres_server.h  A PostgreSQL server of one's own, in a temporary folder, reached through a socket there and by nobody else.
#pragma once

#include <gtest/gtest.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "database.h"
#include "trocar_test/process.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::store {

class PostgresServer {
 public:
  PostgresServer() {
    namespace fs = std::filesystem;
    std::error_code failure;
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator("/usr/lib/postgresql", failure))
      found.push_back(entry.path() / "bin");
    if (found.empty()) return;
    programs_ = *std::max_element(found.begin(), found.end());
    // the server refuses to run as root
    if (::geteuid() == 0) {
      const passwd* account = ::getpwnam("postgres");
      if (account == nullptr) return;
      if (::chown(folder_.Path().c_str(), account->pw_uid, account->pw_gid) != 0) return;
      as_other_ = {"/usr/bin/setpriv", "--reuid=postgres", "--regid=postgres", "--clear-groups"};
    }
    const test::ProcessResult made =
        test::RunProcess(Words({programs_ / "initdb", "-D", Data(), "--no-sync", "-A", "trust", "-U",
                                "postgres", "-E", "UTF8", "--locale=C.UTF-8"}));
    if (made.status == 0) Start();
  }
  ~PostgresServer() { Stop(SIGINT); }

  bool IsRunning() { return server_ != nullptr && !server_->HasEnded(); }
  std::string Data() const { return folder_.Path() / "data"; }
  test::Process& Server() { return *server_; }

  void Start() {
    server_ = std::make_unique<test::Process>(
        Words({programs_ / "postgres", "-D", Data(), "-k", folder_.Path(), "-h", "", "-c", "fsync=off", "-c",
               "shared_buffers=16MB", "-c", "autovacuum=off"}));
    for (int i = 0; i < 600 && !server_->HasEnded(); ++i) {
      if (OpenPostgres(Url("postgres"), 2, 2).ok()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  /// SIGINT: disconnects all; SIGQUIT: immediate, as a crash.
  void Stop(int signal) {
    if (server_ == nullptr) return;
    server_->Signal(SIGCONT);
    server_->Signal(signal);
    server_->Wait();
  }
  std::string Url(const std::string& database) const {
    return "postgresql://postgres@/" + database + "?host=" + folder_.Path().string();
  }
  /// A statement as its administrator.
  core::Status Administer(const std::string& sql, const std::string& database = "postgres") {
    auto connection = OpenPostgres(Url(database), 5, 30);
    return connection.ok() ? (*connection)->RunScript(sql) : connection.error();
  }

  /// One server for all tests of a program.
  static PostgresServer& Get() {
    static PostgresServer server;
    return server;
  }

 private:
  std::vector<std::string> Words(const std::vector<std::string>& words) const {
    std::vector<std::string> all = as_other_;
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path programs_;
  std::vector<std::string> as_other_;
  std::unique_ptr<test::Process> server_;
};

}  // namespace trocar::store
