// SPDX-License-Identifier: Apache-2.0
/// \file mesh_file.h  Stanford PLY files, as 3D Slicer, MeshLab and Blender read them.
/// Source: Turk, "The PLY polygon file format", 1994.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "trocar/base/result.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::files {

/// Binary little-endian PLY text: double x y z, triangles as uchar/uint lists. Units as given.
std::string FormatPly(const geometry::TriangleMesh& mesh, std::string_view comment = {});

/// Reads ASCII and binary little-endian PLY with float or double x y z and triangle faces; other properties
/// are skipped.
/// \param source  name used in messages
/// \return kMeshInvalid with what is wrong; counts are checked against the bytes present before anything is
/// allocated
base::Result<geometry::TriangleMesh> ParsePly(std::string_view content, std::string_view source);

base::Result<geometry::TriangleMesh> ReadPly(const std::filesystem::path& path);
base::Status WritePly(const std::filesystem::path& path, const geometry::TriangleMesh& mesh,
                      std::string_view comment = {});

}  // namespace trocar::files
