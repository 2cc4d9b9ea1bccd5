// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_lint.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>

#include "patient_linter.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/patient_frame.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

std::string Rounded(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*g",
                std::fabs(value) < 1e5 && std::fabs(value) >= 1.0 ? digits + 3 : 3, value);
  return text;
}

std::string Mm(double metres) {
  return Rounded(files::kMmPerMetre * metres) + " mm";
}

std::string PlaceText(const math::Vec3& world) {
  const math::Vec3 p = files::ToLps(world);
  char text[128];
  std::snprintf(text, sizeof(text), "(%.1f, %.1f, %.1f) mm", p.x, p.y, p.z);
  return text;
}

std::string Count(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

geometry::TriangleMesh Outward(geometry::TriangleMesh mesh) {
  if (geometry::CalcVolume(mesh.positions, mesh.triangles) < 0) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

LintReport Linter::Run() {
  LintNames();
  LintLabels();
  for (std::size_t i = 0; i < patient_.organs.size(); ++i) LintMesh(i);
  for (std::size_t i = 0; i < patient_.neighbours.size(); ++i) LintNeighbour(i);
  LintUnit();
  LintVolumes();
  for (std::size_t i = 0; i < patient_.organs.size(); ++i) LintRegions(i);
  LintFixedFaces();
  LintAttachments();
  LintTubes();
  LintTubeGraph();
  LintLandmarks();
  LintSides();
  LintDepth();
  return std::move(report_);
}

void Linter::Add(const char* code, std::string where, std::string text) {
  report_.findings.push_back({code, std::move(where), std::move(text)});
}

const patient::Organ* Linter::FindUsable(int organ) const {
  return organ >= 0 && is_usable_[organ] ? &patient_.organs[organ] : nullptr;
}

std::optional<math::Vec3> Linter::FindPlace(roles::LandmarkRole role) const {
  const patient::Landmark* landmark = patient_.LandmarkOf(role);
  if (landmark == nullptr || !math::IsFinite(landmark->position)) return std::nullopt;
  return landmark->position;
}

void Linter::LintNames() {
  const auto look = [this](const auto& things, const char* what) {
    std::set<std::string> names;
    for (const auto& thing : things) {
      if (!names.insert(thing.name).second)
        Add("L-NAME-TWICE", thing.name, std::string("two ") + what + " have this name; rename one");
    }
  };
  look(patient_.organs, "organs");
  look(patient_.tubes, "tubes");
  look(patient_.landmarks, "landmarks");
  look(patient_.neighbours, "neighbours");
  for (const patient::Neighbour& neighbour : patient_.neighbours) {
    if (patient_.FindPart(neighbour.name) >= 0)
      Add("L-NAME-TWICE", neighbour.name, "an organ or tube has the name of a neighbour; rename one");
  }
  const auto look_at_roles = [this](const auto& things, const std::string& where, const char* what) {
    if (const auto* second = patient::FindSecondOfRole(things))
      Add("L-ROLE-TWICE", where + second->name,
          std::string("another ") + what + " is the " + roles::SpokenName(second->role) +
              ", too; state another role, or \"other\"");
  };
  look_at_roles(patient_.organs, "", "organ");
  look_at_roles(patient_.landmarks, "", "landmark");
  look_at_roles(patient_.neighbours, "", "neighbour");
  for (const patient::Organ& organ : patient_.organs)
    look_at_roles(organ.regions, organ.name + "/", "region");
  for (const patient::Tube& tube : patient_.tubes) {
    if (patient_.FindOrgan(tube.name) >= 0)
      Add("L-NAME-TWICE", tube.name, "an organ and a tube have this name; rename one");
  }
  for (const roles::OrganRole organ : {roles::OrganRole::kLiver, roles::OrganRole::kGallbladder}) {
    if (patient_.OrganOf(organ) < 0)
      Add("L-ORGAN-MISSING", roles::NameOf(organ),
          "there is no such organ; place its contours and build the patient again");
  }
}

void Linter::LintLabels() {
  report_.labels = patient_.labels;
  for (const patient::SourceLabel& label : patient_.labels) {
    if (label.doubt.empty()) continue;
    Add("L-LABEL-DOUBT", label.meaning,
        label.doubt + "; look whether it is the right label, or build the patient again with the right one");
  }
}

LintReport LintPatient(const patient::Patient& patient) {
  return Linter(patient, {}).Run();
}

base::Result<LintReport> LintPatientFolder(const std::filesystem::path& folder) {
  const auto read = files::ReadPatientUnchecked(folder);
  if (!read.ok()) return read.error();
  return Linter(read->patient, read->mesh_errors).Run();
}

}  // namespace trocar::anatomy
