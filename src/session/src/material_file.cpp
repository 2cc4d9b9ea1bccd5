// SPDX-License-Identifier: Apache-2.0
#include "material_file.h"

#include <string>

namespace trocar::session {
namespace {

void ReadFigures(const core::JsonView& view, OrganMaterial& material) {
  material.young_modulus = view.Number("young_modulus_pa", {0.0, 1e9});
  material.wall_thickness = 0.001 * view.Number("wall_thickness_mm", {0.001, 100.0});
  material.foundation_modulus = view.NumberOr("foundation_modulus_pa", 0.0, {0.0, 1e9});
  material.depth = 0.001 * view.NumberOr("foundation_depth_mm", 10.0, {0.1, 1000.0});
  material.density = view.NumberOr("density_kg_m3", 1060.0, {0.0, 20'000.0});
  material.failure_strain = view.NumberOr("failure_strain", material.failure_strain, {1e-9, 100.0});
  material.failure_force = view.NumberOr("failure_force_n", material.failure_force, {1e-9, 1000.0});
  tissue::SpringLaw& law = material.wall_law;
  law.stiffening = view.NumberOr("stiffening", law.stiffening, {0.0, 1e4});
  law.stiffening_strain = view.NumberOr("stiffening_strain", law.stiffening_strain, {0.0, 10.0});
  law.failure_strain = view.NumberOr("wall_failure_strain", law.failure_strain, {1e-3, 100.0});
  law.damage_rate = view.NumberOr("wall_damage_per_s", law.damage_rate, {0.0, 1e6});
  law.damage_exponent = view.NumberOr("wall_damage_exponent", law.damage_exponent, {1.0, 100.0});
  if (law.damage_rate > 0.0 && !view.Has("wall_failure_strain"))
    view.Complain("wall_damage_per_s needs wall_failure_strain, under whose tension it counts");
  material.internal_pressure = view.NumberOr("internal_pressure_pa", 0.0, {-20e3, 20e3});
}

core::Result<OrganMaterial> ReadMaterialFile(const std::filesystem::path& path) {
  auto document = core::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const core::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "young_modulus_pa", "wall_thickness_mm",
                  "foundation_modulus_pa", "foundation_depth_mm", "density_kg_m3", "failure_strain",
                  "failure_force_n", "internal_pressure_pa", "stiffening", "stiffening_strain",
                  "wall_failure_strain", "wall_damage_per_s", "wall_damage_exponent", "sources"});
  if (root.Text("format") != "trocar-material") root.Complain("format must be \"trocar-material\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  OrganMaterial material;
  ReadFigures(root, material);
  const core::JsonView sources = root.Object("sources");
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

}  // namespace

core::Result<OrganMaterial> ReadMaterial(const core::JsonView& view, const std::filesystem::path& folder) {
  OrganMaterial material;
  if (view.Has("file")) {
    view.AllowOnly({"organ", "file"});
    auto read = ReadMaterialFile(folder / view.Text("file"));
    if (!read.ok()) return read.error();
    material = std::move(*read);
  } else {
    view.AllowOnly({"organ", "young_modulus_pa", "wall_thickness_mm", "foundation_modulus_pa",
                    "foundation_depth_mm", "density_kg_m3", "failure_strain", "failure_force_n",
                    "internal_pressure_pa", "stiffening", "stiffening_strain", "wall_failure_strain",
                    "wall_damage_per_s", "wall_damage_exponent", "source"});
    ReadFigures(view, material);
    material.source = view.Text("source");
  }
  material.organ = view.Text("organ");
  return material;
}

}  // namespace trocar::session
