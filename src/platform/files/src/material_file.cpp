// SPDX-License-Identifier: Apache-2.0
#include "material_file.h"

#include <map>
#include <set>
#include <string>
#include <utility>

#include "field_ranges.h"

namespace trocar::files {
namespace {

void ReadFigures(const host::JsonView& view, scene::OrganMaterial& material) {
  material.young_modulus = view.Number("young_modulus_pa", range::kModulusPa);
  material.wall_thickness = 0.001 * view.Number("wall_thickness_mm", range::kWallThicknessMm);
  material.foundation_modulus = view.NumberOr("foundation_modulus_pa", 0.0, range::kModulusPa);
  material.depth = 0.001 * view.NumberOr("foundation_depth_mm", 10.0, range::kFoundationDepthMm);
  material.density = view.NumberOr("density_kg_m3", 1060.0, range::kDensity);
  material.failure_strain = view.NumberOr("failure_strain", material.failure_strain, range::kFailureStrain);
  material.failure_force = view.NumberOr("failure_force_n", material.failure_force, range::kFailureForceN);
  tissue::SpringLaw& law = material.wall_law;
  law.stiffening = view.NumberOr("stiffening", law.stiffening, range::kStiffening);
  law.stiffening_strain = view.NumberOr("stiffening_strain", law.stiffening_strain, range::kStiffeningStrain);
  law.failure_strain = view.NumberOr("wall_failure_strain", law.failure_strain, range::kWallFailureStrain);
  law.damage_rate = view.NumberOr("wall_damage_per_s", law.damage_rate, range::kWallDamagePerS);
  law.damage_exponent =
      view.NumberOr("wall_damage_exponent", law.damage_exponent, range::kWallDamageExponent);
  if (law.damage_rate > 0.0 && !view.Has("wall_failure_strain"))
    view.Complain("wall_damage_per_s needs wall_failure_strain, under whose tension it counts");
  material.internal_pressure = view.NumberOr("internal_pressure_pa", 0.0, range::kInternalPressurePa);
}

base::Result<scene::OrganMaterial> ReadMaterialFile(const std::filesystem::path& path) {
  auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "young_modulus_pa", "wall_thickness_mm",
                  "foundation_modulus_pa", "foundation_depth_mm", "density_kg_m3", "failure_strain",
                  "failure_force_n", "internal_pressure_pa", "stiffening", "stiffening_strain",
                  "wall_failure_strain", "wall_damage_per_s", "wall_damage_exponent", "sources"});
  if (root.Text("format") != "trocar-material") root.Complain("format must be \"trocar-material\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  scene::OrganMaterial material;
  ReadFigures(root, material);
  const host::JsonView sources = root.Object("sources");
  for (const std::string& key : root.Keys()) {
    if (key == "format" || key == "version" || key == "about" || key == "sources") continue;
    if (!sources.Has(key)) {
      sources.Complain("\"" + key + "\" has no source; name one, or say that it is a tunable");
      continue;
    }
    material.source += (material.source.empty() ? "" : " ") + key + ": " + sources.Text(key);
  }
  for (const std::string& key : sources.Keys()) {
    if (!root.Has(key)) sources.Complain("a source for \"" + key + "\", which this material does not give");
  }
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return material;
}

/// Materials of files that were read already, by path.
using MaterialFiles = std::map<std::filesystem::path, scene::OrganMaterial>;

base::Result<scene::OrganMaterial> ReadMaterial(const host::JsonView& view,
                                                const std::filesystem::path& folder, MaterialFiles& files) {
  scene::OrganMaterial material;
  if (view.Has("file")) {
    view.AllowOnly({"organ", "file"});
    const std::filesystem::path path = folder / view.Text("file");
    auto known = files.find(path);
    if (known == files.end()) {
      auto read = ReadMaterialFile(path);
      if (!read.ok()) return read.error();
      known = files.emplace(path, std::move(*read)).first;
    }
    material = known->second;
  } else {
    view.AllowOnly({"organ", "young_modulus_pa", "wall_thickness_mm", "foundation_modulus_pa",
                    "foundation_depth_mm", "density_kg_m3", "failure_strain", "failure_force_n",
                    "internal_pressure_pa", "stiffening", "stiffening_strain", "wall_failure_strain",
                    "wall_damage_per_s", "wall_damage_exponent", "source"});
    ReadFigures(view, material);
    material.source = view.Text("source");
  }
  return material;
}

}  // namespace

base::Result<std::vector<scene::OrganMaterial>> ReadMaterials(const host::JsonView& scene,
                                                              const std::filesystem::path& folder) {
  std::vector<scene::OrganMaterial> materials;
  std::set<std::string> organs;
  MaterialFiles files;
  for (const host::JsonView& view : scene.Array("materials")) {
    std::string organ = view.Text("organ");
    if (!organs.insert(organ).second) {
      view.Complain("a material for \"" + organ + "\" was given before; keep one of them",
                    base::ErrorCode::kSceneInvalid);
      break;
    }
    auto material = ReadMaterial(view, folder, files);
    if (!material.ok()) return material.error();
    material->tissue = roles::ConventionalRole<roles::TissueRole>(organ);
    material->organ = std::move(organ);
    materials.push_back(std::move(*material));
  }
  return materials;
}

}  // namespace trocar::files
