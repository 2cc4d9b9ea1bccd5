// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/state_file.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "trocar/base/state_hash.h"
#include "trocar/host/safe_file.h"

namespace trocar::files {
namespace {

constexpr std::array<char, 8> kMagic{'T', 'R', 'O', 'C', 'F', 'I', 'L', 'E'};
/// Far beyond the state of any patient; a larger file is none.
constexpr std::size_t kLargestFile = std::size_t{256} << 20;

/// Before the two parts of a file.
struct FileHeader {
  std::array<char, 8> magic{};
  std::uint64_t simulation_size = 0, player_size = 0;  // [bytes]
  std::uint64_t player_checksum = 0;
};

std::uint64_t CalcChecksum(std::span<const std::byte> bytes) {
  base::StateHash hash;
  for (const std::byte byte : bytes) hash.Add(static_cast<std::uint64_t>(byte));
  return hash.Value();
}

}  // namespace

base::Status WriteStateFile(const std::filesystem::path& path, const simulation::Simulation& simulation,
                            std::span<const std::byte> player) {
  std::vector<std::byte> state;
  simulation.Save(state);
  const FileHeader header{kMagic, state.size(), player.size(), CalcChecksum(player)};
  std::string content(sizeof(header) + state.size() + player.size(), '\0');
  std::memcpy(content.data(), &header, sizeof(header));
  std::memcpy(content.data() + sizeof(header), state.data(), state.size());
  if (!player.empty())
    std::memcpy(content.data() + sizeof(header) + state.size(), player.data(), player.size());
  return host::WriteFile(path, content);
}

base::Result<std::vector<std::byte>> ReadStateFile(const std::filesystem::path& path,
                                                   simulation::Simulation& simulation) {
  const auto content = host::ReadFile(path, kLargestFile);
  if (!content) return content.error();
  const auto refuse = [&](const char* why) {
    return base::Error{base::ErrorCode::kStateInvalid, path.string() + " " + why};
  };
  FileHeader header;
  if (content->size() < sizeof(header)) return refuse("ends within its header; save the state again");
  std::memcpy(&header, content->data(), sizeof(header));
  if (header.magic != kMagic) return refuse("is no saved state of Trocar; --save writes one");
  const std::size_t rest = content->size() - sizeof(header);
  if (header.simulation_size > rest || header.player_size != rest - header.simulation_size)
    return refuse("is damaged: it has another length than it says; take another copy of it");
  const auto bytes = std::as_bytes(std::span(*content)).subspan(sizeof(header));
  const auto player = bytes.subspan(header.simulation_size);
  if (CalcChecksum(player) != header.player_checksum)
    return refuse("is damaged: a checksum does not fit; take another copy of it");
  const base::Status restored = simulation.Restore(bytes.first(header.simulation_size));
  if (!restored.ok())
    return base::Error{restored.error().code, path.string() + ": " + restored.error().message};
  return std::vector<std::byte>(player.begin(), player.end());
}

}  // namespace trocar::files
