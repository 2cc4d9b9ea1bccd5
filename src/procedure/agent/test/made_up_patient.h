// SPDX-License-Identifier: Apache-2.0
/// \file made_up_patient.h  A gallbladder of nine nodes on a liver of nine, with a cystic duct, a cystic artery and a hepatic duct:
/// what the surgeon of a cholecystectomy knows, sees and remembers, without a simulation.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "act_list.h"
#include "cholecystectomy_steps.h"
#include "operation_memory.h"
#include "patient_knowledge.h"
#include "planner_hands.h"
#include "surgeon_view.h"
#include "trocar/cholecystectomy/cholecystectomy.h"
#include "trocar/instrument/tool.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::agent {

struct MadeUpPatient {
  static constexpr std::uint32_t kNodes = 9;  // of the gallbladder, of the liver and of each tube
  static constexpr std::uint32_t kLiver = 9;  // first row
  static constexpr std::array<std::uint32_t, 3> kTubes = {18, 27, 36};  // likewise
  static constexpr double kSpacing = 0.010;                             // along the bed [m]

  scene::Scene scene;
  PatientKnowledge known;
  simulation::Snapshot seen;
  OrganClearance organs;  // none
  cholecystectomy::TriangleSight sight;
  OperationMemory memory{{HandAt({-0.08, 0, 0.15}, {0, 0, 0.05}), HandAt({0.08, 0, 0.15}, {0.02, 0, 0.05})}};
  ActList plan{scene.instruments};

  /// The gallbladder lies from the neck along x, 4 mm above the liver; the tubes leave the neck along -x, side by side.
  MadeUpPatient() {
    scene::SizeSnapshot(cholecystectomy::Cholecystectomy(), seen.operation.procedure);
    const auto add = [&](const char* name, const math::Vec3& from, const math::Vec3& to) {
      scene::SurfaceInfo surface;
      surface.name = name;
      surface.first_node = static_cast<std::uint32_t>(known.rest.size());
      surface.node_count = kNodes;
      for (std::uint32_t k = 0; k < kNodes; ++k) known.rest.push_back(math::Lerp(from, to, k / 8.0));
      known.surfaces.push_back(surface);
    };
    add("gallbladder", {0, 0, 0.004}, {0.080, 0, 0.004});
    add("liver", {0, 0, 0}, {0.080, 0, 0});
    add("cystic duct", {0, 0, 0.004}, {-0.032, 0, 0.004});
    add("cystic artery", {0, 0.010, 0.004}, {-0.032, 0.010, 0.004});
    add("hepatic duct", {-0.040, -0.030, 0.004}, {-0.040, 0.030, 0.004});
    known.gallbladder = 0;
    known.liver = 1;
    known.first_tube = 2;
    known.cystic_duct = 0;
    known.cystic_artery = 1;
    known.hepatic_duct = 2;
    for (const std::uint32_t first : kTubes) {
      std::vector<std::uint32_t> nodes;
      for (std::uint32_t k = 0; k < kNodes; ++k) nodes.push_back(first + k);
      known.tube_nodes.push_back(nodes);
      known.tube_radii.emplace_back(kNodes, 0.00125);
    }
    known.is_artery = {0, 1, 0};
    known.entering = {0, 1};
    known.exposable = {0.032, 0.032, 0};
    known.main_nodes = known.main_ducts = known.tube_nodes[2];
    known.neck = 0;
    known.hold = 2;
    known.fundus = 8;
    known.liver_node = kLiver;
    known.bed_normal = {0, 0, 1};
    using Kind = scene::StrandInfo::Kind;
    const auto tie = [&](std::uint32_t a, std::uint32_t b, Kind kind) {
      scene::StrandInfo strand;
      strand.a = a;
      strand.b = b;
      strand.kind = kind;
      known.strands.push_back(strand);
      return static_cast<std::uint32_t>(known.strands.size() - 1);
    };
    for (std::uint32_t k = 0; k < kNodes; ++k) tie(k, kLiver + k, Kind::kBed);
    for (std::uint32_t k = 1; k < kNodes; ++k)
      known.window_strands.push_back(tie(kTubes[0] + k, kTubes[1] + k, Kind::kTriangle));
    for (const std::uint32_t first : {kTubes[0], kTubes[1]})
      known.end_strands.push_back(tie(first, 0, Kind::kEnd));
    seen.positions = known.rest;
    seen.operation.strand_is_intact.assign(known.strands.size(), 1);
    seen.operation.assistant.is_there = true;
    for (const char* name : {"maryland", "hook", "clip_applier", "scissors", "bag"})
      scene.instruments[instrument::kRight].tray.push_back(*instrument::FindTool(name));
    scene.instruments[instrument::kLeft].tray.push_back(*instrument::FindTool("grasper"));
    scene.laparoscope.p_world_port = {0, 0.03, 0.18};
  }
  SurgeonView View() { return {scene, known, seen, memory.hands, organs, sight, 0.0}; }

  void PartBed(std::uint32_t count) {
    for (std::uint32_t k = 0; k < count; ++k) seen.operation.strand_is_intact[k] = 0;
  }
  void PartTriangle() {
    for (const std::uint32_t strand : known.window_strands) seen.operation.strand_is_intact[strand] = 0;
    seen.operation.procedure.measures[cholecystectomy::kClearedShare] = 1.0;
  }
  /// As many pieces as it had nodes.
  void DivideTube(std::uint32_t tube) {
    auto& topology = seen.operation.topology;
    surgery::TubePiece piece;
    piece.surface = static_cast<std::uint32_t>(known.first_tube) + tube;
    topology.tube_pieces.insert(topology.tube_pieces.end(), kNodes, piece);
    topology.tube_piece_count = topology.tube_pieces.size();
  }
  void AddClip(const math::Vec3& p) {
    surgery::ClipSnapshot clip;
    clip.X_world_clip.translation = p;
    seen.operation.clips.push_back(clip);
    seen.operation.clip_count = seen.operation.clips.size();
  }
};

}  // namespace trocar::agent
