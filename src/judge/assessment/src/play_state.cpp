// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/play_state.h"

#include <cstddef>
#include <string>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/files/state_file.h"
#include "trocar/simulation/engine_bits.h"

namespace trocar::assessment {

base::Status RestorePlay(const std::filesystem::path& path, const std::string& who,
                         simulation::Simulation& simulation, agent::Surgeon& surgeon) {
  const auto player = files::ReadStateFile(path, simulation);
  if (!player) return player.error();
  base::StateArchive archive = base::StateArchive::ForRestore(*player);
  std::string saved_by;
  archive.Field("who", saved_by);
  int bits = 0;
  archive.Field("engine_bits", bits);
  if (archive.ok() && saved_by == who && bits != simulation::kEngineBits) {
    return base::Error{base::ErrorCode::kStateInvalid,
                       path.string() + " was saved by engine " + std::to_string(bits) +
                           ", and this program is engine " + std::to_string(simulation::kEngineBits) +
                           "; save it again with this version"};
  }
  if (saved_by == who) surgeon.VisitState(archive);
  if (archive.ok() && archive.IsAtEnd()) return {};
  return base::Error{
      base::ErrorCode::kStateInvalid,
      path.string() + " was not saved with this surgeon; name the one that played, with the same --seed"};
}

base::Status SavePlay(const std::filesystem::path& path, const std::string& who,
                      const simulation::Simulation& simulation, agent::Surgeon& surgeon) {
  std::vector<std::byte> player;
  base::StateArchive archive = base::StateArchive::ForSave(player);
  std::string saved_by = who;
  archive.Field("who", saved_by);
  int bits = simulation::kEngineBits;
  archive.Field("engine_bits", bits);
  surgeon.VisitState(archive);
  return files::WriteStateFile(path, simulation, player);
}

}  // namespace trocar::assessment
