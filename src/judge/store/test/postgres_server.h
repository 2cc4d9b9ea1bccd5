// SPDX-License-Identifier: Apache-2.0
/// \file postgres_server.h  A PostgreSQL server of one's own, in a temporary folder, reached through a socket there and by nobody else.
#pragma once

#include <gtest/gtest.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
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
    if (MakeData()) Start();
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
  base::Status Administer(const std::string& sql, const std::string& database = "postgres") {
    auto connection = OpenPostgres(Url(database), 5, 30);
    return connection.ok() ? (*connection)->RunScript(sql) : connection.error();
  }

  /// One server for all tests of a program.
  static PostgresServer& Get() {
    static PostgresServer server;
    return server;
  }

 private:
  /// A new cluster takes seconds of computing, and each test has a server of its own: the first one's empty files are kept beside
  /// the program that is tested, and copied.
  bool MakeData() {
    const auto version = programs_.parent_path().filename().string();
    const auto kept =
        std::filesystem::read_symlink("/proc/self/exe").parent_path() / ("empty-postgres-" + version);
    if (std::filesystem::exists(kept)) return Run({"/bin/cp", "-a", kept, Data()});
    std::vector<std::string> initialise = {
        programs_ / "initdb", "-D", Data(), "--no-sync",       "-A", "trust", "-U",
        "postgres",           "-E", "UTF8", "--locale=C.UTF-8"};
    if (!Run(Words(initialise))) return false;
    const std::string part = kept.string() + "." + std::to_string(::getpid());
    if (!Run({"/bin/cp", "-a", Data(), part}) || ::rename(part.c_str(), kept.c_str()) != 0) {
      std::error_code ignored;
      std::filesystem::remove_all(part, ignored);  // there is no room, or another test was first
    }
    return true;
  }
  bool Run(const std::vector<std::string>& words) {
    const test::ProcessResult result = test::RunProcess(words);
    trouble_ = result.out + result.err;
    return result.status == 0;
  }

  std::vector<std::string> Words(const std::vector<std::string>& words) const {
    std::vector<std::string> all = as_other_;
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }

  /// Below the first folder that any account reaches, that has room, and whose name leaves room for a socket's: a TMPDIR may be deep, or
  /// root's own. Memory first: a cluster is a thousand files, which a disk takes seconds to make and to remove.
  static std::filesystem::path MakeFolder() {
    constexpr std::size_t kMostSocketPath = 107,
                          kSocketName = 40;       // [bytes] of Linux; "/trocar-test-XXXXXX/.s.PGSQL.5432"
    constexpr std::uintmax_t kRoom = 512u << 20;  // [bytes] for a cluster of 39 MiB and what a test stores
    std::error_code failure;
    for (const std::filesystem::path& parent :
         {std::filesystem::path("/dev/shm"), std::filesystem::temp_directory_path(),
          std::filesystem::path("/tmp")}) {
      const auto space = std::filesystem::space(parent, failure);
      bool is_open = !failure && space.available > kRoom && parent.is_absolute() &&
                     parent.native().size() + kSocketName < kMostSocketPath;
      for (auto folder = parent; is_open && folder.has_relative_path(); folder = folder.parent_path()) {
        struct stat info {};
        is_open = ::stat(folder.c_str(), &info) == 0 && (info.st_mode & S_IXOTH) != 0;
      }
      std::string path = parent / "trocar-test-XXXXXX";
      if (is_open && ::mkdtemp(path.data()) != nullptr) return path;
    }
    throw std::runtime_error("no folder for a PostgreSQL server: it needs 512 MiB");
  }

  std::filesystem::path folder_, programs_;
  std::string trouble_;
  std::vector<std::string> as_other_;
  std::unique_ptr<test::Process> server_;
};

}  // namespace trocar::store
