// SPDX-License-Identifier: Apache-2.0
#include "tool_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "trocar/instrument/state_fields.h"
#include "trocar/math/state_fields.h"
#include "trocar/patient/patient.h"

namespace trocar::simulation {

using instrument::kHandCount;
using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using roles::OrganRole;
using scene::InstrumentSetup;
using scene::Scene;

namespace {

/// Corrections of a proxy that overlaps tissue after its contacts have placed it.
constexpr int kOverlapRounds = 3;
/// Pinch that leaves a mark on the liver [N]. Source: domain facts, section 3.3.
constexpr double kLiverDamagePinch = 2.0;

/// Farthest that one of the nodes went [m].
double CalcMotion(std::span<const Vec3> before, std::span<const Vec3> now) noexcept {
  double largest2 = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    largest2 = std::max(largest2, math::SquaredDistance(before[i], now[i]));
  }
  return std::sqrt(largest2);
}

/// How a neighbour gives way: bowel and stomach are pushed aside, what lies behind the peritoneum gives way little, bone does not.
/// The numbers are tunables without a source.
surgery::NeighbourSurface MakeNeighbour(const patient::Neighbour& neighbour) {
  using roles::NeighbourRole;
  surgery::NeighbourSurface made{neighbour.mesh, 150.0, 0.010};
  switch (neighbour.role) {
    case NeighbourRole::kPancreas:
    case NeighbourRole::kRightKidney:
    case NeighbourRole::kVenaCava:
    case NeighbourRole::kAorta:
    case NeighbourRole::kPortalVein:
      made.stiffness = 400.0, made.deepest = 0.004;
      break;
    case NeighbourRole::kRibs:
    case NeighbourRole::kSpine:
      made.stiffness = std::numeric_limits<double>::infinity(), made.deepest = 0.0;
      break;
    default:
      break;
  }
  return made;
}

base::Result<surgery::NeighbourContact> MakeNeighbours(const patient::Patient& patient) {
  std::vector<surgery::NeighbourSurface> surfaces;
  for (const patient::Neighbour& neighbour : patient.neighbours) surfaces.push_back(MakeNeighbour(neighbour));
  return surgery::NeighbourContact::Make(surfaces);
}

}  // namespace

base::Result<ToolContacts> ToolContacts::Make(const Scene& scene, const tissue::TissueModel& model,
                                              std::span<const scene::SurfaceInfo> surfaces,
                                              const tissue::TissueState& at_start) {
  ToolContacts made;
  made.has_sheets_ = scene.model.has_value();
  const auto& organs = scene.patient.organs;
  for (std::size_t i = 0; i < organs.size(); ++i) {
    auto surface = surgery::MakeOrganSurface(model.rest, surfaces[i].first_node, organs[i].mesh);
    if (!surface.ok()) return surface.error();
    if (surfaces[i].organ == OrganRole::kLiver) {
      surface->damage_pinch_small = surface->damage_pinch_full = kLiverDamagePinch;
    }
    surgery::UpdateOrganSurface(*surface, at_start.position);
    made.organs_.push_back(std::move(*surface));
  }
  std::vector<surgery::TubeSurface> tubes;
  for (const scene::SurfaceInfo& surface : surfaces.subspan(organs.size())) {
    tubes.push_back({surface.first_node, surface.node_count, surface.radii});
  }
  auto set = surgery::MakeTubeSet(model.rest, std::move(tubes));
  if (!set.ok()) return set.error();
  made.tubes_ = std::move(*set);

  auto neighbours = MakeNeighbours(scene.patient);
  if (!neighbours.ok()) return neighbours.error();
  made.neighbours_ = std::move(*neighbours);

  made.MakePairs(scene, model, at_start);
  made.MakeCavity(scene, model, at_start);
  made.positions_before_ = at_start.position;
  made.surface_motion_.assign(organs.size() + 1, 0.0);
  return made;
}

/// An organ touches the one in whose bed it lies, ducts and vessels touch both; of other organs nothing is known to touch.
void ToolContacts::MakePairs(const Scene& scene, const tissue::TissueModel& model,
                             const tissue::TissueState& at_start) {
  const std::vector<patient::PatientBed> beds = scene.patient.ListBeds();
  std::vector<int> touched;  // organs in beds, and those whose beds they are
  for (const patient::PatientBed& bed : beds) {
    for (const int organ : {bed.host, bed.organ}) {
      if (organ >= 0 && std::find(touched.begin(), touched.end(), organ) == touched.end())
        touched.push_back(organ);
    }
    if (!bed.IsWhole()) continue;
    for (const auto& [from, to] : {std::pair{bed.organ, bed.host}, std::pair{bed.host, bed.organ}}) {
      AddPair(surgery::MakeOrganPair(organs_, at_start.position, static_cast<std::uint8_t>(from),
                                     static_cast<std::uint8_t>(to), {}, organ_settings_),
              model);
    }
  }
  for (std::size_t tube = 0; tube < tubes_.tubes.size(); ++tube) {
    for (const int organ : touched) {
      AddPair(surgery::MakeTubePair(organs_, at_start.position, tubes_.tubes[tube],
                                    static_cast<std::uint8_t>(organs_.size() + tube),
                                    static_cast<std::uint8_t>(organ), organ_settings_),
              model);
    }
  }
}

void ToolContacts::AddPair(surgery::OrganPair pair, const tissue::TissueModel& model) {
  const surgery::OrganSurface& to = organs_[pair.surface_of];
  for (std::uint32_t i = 0; i < pair.node_count; ++i) {
    const std::uint32_t node = pair.first_node + i;
    for (auto h = model.strand_starts[node]; h < model.strand_starts[node + 1]; ++h) {
      const auto& half = model.half_strands[h];
      if (half.other >= to.first_node && half.other < to.first_node + to.node_count)
        ties_.push_back({pairs_.size(), half.strand, i});
    }
  }
  pairs_.push_back(std::move(pair));
}

void ToolContacts::MakeCavity(const Scene& scene, const tissue::TissueModel& model,
                              const tissue::TissueState& at_start) {
  const std::array<Vec3, kHandCount + 1> ports = {scene.instruments[kLeft].p_world_port,
                                                  scene.instruments[kRight].p_world_port,
                                                  scene.laparoscope.p_world_port};
  std::vector<Vec3> nodes, face;
  for (const surgery::OrganSurface& organ : organs_) {
    const auto own = organ.Nodes(at_start.position);
    nodes.insert(nodes.end(), own.begin(), own.end());
  }
  if (const int liver = scene.patient.OrganOf(OrganRole::kLiver); liver >= 0) {
    const auto own = organs_[liver].Nodes(at_start.position);
    const patient::Region* dome = scene.patient.organs[liver].RegionOf(roles::RegionRole::kDiaphragmaticFace);
    for (std::size_t i = 0; dome != nullptr && i < dome->vertices.size(); ++i)
      face.push_back(own[dome->vertices[i]]);
  }
  cavity_ = surgery::FitCavity(ports, face, nodes);
  for (std::size_t organ = 0; organ < organs_.size(); ++organ) {
    cavity_contacts_.push_back(surgery::MakeCavityContact(cavity_, organs_, at_start.position, model.is_fixed,
                                                          static_cast<std::uint8_t>(organ),
                                                          cavity_settings_));
  }
}

base::Status ToolContacts::UpdateTopology(const tissue::TissueModel& model, const tissue::TissueState& tissue,
                                          bool is_restored, std::span<const geometry::TriangleMesh> meshes,
                                          std::span<const collision::TubePiece> pieces,
                                          std::vector<std::uint32_t> tube_of_piece) {
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    if (!is_restored && meshes[i].triangles.size() == organs_[i].triangles.size() &&
        meshes[i].positions.size() == organs_[i].node_count)
      continue;
    auto surface = surgery::MakeOrganSurface(model.rest, organs_[i].first_node, meshes[i]);
    if (!surface.ok()) return surface.error();
    surface->damage_pinch_small = organs_[i].damage_pinch_small;
    surface->damage_pinch_full = organs_[i].damage_pinch_full;
    surgery::UpdateOrganSurface(*surface, tissue.position);
    organs_[i] = std::move(*surface);
    for (surgery::OrganPair& pair : pairs_)
      surgery::UpdateTopology(organs_, static_cast<std::uint8_t>(i), pair);
    surgery::UpdateTopology(cavity_, organs_, tissue.position, cavity_settings_, cavity_contacts_[i]);
  }
  if (!pieces.empty()) {
    auto tree = collision::CapsuleTree::Make(tissue.position, pieces);
    if (!tree.ok()) return tree.error();
    tubes_.tree = std::move(*tree);
    tubes_.tube_of_piece = std::move(tube_of_piece);
  }
  has_followed_ = true;
  return {};
}

void ToolContacts::Reset(const Scene& scene, const std::array<instrument::TrocarJoints, kHandCount>& joints,
                         const tissue::TissueState& tissue) noexcept {
  for (int hand = 0; hand < kHandCount; ++hand) {
    X_world_device_[hand] = instrument::CalcToolPose(scene.instruments[hand].p_world_port, joints[hand]);
    X_world_proxy_[hand] = X_world_proxy_before_[hand] = X_world_device_[hand];
    offset_[hand] = {};
    jaw_before_[hand] = joints[hand].jaw;
    overlap_[hand] = 0;
    limits_[hand].limits.clear();
  }
  contacts_.Clear();
  last_.Clear();
  if (!neighbours_.IsEmpty()) neighbours_.Reset();
  has_followed_ = false;
  tools_ = {};
  std::copy(tissue.position.begin(), tissue.position.end(), positions_before_.begin());
  std::fill(surface_motion_.begin(), surface_motion_.end(), 0.0);
  for (surgery::OrganSurface& organ : organs_) {
    surgery::UpdateOrganSurface(organ, tissue.position);
    organ.travel = 0;
  }
  tubes_.tree.Update(tissue.position);
  for (surgery::OrganPair& pair : pairs_) surgery::ResetPair(pair);
}

surgery::ContactCandidates ToolContacts::MakeContactCandidates(
    const tissue::TissueState& tissue) const noexcept {
  const std::size_t organs = has_sheets_ ? 0 : organs_.size();
  return {std::span(organs_).first(organs), &tubes_, tissue.position, positions_before_,
          std::span(surface_motion_).last(organs + 1)};
}

std::span<const tissue::ContactSpring> ToolContacts::Find(const Scene& scene, const ToolsNow& now,
                                                          const tissue::TissueState& tissue) noexcept {
  std::swap(contacts_, last_);
  contacts_.Clear();
  std::array<surgery::ToolMotion, kHandCount> motions;
  const surgery::ContactCandidates candidates = MakeContactCandidates(tissue);
  for (int hand = 0; hand < kHandCount; ++hand) {
    const InstrumentSetup& setup = scene.instruments[hand];
    X_world_device_[hand] = instrument::CalcToolPose(setup.p_world_port, now.joints[hand]);
    motions[hand] = {now.tools[hand],      static_cast<std::uint8_t>(hand), X_world_proxy_before_[hand],
                     X_world_proxy_[hand], X_world_device_[hand],           jaw_before_[hand],
                     now.joints[hand].jaw, now.grasped_surfaces[hand]};
    surgery::FindContacts(motions[hand], candidates, settings_, last_, contacts_);
    limits_[hand].limits.clear();
  }
  tools_ = surgery::FindToolsContact(motions, limits_);
  if (!neighbours_.IsEmpty()) neighbours_.Find(motions);

  for (surgery::OrganPair& pair : pairs_) std::fill(pair.is_bound.begin(), pair.is_bound.end(), 0);
  for (const Tie& tie : ties_) {
    if (tissue.strand_is_intact[tie.strand]) pairs_[tie.pair].is_bound[tie.vertex] = 1;
  }
  for (surgery::OrganPair& pair : pairs_) {
    surgery::FindOrganContacts(organs_, tissue.position, organ_settings_, pair, contacts_);
  }
  for (const surgery::CavityContact& contact : cavity_contacts_) {
    if (has_sheets_) break;
    surgery::FindCavityContacts(cavity_, organs_, tissue.position, positions_before_, cavity_settings_,
                                contact, contacts_);
  }
  std::copy(tissue.position.begin(), tissue.position.end(), positions_before_.begin());
  return contacts_.springs;
}

std::array<ToolTouch, kHandCount> ToolContacts::CalcTouch(const tissue::TissueState& tissue,
                                                          bool is_good) noexcept {
  std::array<ToolTouch, kHandCount> touch;
  if (!neighbours_.IsEmpty()) neighbours_.Press(is_good);
  for (int hand = 0; hand < kHandCount; ++hand) {
    const auto reaction =
        surgery::CalcContactReaction(static_cast<std::uint8_t>(hand), tissue.position, contacts_);
    if (!is_good) continue;
    touch[hand] = {reaction.force + tools_.force[hand], reaction.surface};
    if (!neighbours_.IsEmpty()) touch[hand].force += neighbours_.ForceOn(hand);
  }
  for (surgery::OrganPair& pair : pairs_) {
    if (is_good) {
      surgery::KeepWarmStartForces(tissue.position, contacts_, pair);
    } else {
      surgery::ForgetWarmStartForces(pair);
    }
  }
  // triangles have other numbers after a cut: what stuck to them is forgotten once its force has been read
  if (!is_good || has_followed_) contacts_.Clear();
  has_followed_ = false;
  return touch;
}

void ToolContacts::Update(const Scene& scene, const ToolsNow& now,
                          const tissue::TissueState& tissue) noexcept {
  double tube_motion = 0;
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    surgery::UpdateOrganSurface(organs_[i], tissue.position);
    surface_motion_[i] = CalcMotion(organs_[i].Nodes(positions_before_), organs_[i].Nodes(tissue.position));
  }
  tubes_.tree.Update(tissue.position);
  for (const surgery::TubeSurface& tube : tubes_.tubes) {
    const auto nodes_of = [&](std::span<const Vec3> positions) {
      return positions.subspan(tube.first_node, tube.node_count);
    };
    tube_motion = std::max(tube_motion, CalcMotion(nodes_of(positions_before_), nodes_of(tissue.position)));
  }
  surface_motion_.back() = tube_motion;
  const surgery::ContactCandidates candidates = MakeContactCandidates(tissue);
  for (int hand = 0; hand < kHandCount; ++hand) PlaceProxy(scene, hand, now, candidates);
}

void ToolContacts::PlaceProxy(const Scene& scene, int hand, const ToolsNow& now,
                              const surgery::ContactCandidates& candidates) noexcept {
  const InstrumentSetup& setup = scene.instruments[hand];
  const surgery::ToolDrive drive{setup.p_world_port, now.joints[hand]};
  surgery::ProxyLimits& limits = limits_[hand];
  surgery::AddContactLimits(static_cast<std::uint8_t>(hand), contacts_, candidates.positions, limits);
  if (!neighbours_.IsEmpty()) neighbours_.AddLimits(hand, limits);
  instrument::TrocarJoints proxy;
  X_world_proxy_before_[hand] = X_world_proxy_[hand];
  for (int round = 0;; ++round) {
    proxy = surgery::FindProxy(drive, offset_[hand], limits.limits);
    X_world_proxy_[hand] = instrument::CalcToolPose(setup.p_world_port, proxy);
    overlap_[hand] =
        surgery::AddOverlapLimits(*now.tools[hand], X_world_proxy_[hand], X_world_device_[hand],
                                  now.joints[hand].jaw, candidates, now.grasped_surfaces[hand], limits);
    if (!neighbours_.IsEmpty()) {
      overlap_[hand] =
          std::max(overlap_[hand],
                   surgery::AddOverlapLimits(*now.tools[hand], X_world_proxy_[hand], X_world_device_[hand],
                                             now.joints[hand].jaw, neighbours_.Candidates(), -1, limits));
    }
    if (overlap_[hand] == 0.0 || round == kOverlapRounds) break;
  }
  offset_[hand] = {proxy.pan - drive.device.pan, proxy.tilt - drive.device.tilt, 0.0,
                   proxy.depth - drive.device.depth, 0.0};
  jaw_before_[hand] = now.joints[hand].jaw;
}

void ToolContacts::Refit(const tissue::TissueState& tissue) noexcept {
  for (surgery::OrganSurface& organ : organs_) surgery::UpdateOrganSurface(organ, tissue.position);
  tubes_.tree.Update(tissue.position);
}

void ToolContacts::VisitState(base::StateArchive& archive) {
  archive.Field("X_world_proxy", X_world_proxy_);
  archive.Field("X_world_proxy_before", X_world_proxy_before_);
  archive.Field("X_world_device", X_world_device_);
  archive.Field("offset", offset_);
  archive.Field("jaw_before", jaw_before_);
  archive.Field("contacts", contacts_);
  archive.FixedField("pairs", pairs_);
  archive.FixedField("cavity_contacts", cavity_contacts_);
  archive.FixedField("positions_before", positions_before_);
  archive.FixedField("surface_motion", surface_motion_);
  if (!neighbours_.IsEmpty()) archive.Field("neighbours", neighbours_);
  for (surgery::OrganSurface& organ : organs_) archive.Field("travel", organ.travel);
  archive.Field("overlap", overlap_);
  archive.Field("are_tools_touching", tools_.is_touching);
  if (archive.IsRestoring()) has_followed_ = false;
}

}  // namespace trocar::simulation
