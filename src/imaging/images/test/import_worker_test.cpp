// SPDX-License-Identifier: Apache-2.0
#include "import_worker.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include "trocar/host/safe_file.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"
#include "volume_file.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using testing::HasSubstr;
using testing::Not;

class ImportWorkers : public testing::Test {
 protected:
  void TearDown() override {
    // whatever a reader did, it is gone and counted
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
  }
  fs::path Write(const std::string& name, const std::string& content) const {
    EXPECT_TRUE(host::WriteFile(folder_.Path() / name, content).ok());
    return folder_.Path() / name;
  }
  /// Limits with a reader that misbehaves in this way.
  ImportLimits Misbehaving(const std::string& how) const {
    std::error_code ignored;
    fs::create_symlink(TROCAR_MISBEHAVING_READER, folder_.Path() / how, ignored);
    ImportLimits limits;
    limits.program = folder_.Path() / how;
    limits.seconds = 0.3;
    return limits;
  }
  static base::Error ProbeFailure(const ImportLimits& limits, const fs::path& path) {
    ImportPool pool(limits, 1);
    const auto file = ImportFile::Open(path, Links::kFollow);
    EXPECT_TRUE(file.ok()) << file.error().Text();
    const auto reply = pool.Probe(*file);
    return reply.ok() ? base::Error{} : reply.error();
  }

  static std::string ReadProc(const fs::path& path) {
    std::ifstream stream(path);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  test::TemporaryFolder folder_;
};

TEST_F(ImportWorkers, EveryEndOfAReaderIsAMessage) {
  const fs::path file = Write("a.png", test::MakePng(8, 6, 6));
  EXPECT_EQ(ProbeFailure(Misbehaving("well"), file).code, ErrorCode::kNone);
  EXPECT_EQ(ProbeFailure(Misbehaving("hang"), file).code, ErrorCode::kImportTimedOut);
  EXPECT_EQ(ProbeFailure(Misbehaving("crash"), file).code, ErrorCode::kImportCrashed);
  EXPECT_EQ(ProbeFailure(Misbehaving("leave"), file).code, ErrorCode::kImportCrashed);
  EXPECT_EQ(ProbeFailure(Misbehaving("eat"), file).code, ErrorCode::kImportOutOfMemory);
  EXPECT_EQ(ProbeFailure(Misbehaving("killed"), file).code, ErrorCode::kImportOutOfMemory);
  EXPECT_THAT(ProbeFailure(Misbehaving("crash"), file).message, HasSubstr("a.png"));
  ImportLimits nowhere;
  nowhere.program = folder_.Path() / "none";
  EXPECT_EQ(ProbeFailure(nowhere, file).code, ErrorCode::kImportProgramMissing);
}

TEST_F(ImportWorkers, NothingThatAReaderSaysIsBelieved) {
  const fs::path file = Write("a.png", test::MakePng(8, 6, 6));
  for (const char* how :
       {"short", "noise", "huge", "wide", "empty", "nan", "path", "unterminated", "segments", "code"})
    EXPECT_EQ(ProbeFailure(Misbehaving(how), file).code, ErrorCode::kImportCrashed) << how;
  const std::string message = ProbeFailure(Misbehaving("control"), file).message;
  EXPECT_THAT(message, HasSubstr("red \\x1B[31m\\x0Atext"));
}

TEST_F(ImportWorkers, AReaderInheritsNothing) {
  const fs::path file = Write("a.png", test::MakePng(8, 6, 6));
  ::setenv("TROCAR_TEST_SECRET", "1", 1);
  const int open = ::open("/dev/null", O_RDONLY);  // without O_CLOEXEC
  ASSERT_GE(open, 0);
  const std::string seen = ProbeFailure(Misbehaving("spy"), file).message;
  ::close(open);
  ::unsetenv("TROCAR_TEST_SECRET");
  EXPECT_THAT(seen, HasSubstr("variables LC_ALL"));
  EXPECT_THAT(seen, Not(HasSubstr("SECRET")));
  // standard streams, the socket, and the file that came with the request
  EXPECT_THAT(seen, HasSubstr("descriptors 0 1 2 3 4 variables"));
}

TEST_F(ImportWorkers, TheSandboxAllowsReadingOnly) {
  const fs::path file = Write("a.png", test::MakePng(8, 6, 6));
  EXPECT_THAT(ProbeFailure(Misbehaving("boxed"), file).message, HasSubstr("could read;"));
}

TEST_F(ImportWorkers, TheRealReaderIsInTheSandbox) {
  const auto file = ImportFile::Open(Write("a.png", test::MakePng(8, 6, 6)), Links::kFollow);
  ASSERT_TRUE(file.ok());
  ImportLimits limits;
  limits.reader_bytes = std::uint64_t{1234567} << 10;
  ImportPool pool(limits, 1);
  ASSERT_TRUE(pool.Probe(*file).ok());
  std::string status, limit;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string text = ReadProc(entry.path() / "status");
    if (text.find("PPid:\t" + std::to_string(::getpid()) + "\n") == std::string::npos) continue;
    status = text;
    limit = ReadProc(entry.path() / "limits");
  }
  EXPECT_THAT(status, HasSubstr("Name:\ttrocar-import"));
  EXPECT_THAT(status, HasSubstr("Seccomp:\t2"));
  EXPECT_THAT(status, HasSubstr("NoNewPrivs:\t1"));
  EXPECT_THAT(limit, HasSubstr(std::to_string(limits.reader_bytes)));
}

// Negative controls: without our guards the very same files do kill the reader.
TEST_F(ImportWorkers, WithoutTheGuardsTheReaderDies) {
  test::DicomFields nested;
  for (int i = 0; i < 100000; ++i) {
    nested.more += test::Bytes<std::uint16_t>(0x40) + test::Bytes<std::uint16_t>(0x275) + "SQ" +
                   std::string(2, '\0') + test::Bytes<std::uint32_t>(0xFFFFFFFF) +
                   test::Bytes<std::uint16_t>(0xFFFE) + test::Bytes<std::uint16_t>(0xE000) +
                   test::Bytes<std::uint32_t>(0xFFFFFFFF);
  }
  const fs::path dicom = Write("a.dcm", test::MakeDicom(nested));
  ImportLimits limits;
  EXPECT_EQ(ProbeFailure(limits, dicom).code, ErrorCode::kImageUndecodable);
  limits.is_size_believed = true;
  EXPECT_EQ(ProbeFailure(limits, dicom).code, ErrorCode::kImportCrashed);

  // a picture of 4 GiB in 100 bytes
  const fs::path bomb = Write("a.png", test::MakePng(65535, 65535, 0));
  EXPECT_EQ(ProbeFailure({}, bomb).code, ErrorCode::kImageTooLarge);
  limits.most_side = 100000;
  limits.most_bytes = std::uint64_t{1} << 40;
  limits.reader_bytes = std::uint64_t{1} << 30;
  ImportPool pool(limits, 1);
  EXPECT_EQ(DecodeFile(bomb, Links::kFollow, pool).error().code, ErrorCode::kImportOutOfMemory);
}

TEST_F(ImportWorkers, APoolOutlivesItsReaders) {
  // its readers crash on every second file; threads share it
  test::DicomFields unending;
  unending.more = test::Bytes<std::uint16_t>(0x40) + test::Bytes<std::uint16_t>(0x275) + "SQ" +
                  std::string(2, '\0') + test::Bytes<std::uint32_t>(0xFFFFFFFF) +
                  test::Bytes<std::uint16_t>(0xFFFE) + test::Bytes<std::uint16_t>(0xE000) +
                  test::Bytes<std::uint32_t>(0xFFFFFFFF);
  const fs::path bad = Write("bad.dcm", test::MakeDicom(unending)),
                 good = Write("good.nii", test::MakeNifti());
  ImportLimits limits;
  limits.is_size_believed = true;
  ImportPool pool(limits, 2);
  std::atomic<int> crashed = 0, read = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 4; ++i) {
        const auto refused = DecodeFile(bad, Links::kFollow, pool);
        crashed += !refused.ok() && refused.error().code == ErrorCode::kImportCrashed;
        const auto decoded = DecodeFile(good, Links::kFollow, pool);
        read += decoded.ok() &&
                SampleAt(decoded->header, decoded->samples.Data(), 100) == test::Sample(4, 0, 2) + 0.0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(crashed, 16);
  EXPECT_EQ(read, 16);
}

TEST_F(ImportWorkers, NoticesAFileThatChanges) {
  const fs::path path = Write("a.nii", test::MakeNifti());
  const auto file = ImportFile::Open(path, Links::kFollow);
  ASSERT_TRUE(file.ok());
  EXPECT_TRUE(file->CheckUnchanged().ok());
  const int again = ::open(path.c_str(), O_WRONLY | O_APPEND);
  ASSERT_EQ(::write(again, "more", 4), 4);
  ::close(again);
  ImportPool pool({}, 1);
  EXPECT_EQ(pool.Probe(*file).error().code, ErrorCode::kImageChanged);
}

}  // namespace
}  // namespace trocar::images
