// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/sha256.h"

#include <sodium.h>

#include <array>
#include <fstream>
#include <vector>

#include "trocar/base/assert.h"

namespace trocar::host {
namespace {

class Sha256 {
 public:
  Sha256() {
    [[maybe_unused]] const int started = ::sodium_init();  // again does nothing
    TROCAR_ASSERT(started >= 0);
    ::crypto_hash_sha256_init(&state_);
  }
  void Add(const char* bytes, std::size_t count) {
    ::crypto_hash_sha256_update(&state_, reinterpret_cast<const unsigned char*>(bytes), count);
  }
  std::string TakeDigits() {
    std::array<unsigned char, crypto_hash_sha256_BYTES> hash;
    ::crypto_hash_sha256_final(&state_, hash.data());
    std::string text(2 * hash.size() + 1, '\0');
    ::sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
    text.pop_back();  // its terminating zero
    return text;
  }

 private:
  crypto_hash_sha256_state state_;
};

}  // namespace

std::string CalcSha256(std::string_view text) {
  Sha256 hash;
  hash.Add(text.data(), text.size());
  return hash.TakeDigits();
}

base::Result<std::string> CalcSha256OfFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return base::Error{base::ErrorCode::kFileMissing, file.string() + " cannot be opened; check the path"};
  Sha256 hash;
  std::vector<char> part(1u << 20);
  while (stream) {
    stream.read(part.data(), static_cast<std::streamsize>(part.size()));
    hash.Add(part.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (!stream.eof())
    return base::Error{base::ErrorCode::kFileUnreadable,
                       file.string() + " cannot be read to its end; check the disk"};
  return hash.TakeDigits();
}

}  // namespace trocar::host
