// SPDX-License-Identifier: Apache-2.0
/// \file postgres_server.h  A PostgreSQL server of one's own, in a temporary folder, reached through a socket there and by nobody else.
#pragma once

#include <gtest/gtest.h>
#include <pwd.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "database.h"
#include "trocar_test/process.h"

namespace trocar::store {

class PostgresServer {
 public:
  PostgresServer() {
    std::error_code failure;
    // the clients alone install a folder, too
    for (const auto& entry : std::filesystem::directory_iterator("/usr/lib/postgresql", failure)) {
      const auto folder = entry.path() / "bin";
      if (std::filesystem::exists(folder / "initdb", failure)) programs_ = std::max(programs_, folder);
    }
    if (programs_.empty()) {
      trouble_ = "PostgreSQL is not installed; run tools/install-packages --test";
      return;
    }
    folder_ = MakeFolder();
    // the server refuses to run as root
    if (::geteuid() == 0) {
      const passwd* account = ::getpwnam("postgres");
      if (account == nullptr || ::chown(folder_.c_str(), account->pw_uid, account->pw_gid) != 0) {
        trouble_ = "root cannot give a folder to the account postgres";
        return;
      }
      as_other_ = {"/usr/bin/setpriv", "--reuid=postgres", "--regid=postgres", "--clear-groups"};
    }
    const test::ProcessResult made =
        test::RunProcess(Words({programs_ / "initdb", "-D", Data(), "--no-sync", "-A", "trust", "-U",
                                "postgres", "-E", "UTF8", "--locale=C.UTF-8"}));
    trouble_ = made.out + made.err;
    if (made.status == 0) Start();
  }
  ~PostgresServer() {
    Stop(SIGINT);
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  bool IsRunning() { return server_ != nullptr && !server_->HasEnded(); }
  /// What its programs said, where it does not run.
  std::string Trouble() const { return trouble_ + (server_ == nullptr ? "" : server_->Err()); }
  std::string Data() const { return folder_ / "data"; }
  test::Process& Server() { return *server_; }

  void Start() {
    server_ = std::make_unique<test::Process>(
        Words({programs_ / "postgres", "-D", Data(), "-k", folder_, "-h", "", "-c", "fsync=off", "-c",
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
    return "postgresql://postgres@/" + database + "?host=" + folder_.string();
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

  /// Below the first folder that any account reaches and that leaves room for a socket's name: a TMPDIR may be deep, or root's own.
  static std::filesystem::path MakeFolder() {
    constexpr std::size_t kMostSocketPath = 107,
                          kSocketName = 40;  // [bytes] of Linux; "/trocar-test-XXXXXX/.s.PGSQL.5432"
    for (const std::filesystem::path& parent :
         {std::filesystem::temp_directory_path(), std::filesystem::path("/tmp")}) {
      bool is_open = parent.is_absolute() && parent.native().size() + kSocketName < kMostSocketPath;
      for (auto folder = parent; is_open && folder.has_relative_path(); folder = folder.parent_path()) {
        struct stat info {};
        is_open = ::stat(folder.c_str(), &info) == 0 && (info.st_mode & S_IXOTH) != 0;
      }
      std::string path = parent / "trocar-test-XXXXXX";
      if (is_open && ::mkdtemp(path.data()) != nullptr) return path;
    }
    throw std::runtime_error("no folder for a PostgreSQL server");
  }

  std::filesystem::path folder_, programs_;
  std::string trouble_;
  std::vector<std::string> as_other_;
  std::unique_ptr<test::Process> server_;
};

}  // namespace trocar::store
