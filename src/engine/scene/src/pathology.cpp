// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/pathology.h"

#include <cmath>
#include <limits>
#include <set>

#include "trocar/base/to_integer.h"
#include "trocar/math/random.h"

namespace trocar::scene {
namespace {

constexpr double kAdhesionReach = 0.015;  // longest strand [m]
constexpr double kPatch = 0.012;          // size of a patch of adhesions [m]

}  // namespace

std::vector<OrganMaterial> CalcPatientMaterials(const Scene& scene, const patient::Pathology& pathology) {
  std::vector<OrganMaterial> materials = scene.materials;
  for (OrganMaterial& material : materials) {
    using roles::TissueRole;
    // one that names an organ of the patient's is of what the organ is
    if (material.tissue == TissueRole::kOther)
      material.tissue = roles::TissueOf(scene.patient.FindOrganRole(material.organ));
    const patient::MaterialFactors& factors = pathology.Of(material.tissue);
    material.young_modulus *= factors.young_modulus;
    material.wall_thickness *= factors.wall_thickness;
    material.foundation_modulus *= factors.foundation_modulus;
    material.density *= factors.density;
  }
  return materials;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> FindAdhesions(const patient::Patient& patient,
                                                                   const patient::PatientBed& of,
                                                                   double share) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  if (!of.IsWhole() || !(share > 0)) return pairs;
  std::set<std::uint32_t> bed;
  const patient::Organ &organ = patient.organs[static_cast<std::size_t>(of.organ)],
                       &host = patient.organs[static_cast<std::size_t>(of.host)];
  if (const auto* region = organ.RegionOf(roles::kBedRegion))
    bed.insert(region->vertices.begin(), region->vertices.end());
  const auto& wall = organ.mesh.positions;
  const auto& surface = host.mesh.positions;
  for (std::uint32_t v = 0; v < wall.size(); ++v) {
    if (bed.contains(v)) continue;
    // a patch has grown together or it has not: the same patches come first for every share
    std::uint64_t word = 0x61646865ULL;
    for (int axis = 0; axis < 3; ++axis) {
      const auto cell = base::FloorTo<std::int64_t>(wall[v][axis] / kPatch);
      word = math::Random(word ^ static_cast<std::uint64_t>(cell)).NextWord();
    }
    if (math::Random(word).Uniform() >= share) continue;
    double nearest = std::numeric_limits<double>::max();
    std::uint32_t carrier = 0;
    for (std::uint32_t w = 0; w < surface.size(); ++w) {
      const double distance = math::SquaredDistance(wall[v], surface[w]);
      if (distance < nearest) nearest = distance, carrier = w;
    }
    if (nearest <= kAdhesionReach * kAdhesionReach) pairs.emplace_back(v, carrier);
  }
  return pairs;
}

}  // namespace trocar::scene
