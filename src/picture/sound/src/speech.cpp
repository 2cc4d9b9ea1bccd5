// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/speech.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

#include "trocar/sound/synthesiser.h"

namespace trocar::sound {
namespace {

constexpr std::size_t kMostBytes = 16u << 20;  // minutes of speech
constexpr int kPatience = 3000;                // [ms]
constexpr const char* kWordsPerMinute = "165";

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { Close(); }
  int Get() const { return number_; }
  void Close() {
    if (number_ >= 0) ::close(std::exchange(number_, -1));
  }

 private:
  int number_;
};

std::uint32_t ReadNumber(std::span<const unsigned char> bytes, std::size_t at, std::size_t size) {
  std::uint32_t number = 0;
  for (std::size_t i = size; i-- > 0;) number = number << 8 | bytes[at + i];
  return number;
}

/// All bytes until the other end is closed; nothing where it is silent for kPatience.
std::vector<unsigned char> ReadAll(int descriptor) {
  std::vector<unsigned char> bytes;
  std::array<unsigned char, 16384> block;
  while (bytes.size() < kMostBytes) {
    pollfd waiting{descriptor, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, kPatience);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return {};
    const ssize_t got = ::read(descriptor, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    bytes.insert(bytes.end(), block.begin(), block.begin() + got);
  }
  return bytes;
}

/// What the program writes to its standard output when `text` is its standard input; nothing where it fails.
std::vector<unsigned char> RunProgram(const std::string& program, const std::string& text,
                                      const std::string& language) {
  // a file in memory, so that a program that does not read its input cannot hold us up
  const Descriptor input(::memfd_create("trocar speech", MFD_CLOEXEC));
  if (input.Get() < 0 ||
      ::write(input.Get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      ::lseek(input.Get(), 0, SEEK_SET) != 0)
    return {};
  std::array<int, 2> ends;
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {};
  const Descriptor from(ends[0]);
  Descriptor to(ends[1]);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input.Get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, to.Get(), STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  std::array<std::string, 7> words = {program, "--stdin", "--stdout", "-s", kWordsPerMinute, "-v", language};
  std::array<char*, 8> arguments{};
  std::transform(words.begin(), words.end(), arguments.begin(),
                 [](std::string& word) { return word.data(); });
  pid_t child = -1;
  const int failure = ::posix_spawn(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) return {};
  to.Close();
  std::vector<unsigned char> bytes = ReadAll(from.Get());
  if (bytes.empty()) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) bytes.clear();
  return bytes;
}

}  // namespace

std::string FindSpeechProgram() {
  const char* path = std::getenv("PATH");
  std::string_view rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::string program = std::string(rest.substr(0, end)) + "/espeak-ng";
    if (end > 0 && ::access(program.c_str(), X_OK) == 0) return program;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

std::optional<std::vector<float>> ReadWave(std::span<const unsigned char> bytes) {
  const auto is_tag = [&](std::size_t at, const char* tag) {
    return at + 8 <= bytes.size() && std::memcmp(bytes.data() + at, tag, 4) == 0;
  };
  if (!is_tag(0, "RIFF") || bytes.size() < 12 || std::memcmp(bytes.data() + 8, "WAVE", 4) != 0)
    return std::nullopt;
  std::uint32_t rate = 0;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::size_t begin = at + 8, size = ReadNumber(bytes, at + 4, 4);
    if (is_tag(at, "fmt ") && size >= 16 && begin + 16 <= bytes.size()) {
      const bool is_plain = ReadNumber(bytes, begin, 2) == 1 && ReadNumber(bytes, begin + 2, 2) == 1 &&
                            ReadNumber(bytes, begin + 14, 2) == 16;
      if (!is_plain) return std::nullopt;
      rate = ReadNumber(bytes, begin + 4, 4);
    } else if (is_tag(at, "data")) {
      // a program that writes into a pipe does not know the length beforehand
      const std::size_t count = std::min(size, bytes.size() - begin) / 2;
      if (rate < 1000 || rate > 192000 || count < 2) return std::nullopt;
      const auto sample = [&](std::size_t i) {
        return static_cast<float>(static_cast<std::int16_t>(ReadNumber(bytes, begin + 2 * i, 2))) / 32768.0F;
      };
      std::vector<float> samples((count - 1) * kSampleRate / rate);
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const double place = static_cast<double>(i) * rate / kSampleRate;
        const auto before = static_cast<std::size_t>(place);
        const auto share = static_cast<float>(place - static_cast<double>(before));
        samples[i] = (1 - share) * sample(before) + share * sample(std::min(before + 1, count - 1));
      }
      return samples;
    }
    if (size > bytes.size()) return std::nullopt;
    at = begin + size + size % 2;
  }
  return std::nullopt;
}

std::optional<std::vector<float>> CalcSpeech(const std::string& program, const std::string& text,
                                             const std::string& language) {
  if (program.empty() || text.empty()) return std::nullopt;
  return ReadWave(RunProgram(program, text, language));
}

struct Speaker::Content {
  std::string program;
  std::function<void(std::vector<float>)> play;
  std::mutex mutex;
  std::condition_variable changed;
  std::string text, language;
  bool is_ending = false;
  std::thread thread;

  void Run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return is_ending || !text.empty(); });
      if (is_ending) return;
      const std::string now = std::exchange(text, {}), voice = language;
      lock.unlock();
      std::optional<std::vector<float>> samples = CalcSpeech(program, now, voice);
      if (samples) play(std::move(*samples));
      lock.lock();
    }
  }
};

Speaker::Speaker(std::string program, std::function<void(std::vector<float>)> play)
    : content_(std::make_unique<Content>()) {
  content_->program = std::move(program);
  content_->play = std::move(play);
  content_->thread = std::thread([content = content_.get()] { content->Run(); });
}

Speaker::~Speaker() {
  {
    const std::lock_guard lock(content_->mutex);
    content_->is_ending = true;
  }
  content_->changed.notify_all();
  content_->thread.join();
}

void Speaker::Say(std::string_view text, std::string_view language) {
  {
    const std::lock_guard lock(content_->mutex);
    content_->text = text;
    content_->language = language;
  }
  content_->changed.notify_all();
}

}  // namespace trocar::sound
