// SPDX-License-Identifier: Apache-2.0
/// \file vessels.h  Ducts and arteries with their clips, cuts and holes, and what runs out of them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/instrument/tool.h"
#include "trocar/surgery/cuttable_tubes.h"
#include "trocar/surgery/gallstones.h"
#include "trocar/surgery/surgery_settings.h"
#include "trocar/surgery/surgery_snapshot.h"
#include "trocar/surgery/vessel_map.h"
#include "trocar/tissue/conservation.h"

namespace trocar::surgery {

/// Where along a tube something is.
struct TubePlace {
  std::uint32_t tube = 0;
  double arc = 0;  ///< from the tube's first point, at rest [m]
};

/// Result of closing a clip applier's jaws.
struct ClipResult {
  enum class Kind : std::uint8_t {
    kClosed,   ///< around the whole vessel
    kPartial,  ///< around a part of it
    kLost      ///< around nothing
  } kind = Kind::kLost;
  TubePlace place;
  bool is_crossed = false;  ///< lies over another clip
};

/// A hand that holds a duct or vessel.
struct ClipPull {
  std::span<const std::uint32_t> nodes;  ///< that it holds
  math::Vec3 force;                      ///< with which it pulls, world frame [N]
};

struct SlippedClip {
  TubePlace place;
  math::Vec3 position;  ///< where it fell off, world frame [m]
};

/// A duct or artery at rest.
struct VesselTube {
  std::uint32_t first_node = 0;        ///< of its points, in order along it
  std::span<const math::Vec3> points;  ///< (n) [m]
  std::span<const double> radii;       ///< (n) outside [m]
};

/// The ducts and arteries of one operation. Points of the graph of CuttableTubes are points here.
class Vessels {
 public:
  /// \param map    of these tubes
  /// \param tubes  only read while this is made
  /// \param first_spare, spare_count  nodes for the ends of cuts
  Vessels(VesselMap map, std::span<const VesselTube> tubes, std::uint32_t first_spare,
          std::uint32_t spare_count, const VesselSettings& settings = {});

  const VesselMap& Map() const { return map_; }
  const VesselActs& Acts() const { return acts_; }
  const CuttableTubes& Tubes() const { return tubes_; }
  /// Where a place was at rest, world frame [m].
  math::Vec3 RestPoint(const TubePlace& place) const noexcept;
  std::uint32_t TubeOf(std::uint32_t point) const { return tube_of_[point]; }
  double ArcOf(std::uint32_t point) const { return arc_of_[point]; }
  void ReserveFor(TopologyChange& change) const { tubes_.ReserveFor(change); }

  /// Cuts what a blade passed over.
  /// \param[out] places  of the cuts; at least CuttableTubes::kMostCuts
  /// \return how many
  /// \note Real-time safe within the capacity of `change`.
  std::size_t Cut(const BladeMove& move, const tissue::TissueDefinition& definition,
                  std::span<const math::Vec3> position, TopologyChange& change,
                  std::span<TubePlace> places) noexcept;

  /// A place of a vessel between the legs of a clip.
  struct Caught {
    std::uint32_t a = 0, b = 0;  ///< points of the edge
    double t = 0;                ///< from a to b
    double jaw_at = 0;           ///< along the jaws, 0 at the hinge to 1 at the tips
    double radius = 0;           ///< [m]
    void VisitState(base::StateArchive& archive);
  };
  /// Finds the place of a vessel that lies between open jaws; nothing where there is none.
  /// \note Real-time safe.
  std::optional<Caught> Catch(const instrument::Tool& tool, const math::Pose& X_world_tool, double jaw,
                              std::span<const math::Vec3> position) const noexcept;
  /// Closes a clip around what was caught when the jaws began to close.
  /// \note Real-time safe.
  ClipResult Clip(const instrument::Tool& tool, const math::Pose& X_world_tool,
                  const std::optional<Caught>& caught, std::span<const math::Vec3> position) noexcept;

  /// Finds where tubes lie between closed jaws, at most one place of each tube.
  /// \return how many, as far as the span goes
  /// \note Real-time safe.
  std::size_t CatchBetween(const instrument::Tool& tool, const math::Pose& X_world_tool,
                           std::span<const math::Vec3> position, std::span<Caught> caught) const noexcept;
  /// Closes a tube with a row of staples, beside what was caught. A row holds as a clip does, and crosses none.
  /// \param offset  along the tube [m]; a row beyond its end closes nothing
  /// \note Real-time safe.
  ClipResult Staple(const instrument::Tool& tool, const math::Pose& X_world_tool, const Caught& caught,
                    double offset) noexcept;

  /// Clips slip towards the end of a stump where pressure or pull is more than they withstand: see surgery/clip_hold.h.
  /// After Flow, whose pressures it takes.
  /// \param[out] slipped  that fell off; others have to wait for the next tick
  /// \return how many
  /// \note Real-time safe.
  std::size_t Slip(double seconds, std::span<const ClipPull> pulls, std::span<const math::Vec3> position,
                   std::span<SlippedClip> slipped) noexcept;
  /// Adds the lost clips, which fall as stones do, up to the capacity of `loose`.
  void FindLooseClips(std::vector<LooseStone*>& loose) noexcept;

  /// Makes a hole where a node of a tube was burnt through.
  /// \return false where the node is of no tube, or there are kMostOpenings
  bool MakeHole(std::uint32_t node, double area, TubePlace& place) noexcept;

  /// Seals openings within `reach` of a point by `share` of their size each [-]; only vessels that are narrow enough.
  void Seal(const math::Vec3& p, double reach, double share, std::span<const math::Vec3> position) noexcept;

  /// One tick of flow.
  /// \param[in,out] conserved  pressure of the hollow organ, which loses what runs out of its duct
  /// \param hollow  index of that organ, or -1
  /// \note Real-time safe.
  void Flow(double seconds, std::int32_t hollow, tissue::ConservationState& conserved,
            FluidLedger& ledger) noexcept;

  const FlowReport& Report() const { return report_; }
  /// Cuts through one tube.
  std::size_t CountCuts(std::uint32_t tube) const noexcept;

  // Visible state; each function fills the span as far as it goes and returns how many.
  /// \param first_surface  index of the first tube's surface in the scene
  std::size_t PublishPieces(std::size_t first_surface, std::span<TubePiece> pieces) const noexcept;
  std::size_t PublishClips(std::span<const math::Vec3> position,
                           std::span<ClipSnapshot> clips) const noexcept;
  /// Where at rest tubes were cut through, world frame [m].
  std::size_t PublishCuts(std::span<math::Vec3> cuts) const noexcept;
  std::size_t PublishLeaks(std::span<const math::Vec3> position,
                           std::span<LeakSnapshot> leaks) const noexcept;

  /// The lines with their cuts, and what else is joined to what. Before VisitState.
  void VisitTopology(base::StateArchive& archive);
  /// Clips, openings, and what runs out of them.
  void VisitState(base::StateArchive& archive);

 private:
  struct Clipped {
    std::uint32_t a = 0, b = 0;  // points of the edge
    double t = 0;                // from a to b
    math::Vec3 legs;             // direction in which it was put on, world frame at that time
    double gap = 0;              // [m]
    bool is_lost = false, is_crossed = false;
    double closure = 0;
    bool is_weak = false;      // it crosses another, or another it
    double vessel_radius = 0;  // outside [m]
    std::uint32_t act = 0;     // in acts_.clips, unless it closed around nothing
    LooseStone loose;          // where it lies when it is lost
    TubePlace place;
    void VisitState(base::StateArchive& archive);
  };
  /// Part of a vessel that is left on one side of a cut.
  struct Stump {
    std::uint32_t vessel = 0;
    double sign = 1;           // +1: the cut lies towards the vessel's `to` end, as seen from the stump
    double cut = 0, root = 0;  // places of its end and of where it is fed [m]
    double pressure = 0;       // [Pa]
  };
  /// The end points of an opening.
  struct OpeningEnds {
    std::array<std::uint32_t, 2> points{};
    TubePlace place;
    void VisitState(base::StateArchive& archive);
  };
  void Fasten(Clipped& clip, const Caught& caught, double length, ClipResult& result) noexcept;
  void MoveClips(const geometry::CentreLineCut& cut) noexcept;
  double CalcPull(const Clipped& clip, const Stump& stump, std::span<const math::Vec3> position,
                  std::span<const ClipPull> pulls) const noexcept;
  void FindEdge(Clipped& clip) noexcept;
  std::size_t SlipStump(const Stump& stump, double seconds, std::span<const ClipPull> pulls,
                        std::span<const math::Vec3> position, std::span<SlippedClip> slipped) noexcept;

  VesselSettings settings_;
  VesselMap map_;
  CuttableTubes tubes_;
  std::vector<std::uint32_t> tube_of_;         // (points)
  std::vector<double> arc_of_;                 // (points) [m]
  std::vector<std::vector<math::Vec3>> rest_;  // (tubes)(points) [m]
  VesselActs acts_;
  std::vector<Clipped> clips_;
  std::vector<OpeningEnds> ends_;  // of acts_.openings
  FlowReport report_;
};

}  // namespace trocar::surgery
