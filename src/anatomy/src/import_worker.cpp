// SPDX-License-Identifier: Apache-2.0
#include "import_worker.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include "trocar/core/assert.h"
#include "trocar/core/clock.h"
#include "trocar/core/printable.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using core::Error;
using core::ErrorCode;

constexpr double kBytesPerSecond = 16.0 * (1 << 20);  // slowest decoding that is waited for
constexpr std::uint32_t kGraceSeconds = 5;            // after which a reader without a parent ends itself

/// Arguments of posix_spawn that must be destroyed.
struct SpawnSettings {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  SpawnSettings() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

bool IsTerminated(const char* text, std::size_t size) {
  return std::memchr(text, '\0', size) != nullptr;
}

bool IsFinite(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double number) { return std::isfinite(number); });
}

/// Whether a header says nothing that could hurt us: the reader may have been taken over by the file.
bool IsSane(const ImageHeader& header, const ImportLimits& limits) {
  const bool is_enumerated = header.kind >= FileKind::kJpeg && header.kind <= FileKind::kMetaImage &&
                             header.samples <= SampleKind::kFloat32 && header.frame <= FileFrame::kRas;
  const bool is_sized = header.width >= 1 && header.width <= limits.most_side && header.height >= 1 &&
                        header.height <= limits.most_side && header.depth >= 1 &&
                        header.depth <= limits.most_side && (header.channels == 1 || header.channels == 3) &&
                        header.bits >= 1 && header.bits <= 64;
  if (!is_enumerated || !is_sized) return false;
  // four sides of 14 bits at most, so this cannot overflow with the default limits; with any, it is checked
  std::uint64_t bytes = SampleBytes(header.samples);
  for (const std::uint64_t factor : {header.width, header.height, header.depth, header.channels}) {
    if (__builtin_mul_overflow(bytes, factor, &bytes)) return false;
  }
  bool is_finite =
      IsFinite(header.spacing) && IsFinite(header.origin) &&
      IsFinite(std::array{header.slope, header.intercept, header.window_centre, header.window_width});
  for (const auto& axis : header.direction) is_finite = is_finite && IsFinite(axis);
  const std::string_view data_file(header.data_file, ::strnlen(header.data_file, sizeof(header.data_file)));
  const bool is_plain =
      data_file.find('/') == std::string_view::npos && data_file != "." && data_file != "..";
  return bytes <= limits.most_bytes && is_finite && is_plain && header.segments <= kMostSegments &&
         IsTerminated(header.data_file, sizeof(header.data_file)) &&
         std::all_of(std::begin(header.spacing), std::end(header.spacing),
                     [](double spacing) { return spacing >= 0 && spacing <= 200; });
}

bool IsSane(const ImportReply& reply, const ImportLimits& limits) {
  if (reply.version != kImportVersion || !IsTerminated(reply.why, sizeof(reply.why))) return false;
  for (const SegmentName& name : reply.names) {
    if (!IsTerminated(name.name, sizeof(name.name)) || name.label < 0 || name.label > 255) return false;
  }
  if (reply.code == 0) return IsSane(reply.header, limits);
  return reply.code >= static_cast<int>(ErrorCode::kImageFolderMissing) &&
         reply.code <= static_cast<int>(ErrorCode::kImportOutOfMemory);
}

const char* FindRemedy(ErrorCode code) {
  switch (code) {
    case ErrorCode::kImageTooLarge:
      return "crop or resample it, or allow more memory";
    case ErrorCode::kImageUnsupported:
      return "convert it, for instance with 3D Slicer, to DICOM, NIfTI or NRRD";
    case ErrorCode::kImageGeometryInvalid:
      return "correct the header, or export it again";
    case ErrorCode::kImagePathUnsafe:
      return "put header and data into one folder";
    case ErrorCode::kImportOutOfMemory:
      return "it is damaged, or too large for this computer";
    case ErrorCode::kImportCrashed:
    case ErrorCode::kImportTimedOut:
      return "the file is damaged or made to do harm; get it again";
    default:
      return "get the file again";
  }
}

}  // namespace

fs::path FindImportProgram() {
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  const fs::path folder = failure ? fs::path(".") : program.parent_path();
  fs::path beside = folder / "trocar-import";
  if (fs::exists(beside, failure)) return beside;
  const fs::path installed = folder.parent_path() / "libexec" / "trocar" / "trocar-import";
  return fs::exists(installed, failure) ? installed : beside;
}

core::Result<SampleBuffer> SampleBuffer::Make(std::uint64_t bytes) {
  const Error failed{ErrorCode::kImportOutOfMemory, "there is no memory for " + std::to_string(bytes >> 20) +
                                                        " MiB of samples; close other programs"};
  SampleBuffer buffer;
  buffer.descriptor_ = Descriptor(::memfd_create("trocar samples", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (buffer.Get() < 0 || ::ftruncate(buffer.Get(), static_cast<off_t>(bytes)) != 0) return failed;
  if (::fcntl(buffer.Get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) return failed;
  void* begin = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, buffer.Get(), 0);
  if (begin == MAP_FAILED) return failed;
  buffer.data_ = static_cast<std::byte*>(begin);
  buffer.bytes_ = bytes;
  return buffer;
}

SampleBuffer::SampleBuffer(SampleBuffer&& other) noexcept {
  *this = std::move(other);
}

SampleBuffer& SampleBuffer::operator=(SampleBuffer&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

SampleBuffer::~SampleBuffer() {
  if (data_ != nullptr) ::munmap(data_, bytes_);
}

core::Result<std::unique_ptr<ImportWorker>> ImportWorker::Start(const ImportLimits& limits) {
  const fs::path program = limits.program.empty() ? FindImportProgram() : limits.program;
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    return Error{ErrorCode::kImportProgramMissing, std::string("no socket for the image reader: ") +
                                                       std::strerror(errno) + "; close other programs"};
  Descriptor ours(ends[0]), theirs(ends[1]);

  SpawnSettings spawn;
  // the socket first: it may itself be one of 0 to 2 where this program was started without them
  posix_spawn_file_actions_adddup2(&spawn.actions, theirs.Get(), kImportSocket);
  posix_spawn_file_actions_addopen(&spawn.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&spawn.actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  // libraries would print what they find in files, names of patients included
  posix_spawn_file_actions_addopen(&spawn.actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&spawn.actions, kImportSocket + 1);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&spawn.attributes, &signals);
  sigfillset(&signals);
  posix_spawnattr_setsigdefault(&spawn.attributes, &signals);
  posix_spawnattr_setflags(&spawn.attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

  std::string name = program.string(), memory = std::to_string(limits.reader_bytes);
  char* const arguments[] = {name.data(), memory.data(), nullptr};
  std::string locale = "LC_ALL=C", libraries;
  if (const char* path = std::getenv("LD_LIBRARY_PATH")) libraries = std::string("LD_LIBRARY_PATH=") + path;
  char* const environment[] = {locale.data(), libraries.empty() ? nullptr : libraries.data(), nullptr};
  pid_t process = -1;
  const int failure =
      ::posix_spawn(&process, program.c_str(), &spawn.actions, &spawn.attributes, arguments, environment);
  if (failure != 0) {
    return Error{ErrorCode::kImportProgramMissing, "the image reader " + core::Printable(name) +
                                                       " does not start (" + std::strerror(failure) +
                                                       "); build it too: ninja trocar-import"};
  }
  return std::unique_ptr<ImportWorker>(new ImportWorker(process, std::move(ours)));
}

ImportWorker::~ImportWorker() {
  if (IsAlive()) End();
}

bool ImportWorker::IsReady() const {
  pollfd state{socket_.Get(), 0, 0};
  return IsAlive() && ::poll(&state, 1, 0) == 0;
}

/// Ends the process for certain. \return how it ended, as waitpid says it
int ImportWorker::End() {
  ::kill(process_, SIGKILL);
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

/// The reader hung up: why?
Error ImportWorker::FindCause() {
  // it may still be on its way out
  int status = 0;
  pid_t ended = 0;
  const core::Stopwatch stopwatch;
  while ((ended = ::waitpid(process_, &status, WNOHANG)) == 0 && stopwatch.Seconds() < 1.0) ::usleep(1000);
  if (ended == 0) status = End();
  process_ = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kExitOutOfMemory)
    return {ErrorCode::kImportOutOfMemory, "it needs more memory than its reader may have"};
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    return {ErrorCode::kImportProgramMissing,
            "the image reader cannot be run; build it again: ninja trocar-import"};
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    return {ErrorCode::kImportTimedOut, "its reader did not finish in time"};
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    return {ErrorCode::kImportOutOfMemory, "its reader was killed, probably for want of memory"};
  if (WIFSIGNALED(status))
    return {ErrorCode::kImportCrashed,
            std::string("its reader crashed on it (") + ::strsignal(WTERMSIG(status)) + ")"};
  return {ErrorCode::kImportCrashed, "its reader gave up on it"};
}

core::Result<ImportReply> ImportWorker::Ask(const ImportRequest& request, std::span<const int> descriptors,
                                            double seconds) {
  TROCAR_ASSERT(IsAlive());
  if (!SendMessage(socket_.Get(), &request, sizeof(request), descriptors)) return FindCause();
  const core::Stopwatch stopwatch;
  for (;;) {
    const double left = seconds - stopwatch.Seconds();
    pollfd wait{socket_.Get(), POLLIN, 0};
    const int ready = left > 0 ? ::poll(&wait, 1, static_cast<int>(std::min(1e3 * left, 1e9)) + 1) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready > 0) break;
    End();
    return Error{ErrorCode::kImportTimedOut, "its reader did not finish within " +
                                                 std::to_string(static_cast<int>(std::ceil(seconds))) + " s"};
  }
  ImportReply reply;
  if (!ReceiveMessage(socket_.Get(), &reply, sizeof(reply), {})) return FindCause();
  return reply;
}

ImportPool::ImportPool(ImportLimits limits, std::size_t most_workers)
    : limits_(std::move(limits)), most_workers_(most_workers) {
  TROCAR_ASSERT(most_workers_ > 0);
}

core::Result<ImportReply> ImportPool::Ask(const ImportRequest& request, std::span<const int> descriptors,
                                          double seconds) {
  std::unique_ptr<ImportWorker> worker;
  {
    std::unique_lock lock(mutex_);
    returned_.wait(lock, [&] { return busy_ < most_workers_; });
    ++busy_;
    // one that ended while nobody asked it anything says nothing about this file
    std::erase_if(idle_, [](const auto& other) { return !other->IsReady(); });
    if (!idle_.empty()) {
      worker = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  core::Result<ImportReply> answer = Error{};
  if (!worker) {
    auto started = ImportWorker::Start(limits_);
    if (started)
      worker = std::move(*started);
    else
      answer = started.error();
  }
  if (worker) {
    answer = worker->Ask(request, descriptors, seconds);
    if (answer && !IsSane(*answer, limits_)) {
      answer = Error{ErrorCode::kImportCrashed, "its reader answered nonsense"};
      worker.reset();
    }
  }
  {
    const std::scoped_lock lock(mutex_);
    --busy_;
    if (worker && worker->IsAlive()) idle_.push_back(std::move(worker));
  }
  returned_.notify_one();
  if (answer && answer->code != 0)
    return Error{static_cast<ErrorCode>(answer->code), core::Printable(answer->why, sizeof(answer->why))};
  return answer;
}

core::Result<ImportReply> ImportPool::Probe(const ImportFile& file, const ImportFile* data_file) {
  ImportRequest request;
  request.has_data_file = data_file != nullptr;
  request.most_side = limits_.most_side;
  request.most_bytes = limits_.most_bytes;
  request.is_size_believed = limits_.is_size_believed;
  request.seconds = static_cast<std::uint32_t>(limits_.seconds) + kGraceSeconds;
  const int descriptors[] = {file.Get(), data_file != nullptr ? data_file->Get() : -1};
  auto answer = Ask(request, {descriptors, data_file != nullptr ? 2u : 1u}, limits_.seconds);
  if (!answer) return NameFile(file.Path(), answer.error());
  if (auto status = file.CheckUnchanged(); !status) return status.error();
  return answer;
}

core::Status ImportPool::Decode(const ImportFile& file, const ImportFile* data_file,
                                const ImageHeader& header, const SampleBuffer& buffer, std::uint64_t offset) {
  const std::uint64_t bytes = header.SampleCount() * SampleBytes(header.samples);
  TROCAR_ASSERT(offset <= buffer.Bytes() && bytes <= buffer.Bytes() - offset);
  const double seconds = limits_.seconds + static_cast<double>(bytes) / kBytesPerSecond;
  ImportRequest request;
  request.operation = ImportOperation::kDecode;
  request.has_data_file = data_file != nullptr;
  request.most_side = limits_.most_side;
  request.most_bytes = limits_.most_bytes;
  request.is_size_believed = limits_.is_size_believed;
  request.seconds = static_cast<std::uint32_t>(seconds) + kGraceSeconds;
  request.offset = offset;
  request.room = bytes;
  std::vector<int> descriptors = {file.Get()};
  if (data_file != nullptr) descriptors.push_back(data_file->Get());
  descriptors.push_back(buffer.Get());
  const auto answer = Ask(request, descriptors, seconds);
  if (!answer) return NameFile(file.Path(), answer.error());
  const ImageHeader& said = answer->header;
  if (said.width != header.width || said.height != header.height || said.depth != header.depth ||
      said.channels != header.channels || said.samples != header.samples) {
    return Error{ErrorCode::kImageChanged,
                 core::Printable(file.Path().string()) + " changed while it was read; open it again"};
  }
  if (auto status = file.CheckUnchanged(); !status) return status;
  return data_file != nullptr ? data_file->CheckUnchanged() : core::Status{};
}

Error NameFile(const fs::path& path, const Error& error) {
  if (error.code == ErrorCode::kImportProgramMissing) return error;
  return {error.code, core::Printable(path.string()) + ": " + error.message + "; " + FindRemedy(error.code)};
}

}  // namespace trocar::anatomy
