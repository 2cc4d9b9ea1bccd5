// SPDX-License-Identifier: Apache-2.0
/// \file mesh_export.h  Meshes for other programs: OBJ, STL, glTF and VTK. mesh_file.h has PLY.
/// Coordinates are written as they are given; which frame and unit each file holds is the caller's choice
/// (docs/formats.md), but for glTF, which is metres with y up.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::files {

/// A mesh with what other programs show of it.
struct NamedMesh {
  std::string name;  ///< a-z, 0-9 and _: group, node and file name
  geometry::TriangleMesh mesh;
  std::string material;                            ///< name of the material, shared by meshes of one kind
  std::array<double, 3> colour = {0.8, 0.8, 0.8};  ///< linear red, green, blue, 0 to 1
};

/// Wavefront OBJ text: one group a mesh, numbers that read back to the same doubles.
///
/// \param comment  first line; control characters become spaces
std::string FormatObj(std::span<const NamedMesh> meshes, std::string_view comment = {});

/// Binary STL: single precision, triangles with their normals, no names.
/// Source: 3D Systems, "StereoLithography Interface Specification", 1989.
///
/// \param comment  at most 80 bytes of it are kept
std::string FormatStl(const geometry::TriangleMesh& mesh, std::string_view comment = {});

/// glTF 2.0 in one binary file: one node and mesh for each mesh, positions and normals in single precision,
/// one material for each name.
/// Source: Khronos, "glTF 2.0 Specification", sections 3 and 4.
///
/// \param meshes  [m], right-handed, y up, z forward;
/// \param copyright  credit, UTF-8; other bytes are replaced
/// \pre every mesh has a triangle, and all vertices are finite in single precision (TROCAR_ASSERT)
std::string FormatGlb(std::span<const NamedMesh> meshes, std::string_view copyright = {});

enum class VtkEncoding { kAscii, kBinary };

/// VTK legacy file, version 3.0, data set POLYDATA in double precision; binary is big-endian, as VTK wants
/// it.
/// Source: Kitware, "VTK File Formats", simple legacy formats.
///
/// \param title  second line; control characters become spaces, at most 255 bytes are kept
std::string FormatVtk(const geometry::TriangleMesh& mesh, std::string_view title, VtkEncoding encoding);

}  // namespace trocar::files
