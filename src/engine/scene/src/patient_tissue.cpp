// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/patient_tissue.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "connective_tissue.h"
#include "trocar/base/to_integer.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/pathology.h"
#include "trocar/surgery/topology_change.h"
#include "trocar/tissue/material.h"

namespace trocar::scene {

using roles::OrganRole;
using roles::TissueRole;
namespace {

/// Bending springs of a tube, as a share of its axial stiffness [-]: keeps it a smooth curve.
constexpr double kBendingShare = 0.1;
/// Depth of an organ's skin that warms with its nodes [m].
constexpr double kHeatDepth = 0.0015;
/// Fat and fibres: no source, tunables. Stiffness of a fibre by its length [N/m^2]; the peritoneum is tougher.
constexpr double kFatModulus = 2e3, kPeritoneumShare = 4.0;
constexpr double kFatDensity = 930.0;  // [kg/m^3]
/// Foundation of a lobule [N/m]: it lies on the fat behind it, and stays where nothing holds it any more.
constexpr double kLobuleFoundation = 0.5;
/// Bands of a model: silicone cords, tunables. Length of a piece [m], stiffness of a piece [N/m], foundation [N/m] that
/// keeps what is cut off from both ends where it is; they tear when a piece is longer by this [m].
constexpr double kBandPiece = 0.003, kBandStiffness = 60.0, kBandFoundation = 0.05, kBandElongation = 0.006;
/// What a model's sheet looks like, see render/material.h.
constexpr const char* kSheetLook = "white_plastic";
/// Fibres tear when longer by this share of their length [-].
constexpr double kFatElongation = 1.5, kPeritoneumElongation = 0.8;
/// The end of a tube is tied to this many of the nearest vertices of its organ.
constexpr std::size_t kEndStrands = 4;

/// The first material of a tissue, or null.
const OrganMaterial* FindMaterial(std::span<const OrganMaterial> materials, TissueRole tissue) {
  const auto found = std::find_if(materials.begin(), materials.end(),
                                  [&](const OrganMaterial& material) { return material.tissue == tissue; });
  return found == materials.end() ? nullptr : &*found;
}

/// The material that names the organ, else that of its tissue.
const OrganMaterial* FindMaterial(std::span<const OrganMaterial> materials, const patient::Organ& organ) {
  const auto named = std::find_if(materials.begin(), materials.end(), [&](const OrganMaterial& material) {
    return material.organ == organ.name;
  });
  if (named != materials.end()) return &*named;
  const TissueRole tissue = roles::TissueOf(organ.role);
  return tissue == TissueRole::kOther ? nullptr : FindMaterial(materials, tissue);
}

TissueRole TissueOf(patient::TubeKind kind) {
  return kind == patient::TubeKind::kArtery ? TissueRole::kArtery : TissueRole::kDuct;
}

base::Error MissingMaterial(const std::string& name) {
  return {base::ErrorCode::kSceneInvalid,
          "the scene has no material for \"" + name + "\"; add one to \"materials\""};
}

/// What an organ's wall is made of, by area.
surgery::WallMaterial CalcWallMaterial(const geometry::TriangleMesh& mesh, const OrganMaterial& material,
                                       tissue::TissueDefinition& definition) {
  const double area = geometry::CalcArea(mesh.positions, mesh.triangles);
  const double mean_area = area / mesh.triangles.size();
  surgery::WallMaterial wall;
  wall.membrane_modulus = material.young_modulus * material.wall_thickness;
  wall.bending_share =
      tissue::CalcBendingShare(material.wall_thickness, std::sqrt(std::sqrt(3.0) * mean_area));
  wall.foundation = material.foundation_modulus / material.depth;
  // the organ's mass, shared out by area
  wall.mass_by_area = material.density * geometry::CalcVolume(mesh.positions, mesh.triangles) / area;
  if (!(material.wall_law == tissue::SpringLaw{})) {
    wall.law = static_cast<std::uint32_t>(definition.laws.size());
    definition.laws.push_back(material.wall_law);
  }
  return wall;
}

/// Only a closed surface has a volume to keep.
base::Status CheckClosed(const patient::Organ& organ) {
  const geometry::MeshReport report = geometry::InspectMesh(organ.mesh);
  if (report.closed && report.outward) return {};
  return base::Error{base::ErrorCode::kSceneInvalid,
                     "the surface of \"" + organ.name + "\" " +
                         (report.closed ? "faces inwards" : "has holes") +
                         ", so its volume cannot be kept; look at it with trocar anatomy check"};
}

/// \param sheet  that the organ is: open, without a volume to keep; null for others
void AddOrgan(const patient::Organ& organ, const OrganMaterial& material, const ModelSheet* sheet,
              const SpareNodes& spare, PatientTissue& made) {
  auto& definition = made.definition;
  const auto first = static_cast<std::uint32_t>(definition.rest.size());
  const auto& mesh = organ.mesh;
  const std::string look = sheet != nullptr                  ? kSheetLook
                           : organ.role != OrganRole::kOther ? NameOf(organ.role)
                                                             : organ.name;
  made.surfaces.push_back({organ.name,
                           look,
                           first,
                           static_cast<std::uint32_t>(mesh.positions.size()),
                           mesh.triangles,
                           {},
                           organ.role});
  definition.rest.insert(definition.rest.end(), mesh.positions.begin(), mesh.positions.end());
  if (sheet == nullptr)
    made.conservation.organs.push_back(
        {first, static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles, tissue::kBileDensity});

  surgery::WallMaterial wall = CalcWallMaterial(mesh, material, definition);
  if (sheet != nullptr) {
    wall.mass_by_area = material.density * material.wall_thickness;
    wall.prestrain = sheet->prestrain;
  }
  made.walls.push_back(wall);
  const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  const auto foundation = tissue::CalcFoundationStiffness(areas, material.foundation_modulus, material.depth);
  definition.shape_stiffness.insert(definition.shape_stiffness.end(), foundation.begin(), foundation.end());
  for (const double area : areas) {
    definition.mass.push_back(wall.mass_by_area * area);
    made.heat_mass.push_back(material.density * kHeatDepth * area);
  }
  for (tissue::Spring spring : surgery::CalcWallSprings(mesh, wall)) {
    spring.a += first, spring.b += first;
    definition.springs.push_back(spring);
  }
  made.spring_organs.resize(definition.springs.size(), static_cast<std::int32_t>(made.surfaces.size() - 1));
  // spare nodes for what cuts add: they follow the organ's nodes, so that these stay in one piece
  made.first_spare.push_back(static_cast<std::uint32_t>(definition.rest.size()));
  if (spare.by_organ > 0) surgery::AddSpareNodes(spare.by_organ, definition);
  made.heat_mass.resize(definition.rest.size(), 0.0);
  for (const patient::Region& region : organ.regions) {
    if (!roles::IsFixed(region.role)) continue;
    for (const auto vertex : region.vertices) definition.fixed.push_back(first + vertex);
  }
}

/// Says what the strand is that was added last.
void NameStrand(StrandInfo::Kind kind, PatientTissue& made) {
  const tissue::Strand& strand = made.definition.strands.back();
  made.strands.push_back({strand.a, strand.b, kind, -1});
}

void AddAttachments(const Scene& scene, const OrganMaterial& bed, PatientTissue& made) {
  const auto& patient = scene.patient;
  std::vector<std::vector<double>> areas;
  for (const patient::Organ& organ : patient.organs) {
    areas.push_back(geometry::CalcVertexAreas(organ.mesh.positions, organ.mesh.triangles));
  }
  // several strands may hang on one vertex: they share its area
  std::vector<std::vector<int>> strands_at(patient.organs.size());
  for (std::size_t i = 0; i < patient.organs.size(); ++i) strands_at[i].assign(areas[i].size(), 0);
  for (const auto& attachment : patient.attachments) ++strands_at[attachment.organ_a][attachment.vertex_a];
  for (const auto& attachment : patient.attachments) {
    const double area =
        areas[attachment.organ_a][attachment.vertex_a] / strands_at[attachment.organ_a][attachment.vertex_a];
    made.definition.strands.push_back({made.surfaces[attachment.organ_a].first_node + attachment.vertex_a,
                                       made.surfaces[attachment.organ_b].first_node + attachment.vertex_b,
                                       bed.young_modulus / bed.wall_thickness * area});
    made.conservation.strand_binds.push_back(1);
    made.max_elongation.push_back(bed.failure_strain * bed.wall_thickness);
    made.strand_organs.push_back(static_cast<std::int32_t>(attachment.organ_a));
    NameStrand(StrandInfo::Kind::kBed, made);
  }
}

/// Where an organ's free wall has grown to the one in whose bed it lies: strands as strong as the bed's, to be dissected.
void AddAdhesions(const Scene& scene, const OrganMaterial& bed, double share, PatientTissue& made) {
  for (const patient::PatientBed& of : scene.patient.ListBeds()) {
    const auto pairs = FindAdhesions(scene.patient, of, share);
    if (pairs.empty()) continue;
    const auto& mesh = scene.patient.organs[static_cast<std::size_t>(of.organ)].mesh;
    const auto areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
    for (const auto& pair : pairs) {
      made.definition.strands.push_back({made.surfaces[of.organ].first_node + pair.first,
                                         made.surfaces[of.host].first_node + pair.second,
                                         bed.young_modulus / bed.wall_thickness * areas[pair.first]});
      made.conservation.strand_binds.push_back(1);
      made.max_elongation.push_back(bed.failure_strain * bed.wall_thickness);
      made.strand_organs.push_back(of.organ);
      NameStrand(StrandInfo::Kind::kAdhesion, made);
    }
  }
}

/// Ties a tube's end to the nearest nodes of a surface.
void TieEnd(std::uint32_t end, const SurfaceInfo& surface, double stiffness, double failure_force,
            PatientTissue& made) {
  auto& definition = made.definition;
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t i = 0; i < surface.node_count; ++i) {
    const std::uint32_t node = surface.first_node + i;
    near.emplace_back(math::SquaredDistance(definition.rest[node], definition.rest[end]), node);
  }
  const std::size_t count = std::min(surface.radii.empty() ? kEndStrands : std::size_t{1}, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  for (std::size_t i = 0; i < count; ++i) {
    definition.strands.push_back({end, near[i].second, stiffness / static_cast<double>(count)});
    made.conservation.strand_binds.push_back(0);
    made.max_elongation.push_back(failure_force / stiffness);
    made.strand_organs.push_back(static_cast<std::int32_t>(&surface - made.surfaces.data()));
    NameStrand(StrandInfo::Kind::kEnd, made);
  }
}

void AddTube(const patient::Tube& tube, const OrganMaterial& material, PatientTissue& made) {
  auto& definition = made.definition;
  const auto first = static_cast<std::uint32_t>(definition.rest.size());
  const auto count = static_cast<std::uint32_t>(tube.line.points.size());
  made.surfaces.push_back({tube.name,
                           NameOf(TissueOf(tube.kind)),
                           first,
                           count,
                           {},
                           tube.line.radii,
                           OrganRole::kOther,
                           tube.role});
  definition.rest.insert(definition.rest.end(), tube.line.points.begin(), tube.line.points.end());
  const double spacing = geometry::CalcLength(tube.line) / (count - 1);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double radius = tube.line.radii[i];
    // what surrounds the tube holds it over its shadow; the weight is that of the filled tube
    definition.shape_stiffness.push_back(material.foundation_modulus / material.depth * 2.0 * radius *
                                         spacing);
    definition.mass.push_back(material.density * M_PI * radius * radius * spacing);
    // what warms is the wall
    const double inside = std::max(0.0, radius - material.wall_thickness);
    made.heat_mass.push_back(material.density * M_PI * (radius * radius - inside * inside) * spacing);
  }
  const auto join = [&](std::uint32_t i, std::uint32_t step, double share) {
    const double length = math::Distance(tube.line.points[i], tube.line.points[i + step]);
    const double stiffness = tissue::CalcTubeStiffness(material.young_modulus, tube.line.radii[i],
                                                       material.wall_thickness, length);
    definition.springs.push_back({first + i, first + i + step, share * stiffness, length});
  };
  for (std::uint32_t i = 0; i + 1 < count; ++i) join(i, 1, 1.0);
  for (std::uint32_t i = 0; i + 2 < count; ++i) join(i, 2, kBendingShare);
}

void TieTubes(const Scene& scene, std::span<const OrganMaterial> materials, PatientTissue& made) {
  const patient::Patient& patient = scene.patient;
  for (std::size_t t = 0; t < patient.tubes.size(); ++t) {
    const patient::Tube& tube = patient.tubes[t];
    SurfaceInfo& self = made.surfaces[patient.organs.size() + t];
    const OrganMaterial& material = *FindMaterial(materials, TissueOf(tube.kind));
    const std::uint32_t ends[2] = {self.first_node, self.first_node + self.node_count - 1};
    for (std::size_t end = 0; end < 2; ++end) {
      self.ends[end] = patient.FindPart(end == 0 ? tube.from : tube.to);
      if (self.ends[end] < 0) {
        made.definition.fixed.push_back(ends[end]);  // leaves the scene
        continue;
      }
      const double stiffness = tissue::CalcTubeStiffness(material.young_modulus, self.radii.front(),
                                                         material.wall_thickness, 0.004);
      TieEnd(ends[end], made.surfaces[static_cast<std::size_t>(self.ends[end])], stiffness,
             material.failure_force, made);
    }
  }
}

/// Lobules of fat as nodes, and every fibre as a strand.
void AddConnectiveTissue(const Scene& scene, const ConnectiveTissue& fat, double spacing,
                         PatientTissue& made) {
  auto& definition = made.definition;
  const auto first = static_cast<std::uint32_t>(definition.rest.size());
  for (const math::Vec3& lobule : fat.lobules) {
    definition.rest.push_back(lobule);
    definition.mass.push_back(kFatDensity * spacing * spacing * spacing);
    definition.shape_stiffness.push_back(kLobuleFoundation);
    made.heat_mass.push_back(definition.mass.back());
  }
  const std::size_t organ_count = scene.patient.organs.size();
  const auto node_of = [&](const FibreEnd& end) {
    if (end.of == FibreEnd::Of::kLobule) return first + end.which;
    const std::size_t surface = end.of == FibreEnd::Of::kOrgan ? end.which : organ_count + end.which;
    return made.surfaces[surface].first_node + end.index;
  };
  const int liver = scene.patient.OrganOf(OrganRole::kLiver);
  for (const Fibre& fibre : fat.fibres) {
    const double share = fibre.is_peritoneum ? kPeritoneumShare : 1.0;
    definition.strands.push_back(
        {node_of(fibre.a), node_of(fibre.b), share * kFatModulus * spacing * spacing / fibre.length});
    // what lies on the liver shares its place; ducts and hollow organs may leave
    const bool binds = fibre.b.of == FibreEnd::Of::kLobule ||
                       (fibre.b.of == FibreEnd::Of::kOrgan && static_cast<int>(fibre.b.which) == liver);
    made.conservation.strand_binds.push_back(binds ? 1 : 0);
    made.max_elongation.push_back(fibre.length *
                                  (fibre.is_peritoneum ? kPeritoneumElongation : kFatElongation));
    made.strand_organs.push_back(-1);
    NameStrand(fibre.is_peritoneum ? StrandInfo::Kind::kPeritoneum : StrandInfo::Kind::kTriangle, made);
  }
}

/// Cords of strands, one after the other; their ends are held.
void AddBands(const ModelSetup& model, PatientTissue& made) {
  auto& definition = made.definition;
  for (std::size_t b = 0; b < model.bands.size(); ++b) {
    const ModelBand& band = model.bands[b];
    const auto first = static_cast<std::uint32_t>(definition.rest.size());
    const double length = math::Distance(band.from, band.to);
    const auto pieces = std::max(3U, base::RoundTo<std::uint32_t>(length / kBandPiece));
    for (std::uint32_t i = 0; i <= pieces; ++i) {
      definition.rest.push_back(math::Lerp(band.from, band.to, static_cast<double>(i) / pieces));
      definition.mass.push_back(kFatDensity * M_PI * band.radius * band.radius * length / pieces);
      definition.shape_stiffness.push_back(kBandFoundation);
      made.heat_mass.push_back(definition.mass.back());
      if (i == 0) continue;
      definition.strands.push_back({first + i - 1, first + i, kBandStiffness});
      made.conservation.strand_binds.push_back(1);
      made.max_elongation.push_back(kBandElongation);
      made.strand_organs.push_back(-1);
      NameStrand(StrandInfo::Kind::kBand, made);
      made.strands.back().band = static_cast<std::int32_t>(b);
    }
    definition.fixed.push_back(first);
    definition.fixed.push_back(first + pieces);
  }
}

}  // namespace

base::Result<PatientTissue> MakePatientTissue(const Scene& scene, const SpareNodes& spare) {
  const patient::Pathology pathology = patient::CalcPathology(scene.patient);
  const auto materials = CalcPatientMaterials(scene, pathology);
  PatientTissue made;
  if (scene.patient.organs.size() > tissue::kMaxClosedOrgans) {
    return base::Error{base::ErrorCode::kSceneInvalid,
                       "the patient has " + std::to_string(scene.patient.organs.size()) +
                           " organs; at most " + std::to_string(tissue::kMaxClosedOrgans) +
                           " can be simulated"};
  }
  for (const patient::Organ& organ : scene.patient.organs) {
    const OrganMaterial* material = FindMaterial(materials, organ);
    if (material == nullptr) return MissingMaterial(organ.name);
    const ModelSheet* sheet = scene.model ? &scene.model->sheets[made.surfaces.size()] : nullptr;
    if (sheet == nullptr) {
      if (const auto closed = CheckClosed(organ); !closed.ok()) return closed.error();
    }
    AddOrgan(organ, *material, sheet, spare, made);
    made.internal_pressure.push_back(material->internal_pressure);
  }
  if (!scene.patient.attachments.empty()) {
    const OrganMaterial* bed = FindMaterial(materials, roles::kBedTissue);
    if (bed == nullptr) return MissingMaterial(NameOf(roles::kBedTissue));
    AddAttachments(scene, *bed, made);
    AddAdhesions(scene, *bed, pathology.adhesions, made);
  }
  for (const patient::Tube& tube : scene.patient.tubes) {
    const OrganMaterial* material = FindMaterial(materials, TissueOf(tube.kind));
    if (material == nullptr) return MissingMaterial(patient::KindName(tube.kind));
    AddTube(tube, *material, made);
  }
  TieTubes(scene, materials, made);
  if (scene.operation && scene.operation->fat_spacing > 0.0) {
    const double spacing = scene.operation->fat_spacing;
    AddConnectiveTissue(scene, MakeConnectiveTissue(scene.patient, spacing, scene.seed), spacing, made);
  }
  if (scene.model) AddBands(*scene.model, made);
  made.first_spare.push_back(static_cast<std::uint32_t>(made.definition.rest.size()));
  if (spare.tubes > 0) surgery::AddSpareNodes(spare.tubes, made.definition);
  made.heat_mass.resize(made.definition.rest.size(), 0.0);
  return made;
}

}  // namespace trocar::scene
