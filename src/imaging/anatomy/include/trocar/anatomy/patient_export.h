// SPDX-License-Identifier: Apache-2.0
/// \file patient_export.h  A patient's organs and tubes as mesh files for other programs. docs/formats.md.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

enum class MeshFormat { kObj, kPly, kStl, kGltf, kVtk };

/// "obj", "ply", "stl", "gltf" or "vtk".
/// \return kUnknownName with those that are known
base::Result<MeshFormat> FindMeshFormat(std::string_view name);

struct ExportOptions {
  MeshFormat format = MeshFormat::kObj;
  bool is_ascii = false;  ///< VTK as text
  int tube_sides = 16;    ///< corners of a tube's ring, 3 or more
};

/// Writes every organ and every tube's skin: one file for OBJ (patient.obj) and glTF (patient.glb), one a
/// mesh for the others. LPS millimetres; glTF in metres, y up, which is the world frame as it is.
///
/// \param folder  is made; it must not exist, or be empty. The whole folder appears at once, or nothing does
/// \return paths of the files; kPatientInvalid or kMeshNotClosed for an inconsistent patient or a tube whose
/// name
///     cannot be a file's, kFileUnwritable
base::Result<std::vector<std::filesystem::path>> ExportPatient(const patient::Patient& patient,
                                                               const std::filesystem::path& folder,
                                                               const ExportOptions& options);

}  // namespace trocar::anatomy
