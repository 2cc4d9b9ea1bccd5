// SPDX-License-Identifier: Apache-2.0
/// \file stone_work.h  The patient's gallstones: inside, spilled, between jaws, in the bag, sucked up.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "trocar/core/state_archive.h"
#include "trocar/instrument/tool.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/operation_result.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/surgery/gallstones.h"
#include "trocar/surgery/wall_holes.h"

namespace trocar::simulation {

using scene::Scene;
using scene::SurfaceInfo;
using scene::VisitState;
using surgery::WallHole;

/// How many stones a patient has, and how large: by the patient's parameters, else by the scene.
surgery::GallstoneSettings FindGallstones(const Scene& scene);

class StoneWork {
 public:
  static constexpr std::size_t kMostOthers = surgery::VesselActs::kMostClips;  ///< of Move

  /// Gallstones of a scene; none where it has none.
  /// \param surfaces, positions  at rest: what the omentum passes under, where stones come to lie
  /// \return kMeshInvalid
  static core::Result<StoneWork> Make(const Scene& scene, std::span<const SurfaceInfo> surfaces,
                                      std::span<const Vec3> positions);
  /// All are inside again.
  void Reset() noexcept;

  bool HasInside() const noexcept;

  /// What ran out of the hole in this tick takes stones with it.
  /// \param leaked, content  see surgery::CalcStoneOutflow
  /// \return how many
  int Spill(double leaked, double content, const WallHole& hole) noexcept;

  /// Falling, sliding, lying; those that are held move with their tools.
  /// \param ground  without the omentum, which is this one's
  /// \param others  what falls as stones do, before them: lost clips; without an omentum they stay where they are
  void Move(surgery::StoneGround ground, std::span<const Pose> X_world_tools,
            std::span<surgery::LooseStone* const> others, double seconds) noexcept;
  /// The triangles of organs have changed.
  void ForgetSupports() noexcept;

  /// Jaws that close on a stone take it and close no further; jaws that open far enough let go of it.
  /// \param jaw_before, jaw  before and after this tick's movement [rad]
  /// \param can_take  the tool has jaws to hold, and they hold nothing else
  /// \return the jaws' opening that the stone allows [rad]
  double StopJaw(int hand, const instrument::Tool& tool, const Pose& X_world_tool, double jaw_before,
                 double jaw, bool can_take) noexcept;
  /// Index of the stone, or -1.
  std::int32_t HeldBy(int hand) const noexcept { return held_[static_cast<std::size_t>(hand)]; }
  double HeldDiameter(int hand) const noexcept;

  // What retrieves stones; each returns how many
  /// \param bore  diameter of the sucker's bore [m]
  int Aspirate(const Vec3& p_world_tip, double bore) noexcept;
  /// What was let go over the open bag falls into it.
  int CatchInBag(const Pose& X_world_bag) noexcept;
  /// The stone that a hand holds leaves through its trocar.
  int TakeOut(int hand) noexcept;
  /// Stones that lie on an organ go with it.
  int BagWith(std::int32_t organ) noexcept;

  /// Stones that were taken between jaws since the last call, by hand.
  bool HasTaken(int hand) noexcept;

  StoneCount Count() const noexcept;
  void Size(OperationSnapshot& snapshot) const { snapshot.stones.assign(stones_.size(), {}); }
  void Publish(OperationSnapshot& snapshot) const noexcept;
  void VisitState(core::StateArchive& archive);

 private:
  struct Stone {
    surgery::LooseStone body;
    StonePlace place = StonePlace::kInside;
    double opening = 0;  // of the jaws that hold it [rad]
    Vec3 p_tool;         // while held [m]
    void VisitState(core::StateArchive& archive);
  };
  /// The omentum, constant.
  struct Bed {
    geometry::TriangleMesh mesh;
    surgery::OrganSurface surface;
  };
  void AddSpilled() noexcept;
  void LetGo(int hand) noexcept;

  std::vector<Stone> stones_;
  std::vector<surgery::LooseStone*> loose_;  // scratch
  std::shared_ptr<const Bed> bed_;           // shared by copies, which differ in state alone
  std::array<std::int32_t, kHandCount> held_{-1, -1};
  std::array<bool, kHandCount> has_taken_{};
  double carried_ = 0;  // part of a stone that has come to the hole
};

}  // namespace trocar::simulation
