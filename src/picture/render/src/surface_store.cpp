// SPDX-License-Identifier: Apache-2.0
#include "surface_store.h"

#include <algorithm>
#include <cstddef>

#include "single_precision.h"
#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::render {
namespace {

using geometry::Triangle;
using math::Vec3;

/// A vertex of the constant buffer.
struct RestVertex {
  std::array<float, 3> rest;
  float ambient_occlusion;
};

bool IsInUse(const Surface& surface) {
  return surface.generation % 2 != 0;
}

void Free(Surface& surface) {
  if (!IsInUse(surface)) return;
  glDeleteVertexArrays(1, &surface.array);
  for (const GLuint buffer : {surface.moving, surface.rest, surface.indices, surface.marks, surface.earlier})
    glDeleteBuffers(1, &buffer);
  surface.marks = surface.earlier = 0;
  ++surface.generation;
}

}  // namespace

SurfaceStore::~SurfaceStore() {
  for (Surface& surface : surfaces_) Free(surface);
}

SurfaceId SurfaceStore::Add(std::span<const Triangle> triangles, std::span<const Vec3> rest,
                            Material material, std::span<const double> ambient_occlusion,
                            std::span<const Triangle> coarse) {
  TROCAR_ASSERT(ambient_occlusion.empty() || ambient_occlusion.size() == rest.size());
  auto free_place = std::find_if_not(surfaces_.begin(), surfaces_.end(), IsInUse);
  if (free_place == surfaces_.end()) free_place = surfaces_.insert(surfaces_.end(), Surface{});
  Surface& surface = *free_place;
  ++surface.generation;
  surface.material = material;
  surface.vertex_count = rest.size();
  glGenVertexArrays(1, &surface.array);
  for (GLuint* buffer : {&surface.moving, &surface.rest, &surface.indices}) glGenBuffers(1, buffer);

  glBindVertexArray(surface.array);
  glBindBuffer(GL_ARRAY_BUFFER, surface.moving);
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  for (const GLuint location : {0u, 1u, 2u}) glEnableVertexAttribArray(location);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(MovingVertex), offset(0));
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(MovingVertex),
                        offset(offsetof(MovingVertex, normal)));
  glBindBuffer(GL_ARRAY_BUFFER, surface.rest);
  glVertexAttribPointer(2, 4, GL_FLOAT, GL_FALSE, sizeof(RestVertex), offset(0));
  std::vector<RestVertex> rest_vertices(rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    rest_vertices[i] = {ToFloat(rest[i]), ambient_occlusion.empty() ? 1.0f : ToFloat(ambient_occlusion[i])};
  }
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(rest_vertices.size() * sizeof(RestVertex)),
               rest_vertices.data(), GL_STATIC_DRAW);
  glBindVertexArray(0);
  UploadTriangles(surface, triangles, coarse);

  std::vector<Vec3> normals(rest.size());
  geometry::CalcVertexNormals(rest, triangles, normals);
  UploadMoving(surface, rest, normals);
  return {static_cast<std::uint32_t>(free_place - surfaces_.begin()), surface.generation};
}

void SurfaceStore::Remove(SurfaceId id) {
  if (Surface* surface = Find(id)) Free(*surface);
}

Surface* SurfaceStore::Find(SurfaceId id) {
  if (id.generation % 2 == 0 || id.index >= surfaces_.size()) return nullptr;
  Surface& surface = surfaces_[id.index];
  return surface.generation == id.generation ? &surface : nullptr;
}

void SurfaceStore::UploadMoving(Surface& surface, std::span<const Vec3> positions,
                                std::span<const Vec3> normals) {
  surface.has_moved = true;
  surface.box = geometry::CalcBox(positions);
  staging_.resize(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    staging_[i] = {ToFloat(positions[i]), ToFloat(normals[i])};
  const auto bytes = static_cast<GLsizeiptr>(staging_.size() * sizeof(MovingVertex));
  glBindBuffer(GL_ARRAY_BUFFER, surface.moving);
  // a fresh store, so that the driver need not wait for the frame that still reads the old one
  glBufferData(GL_ARRAY_BUFFER, bytes, nullptr, GL_STREAM_DRAW);
  glBufferSubData(GL_ARRAY_BUFFER, 0, bytes, staging_.data());
  glBindBuffer(GL_ARRAY_BUFFER, 0);
}

void SurfaceStore::UploadMarks(Surface& surface, std::span<const SurfaceMark> marks) {
  if (surface.marks == 0) {
    glGenBuffers(1, &surface.marks);
    glBindVertexArray(surface.array);
    glBindBuffer(GL_ARRAY_BUFFER, surface.marks);
    glEnableVertexAttribArray(3);
    glVertexAttribPointer(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(SurfaceMark), nullptr);
    glEnableVertexAttribArray(5);
    glVertexAttribPointer(5, 1, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(SurfaceMark),
                          reinterpret_cast<const void*>(offsetof(SurfaceMark, pallor)));
    glBindVertexArray(0);
  }
  glBindBuffer(GL_ARRAY_BUFFER, surface.marks);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(marks.size_bytes()), marks.data(), GL_STREAM_DRAW);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
}

void SurfaceStore::UploadTriangles(Surface& surface, std::span<const Triangle> triangles,
                                   std::span<const Triangle> coarse) {
  for (const auto all : {triangles, coarse}) {
    for ([[maybe_unused]] const Triangle& t : all)
      TROCAR_ASSERT(std::max({t[0], t[1], t[2]}) < surface.vertex_count);
  }
  surface.index_count = static_cast<GLsizei>(3 * triangles.size());
  surface.coarse_count = static_cast<GLsizei>(3 * coarse.size());
  const auto bytes = static_cast<GLsizeiptr>(triangles.size_bytes()),
             coarse_bytes = static_cast<GLsizeiptr>(coarse.size_bytes());
  glBindVertexArray(surface.array);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, surface.indices);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes + coarse_bytes, nullptr, GL_STATIC_DRAW);
  glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, 0, bytes, triangles.data());
  glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, bytes, coarse_bytes, coarse.data());
  glBindVertexArray(0);
}

void SurfaceStore::Remember(Surface& surface) {
  if (surface.earlier != 0 && !surface.has_moved) return;
  const auto bytes = static_cast<GLsizeiptr>(surface.vertex_count * sizeof(MovingVertex));
  if (surface.earlier == 0) {
    glGenBuffers(1, &surface.earlier);
    glBindVertexArray(surface.array);
    glBindBuffer(GL_ARRAY_BUFFER, surface.earlier);
    glBufferData(GL_ARRAY_BUFFER, bytes, nullptr, GL_STREAM_COPY);
    glEnableVertexAttribArray(4);
    glVertexAttribPointer(4, 3, GL_FLOAT, GL_FALSE, sizeof(MovingVertex), nullptr);
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
  }
  glBindBuffer(GL_COPY_READ_BUFFER, surface.moving);
  glBindBuffer(GL_COPY_WRITE_BUFFER, surface.earlier);
  glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0, bytes);
  glBindBuffer(GL_COPY_READ_BUFFER, 0);
  glBindBuffer(GL_COPY_WRITE_BUFFER, 0);
  surface.has_moved = false;
}

geometry::TriangleMesh SurfaceStore::Read(const Surface& surface) {
  geometry::TriangleMesh mesh;
  std::vector<MovingVertex> vertices(surface.vertex_count);
  glBindBuffer(GL_ARRAY_BUFFER, surface.moving);
  glGetBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(vertices.size() * sizeof(MovingVertex)),
                     vertices.data());
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  for (const MovingVertex& vertex : vertices)
    mesh.positions.push_back({vertex.position[0], vertex.position[1], vertex.position[2]});
  mesh.triangles.resize(static_cast<std::size_t>(surface.index_count) / 3);
  glBindVertexArray(surface.array);
  glGetBufferSubData(GL_ELEMENT_ARRAY_BUFFER, 0,
                     static_cast<GLsizeiptr>(mesh.triangles.size() * sizeof(Triangle)),
                     mesh.triangles.data());
  glBindVertexArray(0);
  return mesh;
}

}  // namespace trocar::render
