// SPDX-License-Identifier: Apache-2.0
/// \file published.h  A fingerprint of all that others see of a simulation, for tests of saving and restoring.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "trocar/base/state_archive.h"
#include "trocar/cholecystectomy/operation_judge.h"
#include "trocar/instrument/state_fields.h"
#include "trocar/math/state_fields.h"
#include "trocar/simulation/simulation.h"

namespace trocar::agent {

/// Adds any number of values to a hash, of every type that can be a field of a state.
class PublishedHash {
 public:
  template <typename... Values>
  void Add(Values... values) {
    base::StateArchive archive = base::StateArchive::ForHash(hash_);
    (archive.Field("value", values), ...);
  }
  std::uint64_t Value() const { return hash_.Value(); }

 private:
  base::StateHash hash_;
};

inline void AddSurgery(PublishedHash& hash, const simulation::OperationSnapshot& seen) {
  hash.Add(seen.tools, seen.has_current, seen.clips_left, seen.strand_is_intact, seen.blanching,
           seen.charring, seen.topology.first_triangle, seen.topology.triangle_count, seen.topology.version);
  for (std::size_t organ = 0; organ < seen.topology.triangle_count.size(); ++organ) {
    const auto first = seen.topology.first_triangle[organ];
    for (const auto& triangle :
         std::span(seen.topology.triangles).subspan(first, seen.topology.triangle_count[organ]))
      hash.Add(triangle);
  }
  for (const auto& piece : std::span(seen.topology.tube_pieces).first(seen.topology.tube_piece_count))
    hash.Add(piece.a, piece.b, piece.radius_a, piece.radius_b, piece.surface);
  for (const auto& clip : std::span(seen.clips).first(seen.clip_count))
    hash.Add(clip.X_world_clip, clip.gap, clip.is_lost, clip.is_crossed, clip.closure, clip.p_rest);
  for (const auto& cut : std::span(seen.tube_cuts).first(seen.tube_cut_count)) hash.Add(cut);
  hash.Add(seen.band_is_whole);
  for (const auto& sheet : seen.sheets)
    hash.Add(sheet.cut_length, sheet.farthest, sheet.off_area, sheet.is_free, sheet.p_farthest);
  for (const auto& leak : std::span(seen.flow.leaks).first(seen.flow.leak_count))
    hash.Add(leak.position, leak.direction, leak.fluid, leak.rate);
  for (const auto& ooze : std::span(seen.flow.oozes).first(seen.flow.ooze_count))
    hash.Add(ooze.position, ooze.rate);
  for (const auto& stone : seen.stones) hash.Add(stone.position, stone.radius, stone.place, stone.hand);
  hash.Add(seen.flow.ledger, seen.flow.p_world_pool, seen.smoke, seen.assistant.X_world_tool,
           seen.assistant.jaw, seen.assistant.is_holding);
  hash.Add(seen.procedure.measures, seen.procedure.view.criteria, seen.procedure.view.sights,
           seen.procedure.phase, seen.errors, seen.critical_errors, seen.is_organ_free, seen.is_in_bag,
           seen.is_completed);
}

inline void AddResult(PublishedHash& hash, const simulation::OperationResult& result) {
  const surgery::ErrorLog& errors = result.procedure.errors;
  for (const surgery::ErrorEntry& entry : errors.Entries())
    hash.Add(entry.error.row, entry.time, entry.place, entry.hand);
  for (std::size_t row = 0; row < errors.Table().size(); ++row)
    hash.Add(errors.Count(surgery::ErrorId(static_cast<std::uint8_t>(row))));
  const cholecystectomy::OperationDetail& detail = *cholecystectomy::FindDetail(result.procedure);
  const cholecystectomy::InjuryReport& injuries = detail.injuries;
  hash.Add(injuries.strasberg, injuries.drains_no_bile, injuries.is_right_liver_without_blood,
           injuries.bile_rate, injuries.blood_rate, injuries.structures_entering, injuries.spilled_stones,
           injuries.wrong_vessels);
  hash.Add(result.procedure.was_view_achieved, result.bed_blood, detail.facts.skeletonised,
           detail.facts.exposable, detail.facts.is_triangle_in_view, detail.facts.view_azimuth);
}

/// Of the snapshot but its clock times, and of the operation's result.
inline std::uint64_t CalcPublishedHash(const simulation::Simulation& simulation) {
  const simulation::Snapshot& seen = simulation.GetSnapshot();
  PublishedHash hash;
  hash.Add(seen.tick, seen.time, seen.positions, seen.laparoscope, seen.X_world_laparoscope, seen.residual,
           seen.iterations, seen.contacts, seen.dropped_contacts, seen.gravity, seen.event_count, seen.events,
           seen.task);
  for (const simulation::InstrumentSnapshot& tool : seen.instruments)
    hash.Add(tool.X_world_tool, tool.joints, tool.force, tool.is_grasping, tool.is_touching, tool.organ,
             tool.X_world_device, tool.pinch, tool.overlap, tool.is_touching_tool, tool.object);
  for (const simulation::OrganSnapshot& organ : seen.organs)
    hash.Add(organ.volume, organ.target, organ.pressure, organ.leaked);
  for (const scene::ObjectSnapshot& object : seen.objects)
    hash.Add(object.X_world_object, object.velocity, object.held_by, object.touched_by, object.is_at_rest,
             object.touches);
  AddSurgery(hash, seen.operation);
  if (const auto result = simulation.GetOperationResult()) AddResult(hash, *result);
  return hash.Value();
}

/// Of one cut for the haptic loop, as far as its kind fills it.
inline void AddPatch(PublishedHash& hash, const tissue::LocalPatch& patch) {
  hash.Add(patch.kind, patch.is_healthy, patch.tick, patch.X_world_tool, patch.force, patch.has_pivot);
  if (patch.kind == tissue::LocalPatch::Kind::kLinear) {
    hash.Add(patch.jacobian);
    for (const auto& press : std::span(patch.presses).first(patch.press_count))
      hash.Add(press.normal, press.force, press.stiffness);
  }
  if (patch.kind != tissue::LocalPatch::Kind::kSegment) return;
  hash.Add(patch.free_count, patch.held_count);
  for (std::size_t i = 0; i < patch.node_count; ++i)
    hash.Add(patch.node[i], patch.position[i], patch.own_stiffness[i]);
  const std::size_t links = patch.link_starts[std::size_t{patch.free_count} + patch.held_count];
  for (const auto& link : std::span(patch.links).first(links))
    hash.Add(link.other, link.is_strand, link.stiffness, link.rest_length);
  for (const auto& contact : std::span(patch.contacts).first(patch.contact_count))
    hash.Add(contact.nodes, contact.weights, contact.normal, contact.tip_normal, contact.lever, contact.depth,
             contact.stiffness);
}

/// Of the tissue around both tools, as the haptic loop gets it between two ticks.
inline std::uint64_t CalcPatchHash(simulation::Simulation& simulation) {
  PublishedHash hash;
  const auto patch = std::make_unique<tissue::LocalPatch>();
  for (const instrument::Hand hand : {instrument::kLeft, instrument::kRight}) {
    simulation.CutPatch(hand, *patch);
    AddPatch(hash, *patch);
  }
  return hash.Value();
}

}  // namespace trocar::agent
