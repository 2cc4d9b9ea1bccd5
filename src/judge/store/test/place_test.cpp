// SPDX-License-Identifier: Apache-2.0
// Where a store lies: what is taken, what is refused, and who may look into it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>

#include "private_file.h"
#include "store_test.h"
#include "trocar/host/user_folder.h"
#include "trocar/store/keep_attempt.h"
#include "trocar/store/maintenance.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

TEST(FindPlace, TakesPathsAndServers) {
  for (const char* path : {"centre.sqlite", "/data/centre.sqlite", "./a:b@c.sqlite", "a=b.sqlite",
                           "dir/host.db", "my host/store.sqlite", "postgres.sqlite"}) {
    const auto place = FindPlace(path);
    ASSERT_TRUE(place.ok()) << path << ": " << place.error().Text();
    EXPECT_FALSE(place->IsPostgres());
    EXPECT_EQ(fs::path(place->url).filename(), fs::path(path).filename());
  }
  for (const char* url : {"postgresql://server/trocar", "postgres://a@b:5433/c?sslmode=verify-full"}) {
    const auto place = FindPlace(url);
    ASSERT_TRUE(place.ok());
    EXPECT_TRUE(place->IsPostgres());
    EXPECT_EQ(place->Text(), url);
  }
}

TEST(FindPlace, RefusesWhatIsNeitherAndSaysNoSecret) {
  for (const char* text : {"postgressql://trocar:SECRET@server/trocar",
                           "postgresql:/trocar:SECRET@server/trocar",
                           "postgresql:trocar:SECRET@server/trocar",
                           "Postgresql://trocar:SECRET@server/trocar",
                           "postgre://trocar:SECRET@server/trocar",
                           " postgresql://trocar:SECRET@server/trocar",
                           "http://trocar:SECRET@server/trocar",
                           "mysql://trocar:SECRET@server/trocar",
                           "sqlite:///SECRET.sqlite",
                           "trocar:SECRET@server/trocar",
                           "host=server user=trocar password=SECRET",
                           "password = SECRET host=server",
                           "HOST=server password='SECRET'",
                           "dbname=trocar passfile=SECRET",
                           "service=SECRET",
                           "a\nSECRET",
                           "\x1BSECRET",
                           "postgres//trocar:SECRET@server/trocar",
                           "postgresql/trocar:SEC/SECRET@server/trocar",
                           "//trocar:SECRET@server/trocar",
                           "postgresql//server/trocar?user=trocar&password=SECRET",
                           "server/trocar?password=SECRET"}) {
    for (const bool is_variable : {false, true}) {
      if (is_variable) ::setenv("TROCAR_STORE", text, 1);
      const auto place = FindPlace(is_variable ? "" : text);
      if (is_variable) ::unsetenv("TROCAR_STORE");
      ASSERT_FALSE(place.ok()) << text << " is " << place->url;
      EXPECT_EQ(place.error().code, base::ErrorCode::kUsage);
      EXPECT_THAT(place.error().Text(), HasSubstr("postgresql://USER@SERVER/DATABASE"));
      EXPECT_THAT(place.error().Text(), Not(HasSubstr("SECRET")));
    }
  }
  EXPECT_FALSE(FindPlace(std::string(10'000, 'x')).ok());
}

TEST(FindPlace, ShowsNoSecretOfAServer) {
  for (const char* url :
       {"postgresql://a:SECRET@b/c", "postgresql://a:SEC/RET@b/c?sslmode=require",
        "postgresql://b/c?user=a&password=SECRET", "postgresql://b/c?password=SECRET&user=a",
        "postgresql://b/c?sslpassword=SECRET", "postgresql://b/c?p%61ssword=SECRET&user=a"}) {
    const auto place = FindPlace(url);
    ASSERT_TRUE(place.ok());
    for (const std::string& shown : {place->Text(), place->folder.string()}) {
      EXPECT_THAT(shown, Not(HasSubstr("SECRET"))) << url;
      EXPECT_THAT(shown, Not(HasSubstr("RET@"))) << url;
    }
    EXPECT_EQ(place->url, url) << "the server is asked with it";
  }
}

int ModeOf(const fs::path& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 ? static_cast<int>(info.st_mode & 0777) : -1;
}

/// A umask for as long as it lives.
class Umask {
 public:
  explicit Umask(mode_t mask) : before_(::umask(mask)) {}
  ~Umask() { ::umask(before_); }

 private:
  mode_t before_;
};

TEST(StoreFiles, AreTheirOwnersAloneWhateverTheUmask) {
  for (const mode_t mask : {0000, 0002, 0022, 0077}) {
    test::TemporaryFolder folder;
    ::setenv("TROCAR_DATA_HOME", (folder.Path() / "data" / "trocar").c_str(), 1);
    const Umask umask(mask);
    for (const Place& place :
         {Get(FindPlace()), Get(FindPlace(folder.Path() / "deep" / "er" / "s.sqlite"))}) {
      auto store = Store::Open(place);
      ASSERT_TRUE(store.ok()) << store.error().Text();
      EXPECT_GOOD(AddPerson(*store, kOwner, Role::kTrainee, "T-1"));
      EXPECT_TRUE(Get(KeepAttempt(place, MakeAttempt(1, "T-1"))).is_in_store);
      EXPECT_GOOD(BackUp(*store, kOwner));
    }
    ::unsetenv("TROCAR_DATA_HOME");
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder.Path())) {
      ++files;
      EXPECT_EQ(ModeOf(entry.path()) & 0022, 0) << entry.path() << " with umask " << mask;
      // a lock holds a process's number, and lies in a folder that nobody else may enter
      if (entry.path().extension() == ".lock") continue;
      EXPECT_EQ(ModeOf(entry.path()) & 0077, 0) << entry.path() << " with umask " << mask;
    }
    EXPECT_GT(files, 10);
  }
}

TEST(MakeFolders, LeavesOthersFoldersToTheUmask) {
  test::TemporaryFolder folder;
  const Umask umask(0022);
  EXPECT_FALSE(host::MakeFolders(folder.Path() / "a" / "b"));
  EXPECT_EQ(ModeOf(folder.Path() / "a"), 0755);
  EXPECT_FALSE(host::MakePrivateFolders(folder.Path() / "a" / "c" / "d"));
  EXPECT_EQ(ModeOf(folder.Path() / "a"), 0755) << "it was there";
  EXPECT_EQ(ModeOf(folder.Path() / "a" / "c"), 0700);
  EXPECT_EQ(ModeOf(folder.Path() / "a" / "c" / "d"), 0700);
  EXPECT_TRUE(host::MakePrivateFolders("/proc/nothing/of/this"));
}

/// No file may grow beyond so many bytes: the same to a program as a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST(FullDiskOfAStore, IsSaidToBeFullAtEachWrite) {
  test::TemporaryFolder folder;
  const Place place = Get(FindPlace(folder.Path() / "s.sqlite"));
  auto store = Store::Open(place);
  ASSERT_TRUE(store.ok());
  EXPECT_GOOD(AddPerson(*store, kOwner, Role::kTrainee, "T-1"));
  EXPECT_GOOD(Spool(place).Keep(MakeAttempt(1, "T-1")));
  struct Write {
    const char* what;
    std::function<base::Status()> write;
  };
  const auto status = [](const auto& result) {
    return result.ok() ? base::Status() : base::Status(result.error());
  };
  const Write writes[] = {
      {"spool", [&] { return Spool(place).Keep(MakeAttempt(2, "T-1")); }},
      {"private file", [&] { return WritePrivateFile(place.folder / "x", "content"); }},
      {"database", [&] { return status(AddAttempt(*store, MakeAttempt(3, "T-1"))); }},
      {"delivery",
       [&] {
         const auto failure = Spool(place).Deliver(*store).failure;
         return failure ? base::Status(*failure) : base::Status();
       }},
      {"backup", [&] { return status(BackUp(*store, kOwner)); }},
      {"export", [&] { return ExportJson(*store, kOwner, folder.Path() / "e.json"); }},
      {"table", [&] { return ExportCsv(*store, kOwner, folder.Path() / "e.csv"); }},
      {"another store", [&] { return status(Store::Open(Get(FindPlace(folder.Path() / "t.sqlite")))); }},
  };
  for (const Write& one : writes) {
    base::Status written;
    {
      const FullDisk full(0);
      written = one.write();
    }
    ASSERT_FALSE(written.ok()) << one.what;
    EXPECT_EQ(written.error().code, base::ErrorCode::kStoreFull)
        << one.what << ": " << written.error().Text();
  }
  // the control: with space left, all of them go through
  fs::remove(folder.Path() / "t.sqlite");
  for (const Write& one : writes) EXPECT_GOOD(one.write());
}

}  // namespace
}  // namespace trocar::store
