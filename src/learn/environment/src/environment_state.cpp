// SPDX-License-Identifier: Apache-2.0
// An environment as bytes, and one more of it.
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "environment_content.h"
#include "trocar/base/assert.h"
#include "trocar/base/checksum.h"
#include "trocar/instrument/state_fields.h"
#include "trocar/math/state_fields.h"

namespace trocar::environment {
namespace {

void VisitInput(base::StateArchive& archive, scene::Input& input) {
  archive.Field("hands", input.hands);
  for (scene::HandControls& controls : input.controls) {
    archive.Field("tool", controls.tool);
    archive.Field("cut", controls.cut);
    archive.Field("coagulate", controls.coagulate);
    archive.Field("rinse", controls.rinse);
    archive.Field("aspirate", controls.aspirate);
  }
  archive.Field("assistant", input.assistant);
  archive.Field("laparoscope", input.laparoscope);
}

struct SaveHeader {
  std::array<char, 8> magic{};
  std::uint64_t version = 0, size = 0, checksum = 0;  // of what follows
};
constexpr std::array<char, 8> kSaveMagic{'T', 'R', 'O', 'C', 'E', 'N', 'V', 'S'};
constexpr std::uint64_t kSaveVersion = 1;

base::Error RefuseState(const std::string& why) {
  return base::Error{base::ErrorCode::kStateInvalid, why};
}

/// What a program that is not ours may have written.
bool IsUsable(const scene::Input& input, const scene::Scene& scene) {
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    const instrument::TrocarJoints& joints = input.hands[hand];
    for (const double joint : {joints.pan, joints.tilt, joints.spin, joints.depth, joints.jaw}) {
      if (!std::isfinite(joint)) return false;
    }
    if (input.controls[hand].tool >= scene.instruments[hand].tray.size()) return false;
  }
  for (const double joint :
       {input.laparoscope.pan, input.laparoscope.tilt, input.laparoscope.spin, input.laparoscope.depth}) {
    if (!std::isfinite(joint)) return false;
  }
  return input.assistant <= scene::AssistantCommand::kRelease;
}

bool IsUsable(const EpisodeDraw& draw) {
  Ranges ranges;
  for (std::size_t i = 0; i < kVariedCount; ++i) ranges[i] = {draw.values[i], draw.values[i]};
  if (!CheckRanges(ranges).ok()) return false;
  for (const math::Vec3& aside : draw.asides) {
    if (!(math::Norm(aside) <= 1.001)) return false;
  }
  return std::abs(draw.aside_pan) <= 1.001 && std::abs(draw.aside_tilt) <= 1.001;
}

void VisitDraw(base::StateArchive& archive, EpisodeDraw& draw) {
  archive.Field("seed", draw.seed);
  archive.Field("choice", draw.choice);
  archive.Field("values", draw.values);
  archive.Field("asides", draw.asides);
  archive.Field("aside_pan", draw.aside_pan);
  archive.Field("aside_tilt", draw.aside_tilt);
}

}  // namespace

void Progress::VisitState(base::StateArchive& archive) {
  auto row = std::bit_cast<std::uint64_t>(episodes);
  archive.Field("episodes", row);
  episodes = std::bit_cast<math::Random>(row);
  for (Range& range : ranges) {
    archive.Field("low", range.low);
    archive.Field("high", range.high);
  }
  archive.Field("actions", actions);
  archive.Field("is_begun", is_begun);
  archive.Field("is_over", is_over);
  VisitInput(archive, input);
  for (scene::Input& one : late) VisitInput(archive, one);
}

void Environment::Save(std::vector<std::byte>& bytes) const {
  Content& now = *content_;
  bytes.resize(sizeof(SaveHeader));
  now.simulation.Save(now.saved);
  base::StateArchive archive = base::StateArchive::ForSave(bytes);
  VisitDraw(archive, now.draw);
  archive.Field("progress", now.progress);
  archive.Field("simulation", now.saved);
  const auto content = std::span<const std::byte>(bytes).subspan(sizeof(SaveHeader));
  const SaveHeader header{kSaveMagic, kSaveVersion, content.size(), base::CalcChecksum(content)};
  std::memcpy(bytes.data(), &header, sizeof(header));
}

base::Status Environment::Restore(std::span<const std::byte> bytes) {
  SaveHeader header;
  if (bytes.size() < sizeof(header))
    return RefuseState("a saved environment ends within its header; save it again");
  std::memcpy(&header, bytes.data(), sizeof(header));
  const auto content = bytes.subspan(sizeof(header));
  if (header.magic != kSaveMagic) return RefuseState("these bytes are no saved environment");
  if (header.version != kSaveVersion) {
    return RefuseState("the environment was saved in format " + std::to_string(header.version) +
                       ", this program reads " + std::to_string(kSaveVersion) + "; save it again");
  }
  if (header.size != content.size() || header.checksum != base::CalcChecksum(content))
    return RefuseState(
        "the saved environment is damaged: its checksum does not fit; take another copy of it");

  Content& now = *content_;
  EpisodeDraw draw;
  base::StateArchive archive = base::StateArchive::ForRestore(content);
  VisitDraw(archive, draw);
  if (!archive.ok() || !IsUsable(draw))
    return RefuseState("what a saved environment has drawn is out of range");
  Progress progress;
  progress.late.resize(now.LateTicks(draw));
  archive.Field("progress", progress);
  archive.Field("simulation", now.saved);
  if (!archive.ok() || !archive.IsAtEnd())
    return RefuseState("the saved environment is of other settings: " + archive.Failure());
  const scene::Scene& scene = now.simulation.GetScene();
  bool is_usable = CheckRanges(progress.ranges).ok() && IsUsable(progress.input, scene);
  for (const scene::Input& late : progress.late) is_usable = is_usable && IsUsable(late, scene);
  if (!is_usable) return RefuseState("a saved environment has numbers out of range");

  auto place = now.FindPlace(draw);
  if (!place.ok()) return place.error();
  simulation::Simulation& entered = place->simulation ? *place->simulation : now.simulation;
  // of another state of the same model a simulation takes back what it cannot read; of where it began it knows nothing
  if (const auto restored = entered.Restore(now.saved); !restored) return restored;
  if (place->simulation || !now.progress.is_begun || draw != now.draw) {
    entered.Reset(CalcStart(entered.GetScene(), draw));
    const auto again = entered.Restore(now.saved);
    TROCAR_ASSERT(again.ok());  // it was taken up a moment ago
  }
  now.Take(std::move(*place), draw);
  now.progress = std::move(progress);
  const scene::LiveSettings settings = now.CalcSettings(draw);
  now.progress.input.settings = settings;
  for (scene::Input& late : now.progress.late) late.settings = settings;
  if (now.observer) now.observer(now.simulation, nullptr);
  return {};
}

base::Result<Environment> Environment::Clone() const {
  Content& now = *content_;
  auto simulation = simulation::Simulation::Make(now.of);
  if (!simulation.ok()) return simulation.error();
  auto content = std::make_unique<Content>(now.model, now.of, std::move(*simulation));
  content->draw = now.draw;
  content->layout = now.layout;
  content->progress = now.progress;
  if (now.progress.is_begun) content->simulation.Reset(CalcStart(now.simulation.GetScene(), now.draw));
  now.simulation.Save(now.saved);
  const auto restored = content->simulation.Restore(now.saved);
  TROCAR_ASSERT(restored.ok());  // saved by a simulation of the same model
  return Environment(std::move(content));
}

}  // namespace trocar::environment
