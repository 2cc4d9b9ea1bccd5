// SPDX-License-Identifier: Apache-2.0
/// \file gallstone_spill.h  The patient's gallstones: inside, spilled, between jaws, in the bag, sucked up.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/base/state_archive.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/instrument/hand.h"
#include "trocar/instrument/tool.h"
#include "trocar/surgery/flow_network.h"
#include "trocar/surgery/gallstones.h"
#include "trocar/surgery/surgery_settings.h"
#include "trocar/surgery/surgery_snapshot.h"
#include "trocar/surgery/wall_holes.h"

namespace trocar::surgery {

class GallstoneSpill {
 public:
  static constexpr std::size_t kMostOthers = VesselActs::kMostClips;  ///< of Move

  /// No stones.
  GallstoneSpill() = default;
  /// \param diameters  see DrawGallstones [m]; all are inside
  /// \param omentum    where they come to lie when they fall beside the organs; fixed
  /// \return kMeshInvalid
  static base::Result<GallstoneSpill> Make(std::span<const double> diameters, geometry::TriangleMesh omentum,
                                           const StoneSettings& settings = {});
  /// All are inside again.
  void Reset() noexcept;

  bool HasInside() const noexcept;

  /// Spills the stones that the bile takes with it as it runs out of a hole in this tick.
  /// \param leaked, content  see CalcStoneOutflow
  /// \return how many
  int Spill(double leaked, double content, const WallHole& hole) noexcept;

  /// Falling, sliding, lying; those that are held move with their tools.
  /// \param ground  without the omentum, which is this one's
  /// \param others  lost clips, which fall as stones do, before them; without an omentum they stay where they are
  void Move(StoneGround ground, std::span<const math::Pose> X_world_tools,
            std::span<LooseStone* const> others, double seconds) noexcept;
  /// The triangles of organs have changed.
  void ForgetSupports() noexcept;

  /// Jaws that close on a stone take it and close no further; jaws that open far enough let go of it.
  /// \param jaw_before, jaw  before and after this tick's movement [rad]
  /// \param can_take  the tool has jaws to hold, and they hold nothing else
  /// \return the jaws' opening that the stone allows [rad]
  double StopJaw(int hand, const instrument::Tool& tool, const math::Pose& X_world_tool, double jaw_before,
                 double jaw, bool can_take) noexcept;
  /// Index of the stone, or -1.
  std::int32_t HeldBy(int hand) const noexcept { return held_[static_cast<std::size_t>(hand)]; }
  double HeldDiameter(int hand) const noexcept;

  // Retrieval of stones; each function returns how many
  /// \param bore  diameter of the sucker's bore [m]
  int Aspirate(const math::Vec3& p_world_tip, double bore) noexcept;
  /// Catches the stones that fall into the open bag because they were let go over it.
  int CatchInBag(const math::Pose& X_world_bag) noexcept;
  /// The stone that a hand holds leaves through its trocar.
  int TakeOut(int hand) noexcept;
  /// Stones that lie on an organ go with it.
  int BagWith(std::int32_t organ) noexcept;

  /// Stones that were taken between jaws since the last call, by hand.
  bool HasTaken(int hand) noexcept;

  StoneCount Count() const noexcept;
  std::size_t Size() const noexcept { return stones_.size(); }
  /// \pre At least Size() (TROCAR_ASSERT)
  void Publish(std::span<StoneSnapshot> stones) const noexcept;
  void VisitState(base::StateArchive& archive);

 private:
  struct Stone {
    LooseStone body;
    StonePlace place = StonePlace::kInside;
    double opening = 0;  // of the jaws that hold it [rad]
    math::Vec3 p_tool;   // while held [m]
    void VisitState(base::StateArchive& archive);
  };
  /// The omentum, constant.
  struct Bed {
    geometry::TriangleMesh mesh;
    OrganSurface surface;
  };
  void AddSpilled() noexcept;
  void LetGo(int hand) noexcept;

  StoneSettings settings_;  // constant
  std::vector<Stone> stones_;
  std::vector<LooseStone*> loose_;  // scratch
  std::shared_ptr<const Bed> bed_;  // shared by copies, which differ in state alone
  std::array<std::int32_t, instrument::kHandCount> held_{-1, -1};
  std::array<bool, instrument::kHandCount> has_taken_{};
  double carried_ = 0;  // part of a stone that has come to the hole
};

}  // namespace trocar::surgery
