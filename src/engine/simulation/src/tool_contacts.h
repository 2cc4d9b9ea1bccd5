// SPDX-License-Identifier: Apache-2.0
/// \file tool_contacts.h  Contacts of tools, organs and tubes in a tick, and the poses of the tools that are seen.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/surgery/cavity.h"
#include "trocar/surgery/neighbour_contact.h"
#include "trocar/surgery/organ_contact.h"
#include "trocar/surgery/tools_contact.h"

namespace trocar::simulation {

/// The devices' poses of a tick and what the tools hold.
struct ToolsNow {
  std::array<instrument::TrocarJoints, instrument::kHandCount> joints;
  std::array<std::int32_t, instrument::kHandCount> grasped_surfaces;  ///< or -1
  std::array<const instrument::Tool*, instrument::kHandCount> tools;
};

/// Touch on one tool after the solve.
struct ToolTouch {
  math::Vec3 force;           ///< of tissue and the other tool [N]
  std::int32_t surface = -1;  ///< of tissue pressed most, or -1
};

/// Called in the order of its members, once a tick each; nothing allocates but Make.
class ToolContacts {
 public:
  /// \param model     system over whose rest shape the trees are built
  /// \param surfaces  organs, then tubes
  /// \return kMeshInvalid
  static base::Result<ToolContacts> Make(const scene::Scene& scene, const tissue::TissueModel& model,
                                         std::span<const scene::SurfaceInfo> surfaces,
                                         const tissue::TissueState& at_start);

  /// Tools at these joints, touching nothing.
  void Reset(const scene::Scene& scene,
             const std::array<instrument::TrocarJoints, instrument::kHandCount>& joints,
             const tissue::TissueState& tissue) noexcept;

  /// Contacts on the way from the proxies to the devices.
  /// \return the springs; valid until the next call
  std::span<const tissue::ContactSpring> Find(const scene::Scene& scene, const ToolsNow& now,
                                              const tissue::TissueState& tissue) noexcept;
  /// One more limit on the tool that is seen, for this tick: something other than tissue keeps it out.
  void AddLimit(int hand, const surgery::ProxyLimit& limit) noexcept { limits_[hand].Add(limit); }
  /// Forces of the contacts after the solve. \param is_good  false: forgets what sticks where
  std::array<ToolTouch, instrument::kHandCount> CalcTouch(const tissue::TissueState& tissue,
                                                          bool is_good) noexcept;
  /// After a cut, or a state with other cuts: the surfaces as they are now.
  /// \param is_restored  even a surface of as many triangles may be another
  /// \param meshes   (organs) over the nodes from each organ's first one on
  /// \param pieces, tube_of_piece  of all ducts and vessels
  /// \note Not real-time safe: allocates.
  base::Status UpdateTopology(const tissue::TissueModel& model, const tissue::TissueState& tissue,
                              bool is_restored, std::span<const geometry::TriangleMesh> meshes,
                              std::span<const collision::TubePiece> pieces,
                              std::vector<std::uint32_t> tube_of_piece);
  /// Refits the trees, and places the tools that are seen.
  void Update(const scene::Scene& scene, const ToolsNow& now, const tissue::TissueState& tissue) noexcept;

  std::span<const surgery::OrganSurface> Organs() const { return organs_; }
  const surgery::TubeSet& Tubes() const { return tubes_; }
  const surgery::NeighbourContact& Neighbours() const { return neighbours_; }
  const surgery::ContactSet& Contacts() const { return contacts_; }
  const math::Pose& Proxy(int hand) const { return X_world_proxy_[hand]; }
  const math::Pose& Device(int hand) const { return X_world_device_[hand]; }
  double Overlap(int hand) const { return overlap_[hand]; }  ///< of the proxy with tissue, what is left [m]
  bool AreToolsTouching() const { return tools_.is_touching; }

  /// Trees and boxes over nodes that were moved by restoring a state. Before VisitState.
  void Refit(const tissue::TissueState& tissue) noexcept;
  void VisitState(base::StateArchive& archive);

 private:
  surgery::ContactCandidates MakeContactCandidates(const tissue::TissueState& tissue) const noexcept;
  void PlaceProxy(const scene::Scene& scene, int hand, const ToolsNow& now,
                  const surgery::ContactCandidates& candidates) noexcept;

  void MakePairs(const scene::Scene& scene, const tissue::TissueModel& model,
                 const tissue::TissueState& at_start);
  void AddPair(surgery::OrganPair pair, const tissue::TissueModel& model);
  void MakeCavity(const scene::Scene& scene, const tissue::TissueModel& model,
                  const tissue::TissueState& at_start);

  /// Strand that ties a node of a pair to the pair's surface.
  struct Tie {
    std::size_t pair;
    std::uint32_t strand, vertex;
  };

  // constant
  surgery::ContactSettings settings_;
  surgery::OrganContactSettings organ_settings_;
  surgery::CavityContactSettings cavity_settings_;
  std::vector<Tie> ties_;
  surgery::Cavity cavity_;
  std::vector<surgery::CavityContact> cavity_contacts_;  // (organs)

  // state
  std::array<math::Pose, instrument::kHandCount> X_world_proxy_, X_world_proxy_before_, X_world_device_;
  std::array<instrument::TrocarJoints, instrument::kHandCount> offset_;  // proxy less device
  std::array<double, instrument::kHandCount> jaw_before_{};
  surgery::ContactSet contacts_, last_;
  bool has_followed_ = false;  // a cut, in this tick
  std::vector<surgery::OrganPair> pairs_;
  std::vector<math::Vec3> positions_before_;  // (n) before the last solve
  surgery::NeighbourContact neighbours_;

  // scratch
  std::vector<surgery::OrganSurface> organs_;
  bool has_sheets_ = false;  // organs are open sheets: grasped and cut, but not pushed
  surgery::TubeSet tubes_;
  std::vector<double> surface_motion_;  // (organs + 1)
  std::array<surgery::ProxyLimits, instrument::kHandCount> limits_;
  surgery::ToolsContact tools_;
  std::array<double, instrument::kHandCount> overlap_{};
};

}  // namespace trocar::simulation
