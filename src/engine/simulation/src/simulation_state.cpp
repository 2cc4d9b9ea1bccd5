// SPDX-License-Identifier: Apache-2.0
// A simulation's state as one value: what it consists of, and its bytes.
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>

#include "simulation_content.h"
#include "trocar/base/assert.h"
#include "trocar/base/checksum.h"
#include "trocar/base/state_hash.h"
#include "trocar/instrument/state_fields.h"
#include "trocar/math/state_fields.h"
#include "trocar/simulation/saved_state.h"

namespace trocar::simulation {
namespace {

/// Before the fields of a saved state.
struct Header {
  std::array<char, 8> magic{};
  std::uint64_t version = 0;      // of the list of fields
  std::uint64_t fingerprint = 0;  // of the model
  std::uint64_t size = 0;         // of the fields [bytes]
  std::uint64_t checksum = 0;     // of the fields
};
constexpr std::array<char, 8> kMagic{'T', 'R', 'O', 'C', 'S', 'T', 'A', 'T'};
/// Counts up whenever a field comes, goes or changes its meaning.
constexpr std::uint64_t kVersion = 2;

base::Error Refuse(std::string why) {
  return {base::ErrorCode::kStateInvalid, std::move(why)};
}

/// The fields behind a header that belongs to this model and to these fields.
base::Result<std::span<const std::byte>> ReadHeader(const SimulationModel& model,
                                                    std::span<const std::byte> bytes) {
  Header header;
  if (bytes.size() < sizeof(header)) return Refuse("a saved state ends within its header; save it again");
  std::memcpy(&header, bytes.data(), sizeof(header));
  const auto fields = bytes.subspan(sizeof(header));
  if (header.magic != kMagic) return Refuse("this is no saved state of Trocar");
  if (header.version != kVersion) {
    return Refuse("the state was saved in format " + std::to_string(header.version) +
                  ", this program reads " + std::to_string(kVersion) + "; save it again with this version");
  }
  if (header.fingerprint != model.fingerprint && header.fingerprint != model.first_fingerprint)
    return Refuse(
        "the state was saved of another scene, patient or seed; restore it into the one it came from");
  if (header.size != fields.size() || header.checksum != base::CalcChecksum(fields))
    return Refuse("the state is damaged: its checksum does not fit; take another copy of it");
  return fields;
}

}  // namespace

void Simulation::Content::Save(std::vector<std::byte>& bytes, const AlterField& alter) {
  bytes.resize(sizeof(Header));
  base::StateArchive archive = base::StateArchive::ForSave(bytes);
  std::size_t begin = bytes.size();
  if (alter) {
    archive.Trace([&](const std::string& field, std::uint64_t) {
      alter(field, std::span(bytes).subspan(std::exchange(begin, bytes.size())));
    });
  }
  VisitState(archive);
  const auto fields = std::span<const std::byte>(bytes).subspan(sizeof(Header));
  const Header header{kMagic, kVersion, model->fingerprint, fields.size(), base::CalcChecksum(fields)};
  std::memcpy(bytes.data(), &header, sizeof(header));
}

void Simulation::Content::VisitState(base::StateArchive& archive) {
  VisitWorld(archive);
  VisitJudgement(archive);
}

void Simulation::Content::VisitWorld(base::StateArchive& archive) {
  WorldState& w = world;
  archive.Field("tick", w.tick);
  if (w.operation != nullptr) {
    archive.Field("topology", w.topology);
    w.operation->VisitTopology(archive);
    // what is sized by nodes and springs is made for them before it is restored
    if (archive.IsRestoring() && archive.ok()) w.topology.Restored();
  }
  archive.Field("tissue", w.tissue);
  archive.Field("conserved", w.conserved);
  archive.Field("good_conserved", w.good_conserved);
  archive.Field("guard", *w.guard);
  archive.Field("joints", w.joints);
  archive.Field("grasps", w.grasps);
  archive.Field("forces", w.forces);
  archive.Field("touched_organs", tick.touched_organs);
  if (archive.IsRestoring() && archive.ok()) w.touch.Refit(w.tissue);
  archive.Field("contacts", w.touch);
  archive.Field("rigid", w.rigid);
  if (w.operation != nullptr) archive.Field("operation", *w.operation);
  archive.Field("camera_holder", w.camera_holder);
  archive.Field("laparoscope", w.laparoscope);
  if (!archive.IsRestoring() || !archive.ok()) return;
  const std::size_t nodes = w.tissue.position.size();
  for (const surgery::Grasp& grasp : w.grasps) {
    const auto held = grasp.Nodes();
    if (std::any_of(held.begin(), held.end(), [&](std::uint32_t node) { return node >= nodes; })) {
      archive.Fail("a grasp holds a node that there is not");
      return;
    }
  }
}

void Simulation::Content::VisitJudgement(base::StateArchive& archive) {
  JudgementState& j = judgement;
  if (j.procedure != nullptr) archive.Field("judge", *j.procedure);
  archive.Field("task_monitor", j.monitor);
  archive.Field("task", j.task);
  archive.Field("events", j.events);
  archive.Field("event_count", j.event_count);
  archive.Field("was_frozen", j.was_frozen);
  archive.Field("were_tools_touching", j.were_tools_touching);
  // of the last solve, for those who look
  for (tissue::OrganVolume& organ : world.conserved.organs) archive.Field("organ_volume", organ.volume);
  archive.Field("gravity", tick.gravity);
  archive.Field("stiffness_scale", tick.load.stiffness_scale);
  archive.Field("shape_scale", tick.load.shape_scale);
  archive.Field("residual", tick.report.residual);
  archive.Field("iterations", tick.report.iterations);
}

base::Status Simulation::Content::Restore(base::StateArchive& archive) {
  tick.facts.Clear();
  VisitState(archive);
  if (!archive.ok()) return Refuse("the saved state does not fit: " + archive.Failure());
  if (!archive.IsAtEnd()) return Refuse("the saved state goes on after its last field");
  // the volumes as of the last good tick: a bad one that follows takes them back
  for (std::size_t i = 0; i < world.conserved.organs.size(); ++i)
    world.good_conserved.organs[i].volume = world.conserved.organs[i].volume;
  // what is asked between ticks, the force on a hand among it, sees the load of the last one
  tick.load.gravity = tick.gravity - kImagingGravity;
  tick.load.contacts = world.touch.Contacts().springs;
  tick.load.external_force = {};
  // nor is a patch for a haptic device healthy where the last tick was bad
  tick.verdict = world.guard->LastVerdict();
  // the rest of a tick's scratch is made in the next one
  tick.changes = {};
  tick.torn_count = tick.torn_spring_count = 0;
  tick.has_cut = false;
  tick.solved_condition = world.tissue.condition;
  if (world.operation != nullptr) snapshot.operation.topology.version = ~std::uint32_t{0};
  Publish();
  snapshot.task = judgement.task;
  return {};
}

void Simulation::Reset() {
  const base::Status restored = Restore(content_->model->start);
  TROCAR_ASSERT(restored.ok());  // saved by this simulation
}

void Simulation::Save(std::vector<std::byte>& bytes) const {
  content_->Save(bytes);
}

void Simulation::SaveAltered(std::vector<std::byte>& bytes, const AlterField& alter) const {
  content_->Save(bytes, alter);
}

base::Status Simulation::Restore(std::span<const std::byte> bytes) {
  return RestoreWithout(bytes, "");
}

base::Status Simulation::RestoreWithout(std::span<const std::byte> bytes, const std::string& field) {
  Content& c = *content_;
  const auto fields = ReadHeader(*c.model, bytes);
  if (!fields.ok()) return fields.error();
  std::vector<std::byte> before;
  c.Save(before);
  base::StateArchive archive = base::StateArchive::ForRestore(*fields);
  archive.Omit(field);
  base::Status restored = c.Restore(archive);
  if (!restored.ok()) {
    base::StateArchive back =
        base::StateArchive::ForRestore(std::span<const std::byte>(before).subspan(sizeof(Header)));
    const base::Status as_before = c.Restore(back);
    TROCAR_ASSERT(as_before.ok());  // saved by this simulation
  }
  return restored;
}

bool AreSameState(std::span<const std::byte> a, std::span<const std::byte> b) noexcept {
  constexpr std::size_t kFrom = offsetof(Header, fingerprint), kTo = kFrom + sizeof(Header::fingerprint);
  return a.size() == b.size() && a.size() >= kTo && std::equal(a.begin(), a.begin() + kFrom, b.begin()) &&
         std::equal(a.begin() + kTo, a.end(), b.begin() + kTo);
}

std::uint64_t Simulation::ModelFingerprint(ModelFingerprintKind kind) const {
  return kind == ModelFingerprintKind::kFirst ? content_->model->first_fingerprint
                                              : content_->model->fingerprint;
}

std::uint64_t Simulation::Hash(StatePart part) const {
  base::StateHash hash;
  base::StateArchive archive = base::StateArchive::ForHash(hash);
  content_->VisitWorld(archive);
  if (part == StatePart::kAll) content_->VisitJudgement(archive);
  return hash.Value();
}

std::vector<std::pair<std::string, std::uint64_t>> Simulation::HashFields() const {
  std::vector<std::pair<std::string, std::uint64_t>> fields;
  base::StateHash hash;
  base::StateArchive archive = base::StateArchive::ForHash(hash);
  archive.Trace([&](const std::string& path, std::uint64_t value) { fields.emplace_back(path, value); });
  content_->VisitState(archive);
  return fields;
}

}  // namespace trocar::simulation
