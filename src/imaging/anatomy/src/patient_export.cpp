// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_export.h"

#include <array>
#include <system_error>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/files/mesh_export.h"
#include "trocar/files/mesh_file.h"
#include "trocar/files/patient_frame.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using files::NamedMesh;

constexpr std::pair<std::string_view, MeshFormat> kFormats[] = {{"obj", MeshFormat::kObj},
                                                                {"ply", MeshFormat::kPly},
                                                                {"stl", MeshFormat::kStl},
                                                                {"gltf", MeshFormat::kGltf},
                                                                {"vtk", MeshFormat::kVtk}};

// linear colours, as in the laparoscope's light
constexpr std::array<double, 3> kLiver = {0.31, 0.07, 0.05}, kGallbladder = {0.33, 0.38, 0.20},
                                kDuct = {0.45, 0.46, 0.16}, kArtery = {0.55, 0.06, 0.05},
                                kOther = {0.60, 0.38, 0.32};

std::array<double, 3> ColourOf(roles::OrganRole organ) {
  return organ == roles::OrganRole::kLiver         ? kLiver
         : organ == roles::OrganRole::kGallbladder ? kGallbladder
                                                   : kOther;
}

/// Everything that has a surface, in the world frame.
std::vector<NamedMesh> CollectMeshes(const patient::Patient& patient, int tube_sides) {
  std::vector<NamedMesh> meshes;
  for (const patient::Organ& organ : patient.organs) {
    meshes.push_back({organ.name, organ.mesh, organ.name, ColourOf(organ.role)});
  }
  for (const patient::Neighbour& neighbour : patient.neighbours)
    meshes.push_back({neighbour.name, neighbour.mesh, neighbour.name, kOther});
  for (const patient::Tube& tube : patient.tubes) {
    const bool is_duct = tube.kind == patient::TubeKind::kDuct;
    meshes.push_back({tube.name, geometry::MakeTube(tube.line, tube_sides), patient::KindName(tube.kind),
                      is_duct ? kDuct : kArtery});
  }
  return meshes;
}

struct File {
  std::string name, content;
};

std::vector<File> FormatFiles(const patient::Patient& patient, const ExportOptions& options) {
  std::vector<NamedMesh> meshes = CollectMeshes(patient, options.tube_sides);
  if (options.format == MeshFormat::kGltf)
    return {{"patient.glb", files::FormatGlb(meshes, patient.provenance)}};
  for (NamedMesh& part : meshes) part.mesh = files::Converted(std::move(part.mesh), files::ToLps);
  const std::string unit = "LPS millimetres";
  if (options.format == MeshFormat::kObj)
    return {{"patient.obj", files::FormatObj(meshes, unit + ", " + patient.provenance)}};
  std::vector<File> files;
  for (const NamedMesh& part : meshes) {
    const std::string about = unit + ", " + part.name;
    if (options.format == MeshFormat::kPly) {
      files.push_back({part.name + ".ply", files::FormatPly(part.mesh, about)});
    } else if (options.format == MeshFormat::kStl) {
      files.push_back({part.name + ".stl", files::FormatStl(part.mesh, about)});
    } else {
      const auto encoding = options.is_ascii ? files::VtkEncoding::kAscii : files::VtkEncoding::kBinary;
      files.push_back({part.name + ".vtk", files::FormatVtk(part.mesh, about, encoding)});
    }
  }
  return files;
}

}  // namespace

base::Result<MeshFormat> FindMeshFormat(std::string_view name) {
  std::string known;
  for (const auto& [text, format] : kFormats) {
    if (text == name) return format;
    known += (known.empty() ? "" : ", ") + std::string(text);
  }
  return Error{ErrorCode::kUnknownName,
               "there is no mesh format \"" + std::string(name) + "\"; known are " + known};
}

base::Result<std::vector<fs::path>> ExportPatient(const patient::Patient& patient, const fs::path& folder,
                                                  const ExportOptions& options) {
  TROCAR_ASSERT(options.tube_sides >= 3);
  if (const auto status = patient::CheckPatient(patient); !status.ok()) return status.error();
  for (const patient::Tube& tube : patient.tubes) {
    if (!patient::IsPlainName(tube.name)) {
      return Error{ErrorCode::kPatientInvalid,
                   "the name of tube '" + tube.name + "' cannot be a file's; rename it with a-z, 0-9 and _"};
    }
  }
  fs::path target = folder;
  if (!target.has_filename()) target = target.parent_path();
  const host::PartialPath part(target);
  const fs::path& partial = part.Path();
  const auto fail = [&](const std::string& why) {
    return Error{ErrorCode::kFileUnwritable, target.string() + ": " + why};
  };
  std::error_code failure;
  if (fs::exists(target, failure) && !(fs::is_directory(target, failure) && fs::is_empty(target, failure)))
    return fail("it exists and is no empty folder; choose another or remove it");
  fs::create_directories(partial, failure);
  if (failure) return fail(failure.message() + "; check the folder, its rights and the space left");
  std::vector<fs::path> paths;
  for (const File& file : FormatFiles(patient, options)) {
    if (const auto status = host::WriteFile(partial / file.name, file.content); !status.ok())
      return fail(status.error().message);
    paths.push_back(target / file.name);
  }
  // an empty folder is replaced by the full one in one step
  fs::rename(partial, target, failure);
  if (failure) return fail(failure.message() + "; check the folder, its rights and the space left");
  return paths;
}

}  // namespace trocar::anatomy
