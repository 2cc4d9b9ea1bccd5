// SPDX-License-Identifier: Apache-2.0
#include "embree_comparison.h"

#if TROCAR_EMBREE == 3
#include <embree3/rtcore.h>
#elif TROCAR_EMBREE == 4
#include <embree4/rtcore.h>
#endif

#include <cmath>
#include <limits>

#if TROCAR_EMBREE
#include <dlfcn.h>
#endif

#include "trocar/geometry/distance.h"

namespace trocar::bench {

#if TROCAR_EMBREE

namespace {

constexpr const char* kLibrary = TROCAR_EMBREE == 3 ? "libembree3.so.3" : "libembree4.so.4";

/// What is used of the library, by name.
struct Embree {
// the formatter finds no rest here
// clang-format off
#define TROCAR_EMBREE_FUNCTIONS(DO) \
  DO(rtcNewDevice) DO(rtcReleaseDevice) DO(rtcNewScene) \
  DO(rtcReleaseScene) DO(rtcSetSceneFlags) DO(rtcSetSceneBuildQuality) \
  DO(rtcCommitScene) DO(rtcNewGeometry) DO(rtcReleaseGeometry) \
  DO(rtcSetGeometryBuildQuality) DO(rtcSetNewGeometryBuffer) DO(rtcUpdateGeometryBuffer) \
  DO(rtcCommitGeometry) DO(rtcAttachGeometry) DO(rtcPointQuery)
// clang-format on
#define TROCAR_DECLARE(NAME) decltype(&::NAME) NAME = nullptr;
  TROCAR_EMBREE_FUNCTIONS(TROCAR_DECLARE)
#undef TROCAR_DECLARE

  /// \return false with the loader's reason
  bool Load(std::string& why_not) {
    void* library = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
      why_not = "Embree is not installed (libembree-dev): nothing to compare with";
      return false;
    }
#define TROCAR_FIND(NAME)                                            \
  NAME = reinterpret_cast<decltype(&::NAME)>(dlsym(library, #NAME)); \
  if (NAME == nullptr) {                                             \
    why_not = std::string(kLibrary) + " has no " #NAME;              \
    return false;                                                    \
  }
    TROCAR_EMBREE_FUNCTIONS(TROCAR_FIND)
#undef TROCAR_FIND
#undef TROCAR_EMBREE_FUNCTIONS
    return true;
  }
};

}  // namespace

struct EmbreeMesh::Content {
  Embree embree;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  float* vertices = nullptr;  // (3 nv) the library's
  std::span<const geometry::Triangle> triangles;
};

namespace {

/// A point query in flight.
struct Query {
  const float* vertices;
  std::span<const geometry::Triangle> triangles;
  math::Vec3 p;
  double best2 = std::numeric_limits<double>::infinity();
};

bool Consider(RTCPointQueryFunctionArguments* arguments) {
  Query& query = *static_cast<Query*>(arguments->userPtr);
  const auto corner = [&](std::uint32_t vertex) {
    const float* v = query.vertices + 3 * static_cast<std::size_t>(vertex);
    return math::Vec3{v[0], v[1], v[2]};
  };
  const auto& [a, b, c] = query.triangles[arguments->primID];
  const auto nearest = geometry::FindNearestOnTriangle(query.p, corner(a), corner(b), corner(c));
  const double d2 = math::SquaredDistance(nearest.point, query.p);
  if (!(d2 < query.best2)) return false;
  query.best2 = d2;
  arguments->query->radius = static_cast<float>(std::sqrt(d2));
  return true;
}

}  // namespace

std::unique_ptr<EmbreeMesh> EmbreeMesh::Make(const geometry::TriangleMesh& mesh, std::string& why_not) {
  auto content = std::make_unique<Content>();
  Embree& embree = content->embree;
  if (!embree.Load(why_not)) return nullptr;
  content->triangles = mesh.triangles;
  content->device = embree.rtcNewDevice("threads=1");
  content->scene = embree.rtcNewScene(content->device);
  embree.rtcSetSceneFlags(content->scene, RTC_SCENE_FLAG_DYNAMIC);
  embree.rtcSetSceneBuildQuality(content->scene, RTC_BUILD_QUALITY_LOW);
  content->geometry = embree.rtcNewGeometry(content->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  embree.rtcSetGeometryBuildQuality(content->geometry, RTC_BUILD_QUALITY_REFIT);
  content->vertices = static_cast<float*>(
      embree.rtcSetNewGeometryBuffer(content->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                     3 * sizeof(float), mesh.positions.size()));
  auto* indices = static_cast<std::uint32_t*>(
      embree.rtcSetNewGeometryBuffer(content->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                     3 * sizeof(std::uint32_t), mesh.triangles.size()));
  for (const geometry::Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) *indices++ = vertex;
  }
  std::unique_ptr<EmbreeMesh> made(new EmbreeMesh(std::move(content)));
  made->SetPositions(mesh.positions);
  embree.rtcCommitGeometry(made->content_->geometry);
  embree.rtcAttachGeometry(made->content_->scene, made->content_->geometry);
  embree.rtcCommitScene(made->content_->scene);
  return made;
}

EmbreeMesh::~EmbreeMesh() {
  content_->embree.rtcReleaseGeometry(content_->geometry);
  content_->embree.rtcReleaseScene(content_->scene);
  content_->embree.rtcReleaseDevice(content_->device);
}

void EmbreeMesh::SetPositions(std::span<const math::Vec3> positions) {
  float* to = content_->vertices;
  for (const math::Vec3& p : positions) {
    for (int axis = 0; axis < 3; ++axis) *to++ = static_cast<float>(p[axis]);
  }
}

void EmbreeMesh::Refit() {
  content_->embree.rtcUpdateGeometryBuffer(content_->geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  content_->embree.rtcCommitGeometry(content_->geometry);
  content_->embree.rtcCommitScene(content_->scene);
}

double EmbreeMesh::FindDistance(const math::Vec3& p) const {
  Query query{content_->vertices, content_->triangles, p};
  RTCPointQuery point{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0.0f,
                      std::numeric_limits<float>::infinity()};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  content_->embree.rtcPointQuery(content_->scene, &point, &context, Consider, &query);
  return std::sqrt(query.best2);
}

std::string EmbreeMesh::Version() {
  return "Embree " RTC_VERSION_STRING;
}

#else

struct EmbreeMesh::Content {};

std::unique_ptr<EmbreeMesh> EmbreeMesh::Make(const geometry::TriangleMesh&, std::string& why_not) {
  why_not = "built without Embree (libembree-dev): nothing to compare with";
  return nullptr;
}
EmbreeMesh::~EmbreeMesh() = default;
void EmbreeMesh::SetPositions(std::span<const math::Vec3>) {}
void EmbreeMesh::Refit() {}
double EmbreeMesh::FindDistance(const math::Vec3&) const {
  return std::numeric_limits<double>::quiet_NaN();
}
std::string EmbreeMesh::Version() {
  return {};
}

#endif

EmbreeMesh::EmbreeMesh(std::unique_ptr<Content> content) : content_(std::move(content)) {}

}  // namespace trocar::bench
