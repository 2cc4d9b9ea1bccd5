// SPDX-License-Identifier: Apache-2.0
/// \file laparoscope_view.h  View of a running simulation through the laparoscope.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/render/renderer.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/simulation.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// View settings that a person may switch while looking.
struct ViewOptions {
  bool has_force_arrows = true;
  bool has_mask = true;
  bool has_background = true;  ///< decoration: abdominal wall, omentum, bowel
  bool has_smooth_edges = true;
  bool is_wireframe = false;
  double light_power = 1;  ///< [-], 0 to 4
  bool has_automatic_exposure = true;
  render::Quality quality = render::Quality::kHigh;
  double resolution = 1;             ///< as render::Frame's
  double arrow_scale = 0.008;        ///< length of a force arrow [m/N]
  double tool_wear = 1;              ///< scratches of tools, in those of the looks, 0 to 1.6 [-]
  std::vector<render::Blot> stains;  ///< on the lens, which nobody wipes

  friend bool operator==(const ViewOptions&, const ViewOptions&) = default;
};

/// A line through the picture: the way of a tip, or the shaft of a tool that is not there.
struct Trail {
  std::vector<math::Vec3> points;  ///< world frame [m]
  render::Material material = render::Material::kMark;
  double width = 0.0008;  ///< [m]
};

/// Additions of a replay to the picture of the scene.
struct Overlay {
  std::optional<math::Pose> X_world_camera;  ///< looks from here in place of the laparoscope, along -z
  std::vector<Trail> trails;
};

/// The ways of both tips: the left hand's blue, the right hand's yellow.
std::vector<Trail> MakePathTrails(std::span<const math::Vec3> left, std::span<const math::Vec3> right);
/// Shafts and jaws of the tools of another attempt, in white.
std::vector<Trail> MakeGhosts(const simulation::Snapshot& other);

struct LabelledMesh {
  geometry::TriangleMesh mesh;  ///< world frame [m]
  std::uint16_t label = 0;      ///< of labels.h
};

/// Organs, ducts, vessels, instruments and trocars of one scene in one OpenGL context, what surgery has changed, and the
/// abdomen round them. The context must be current whenever a member is called and at destruction.
class LaparoscopeView {
 public:
  /// \param surfaces  of Simulation::Surfaces()
  /// \param start     first snapshot: its shapes are the rest shapes that the surfaces' patterns stick to
  /// \param strands   that dissection divides, in the order of OperationSnapshot::strand_is_intact
  /// \return the renderer's error, or kUnknownName for a material that render/material.h does not know
  static base::Result<LaparoscopeView> Make(const scene::Scene& scene,
                                            std::span<const scene::SurfaceInfo> surfaces,
                                            const simulation::Snapshot& start,
                                            std::span<const scene::StrandInfo> strands = {});

  LaparoscopeView(LaparoscopeView&&) noexcept;
  LaparoscopeView& operator=(LaparoscopeView&&) noexcept;
  ~LaparoscopeView();

  void SetOptions(const ViewOptions& options);
  const ViewOptions& GetOptions() const;

  /// Until the next call.
  void SetOverlay(Overlay overlay);

  /// Takes over shapes and poses of a snapshot of the same scene.
  void Update(const simulation::Snapshot& snapshot);
  /// Draws the last snapshot into the bound framebuffer.
  /// \param width, height  of it [pixels]
  void Draw(int width, int height);

  /// Draws depth, normal and label (labels.h) at each pixel of the picture that Draw() makes.
  /// \return the renderer's error
  base::Status DrawGeometry(int width, int height, render::GeometryPicture& picture);
  /// As DrawGeometry, with the optical flow since this was called last.
  base::Status DrawGeometryAndFlow(int width, int height, render::GeometryPicture& picture);
  /// The surfaces of that picture in the world, as the graphics card has them; for tests and for measuring.
  std::vector<LabelledMesh> ReadMeshes() const;
  /// Of the laparoscope's camera in a picture of that height [pixels]; its principal point is the picture's middle.
  double FocalLength(int height) const;

  /// The frame that Draw() draws, for read-outs and tests.
  const render::Frame& GetFrame() const;

 private:
  struct Content;
  explicit LaparoscopeView(std::unique_ptr<Content> content);
  base::Status DrawGeometryNow(int width, int height, bool has_flow, render::GeometryPicture& picture);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::view
