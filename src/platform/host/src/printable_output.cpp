// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/printable_output.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <iostream>
#include <streambuf>
#include <utility>

#include "letter.h"
#include "trocar/host/log.h"

namespace trocar::host {
namespace {

void AppendUtf16(std::string& text, std::uint32_t unit) {
  char escaped[8];
  std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(unit));
  text += escaped;
}

std::string EscapeLetters(std::string_view text, bool has_lines) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const Letter letter = DecodeLetter(text);
    const std::size_t bytes = std::max<std::size_t>(letter.bytes, 1);
    const bool is_line = has_lines && (letter.code == '\n' || letter.code == '\t');
    if (letter.bytes == 0 || (letter.code < 0x20 && !is_line)) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\x%02X", static_cast<unsigned>(text[0]) & 0xFFu);
      result += escaped;
    } else if (is_line || !IsHarmful(letter.code)) {
      result += text.substr(0, bytes);
    } else if (letter.code < 0x10000) {
      AppendUtf16(result, letter.code);
    } else {
      AppendUtf16(result, 0xD800 + ((letter.code - 0x10000) >> 10));
      AppendUtf16(result, 0xDC00 + ((letter.code - 0x10000) & 0x3FF));
    }
    text.remove_prefix(bytes);
  }
  return result;
}

/// Bytes at the end that begin a letter of which the rest has not come yet.
std::size_t CountUnfinished(std::string_view text) {
  for (std::size_t i = 1; i <= std::min<std::size_t>(3, text.size()); ++i) {
    const auto byte = static_cast<unsigned char>(text[text.size() - i]);
    if ((byte & 0xC0) == 0x80) continue;
    const std::size_t length = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC2 ? 2 : 1;
    return length > i ? i : 0;
  }
  return 0;
}

bool WriteWhole(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// What a stream's bytes pass on their way to a descriptor.
struct Fence {
  int file = -1;
  std::FILE* former = nullptr;
  std::FILE* stream = nullptr;
  std::string unfinished;  // the beginning of a letter

  bool Write(std::string_view bytes) {
    std::string text = std::move(unfinished);
    text += bytes;
    unfinished = text.substr(text.size() - CountUnfinished(text));
    text.resize(text.size() - unfinished.size());
    return WriteWhole(file, PrintableText(text));
  }
  bool Finish() { return WriteWhole(file, PrintableText(std::exchange(unfinished, {}))); }

  void Open(int descriptor, std::FILE* now, int buffering) {
    file = descriptor;
    former = now;
    std::fflush(former);
    cookie_io_functions_t functions{};
    functions.write = [](void* self, const char* bytes, std::size_t size) -> ssize_t {
      return static_cast<Fence*>(self)->Write({bytes, size}) ? static_cast<ssize_t>(size) : 0;
    };
    stream = ::fopencookie(this, "w", functions);
    if (stream != nullptr) std::setvbuf(stream, nullptr, buffering, BUFSIZ);
  }
};

/// A C++ stream onto a C one, without a buffer of its own.
class StreamOnto final : public std::streambuf {
 public:
  explicit StreamOnto(std::FILE* file) : file_(file) {}

 protected:
  int_type overflow(int_type letter) override {
    if (traits_type::eq_int_type(letter, traits_type::eof())) return traits_type::not_eof(letter);
    return std::fputc(traits_type::to_char_type(letter), file_) == EOF ? traits_type::eof() : letter;
  }
  std::streamsize xsputn(const char* bytes, std::streamsize size) override {
    return static_cast<std::streamsize>(std::fwrite(bytes, 1, static_cast<std::size_t>(size), file_));
  }
  int sync() override { return std::fflush(file_); }

 private:
  std::FILE* file_;
};

Fence* fences[2] = {nullptr, nullptr};  // of stdout and stderr, while there are some

}  // namespace

std::string PrintableText(std::string_view text) {
  return EscapeLetters(text, true);
}

std::string PrintableLine(std::string_view text) {
  return EscapeLetters(text, false);
}

struct PrintableOutput::Content {
  Fence out, error;
  std::unique_ptr<StreamOnto> out_buffer, error_buffer;
  std::array<std::streambuf*, 3> former{};
};

PrintableOutput::PrintableOutput() : content_(std::make_unique<Content>()) {
  Log(LogLevel::kDebug,
      "");  // the log keeps the stream that it finds first, and makes its own lines printable
  Content& c = *content_;
  c.out.Open(STDOUT_FILENO, stdout, ::isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF);
  c.error.Open(STDERR_FILENO, stderr, _IONBF);
  if (c.out.stream == nullptr || c.error.stream == nullptr) return;
  stdout = c.out.stream;
  stderr = c.error.stream;
  fences[0] = &c.out;
  fences[1] = &c.error;
  c.out_buffer = std::make_unique<StreamOnto>(stdout);
  c.error_buffer = std::make_unique<StreamOnto>(stderr);
  c.former = {std::cout.rdbuf(c.out_buffer.get()), std::cerr.rdbuf(c.error_buffer.get()),
              std::clog.rdbuf(c.error_buffer.get())};
}

PrintableOutput::~PrintableOutput() {
  Content& c = *content_;
  if (fences[0] == &c.out) {
    std::cout.rdbuf(c.former[0]);
    std::cerr.rdbuf(c.former[1]);
    std::clog.rdbuf(c.former[2]);
    stdout = c.out.former;
    stderr = c.error.former;
    fences[0] = fences[1] = nullptr;
  }
  for (Fence* fence : {&c.out, &c.error}) {
    if (fence->stream == nullptr) continue;
    // a failure has been the caller's to see, at fflush
    std::fclose(fence->stream);
    (void)fence->Finish();
  }
}

void WriteControl(std::FILE* stream, std::string_view sequence) {
  for (Fence* fence : fences) {
    if (fence == nullptr || fence->stream != stream) continue;
    std::fflush(stream);
    (void)WriteWhole(fence->file, sequence);
    return;
  }
  std::fwrite(sequence.data(), 1, sequence.size(), stream);
}

}  // namespace trocar::host
