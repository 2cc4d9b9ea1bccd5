// SPDX-License-Identifier: Apache-2.0
/// \file hand_tools.h  The tools of both hands as they are seen: the one in use, its trocar, its sparks.
#pragma once

#include <array>
#include <vector>

#include "trocar/instrument/tool.h"
#include "trocar/render/renderer.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

class HandTools {
 public:
  /// Uploads every tool of both trays, so that an exchange shows at once.
  void Add(render::Renderer& renderer, const scene::Scene& scene);
  /// Adds tools, the assistant's grasper, sleeves, the shade that they throw, and what comes out of tips.
  void AddTo(render::Frame& frame, const simulation::Snapshot& snapshot) const;

 private:
  struct Part {
    instrument::ToolPart::Kind kind;
    render::SurfaceId surface;
  };
  struct ShownTool {
    instrument::Tool tool;
    std::vector<Part> parts;
  };
  struct Hand {
    std::vector<ShownTool> tray;
    math::Vec3 p_world_port;
    render::SurfaceId sleeve;
  };
  void AddClouds(render::Frame& frame, const simulation::Snapshot& snapshot, std::size_t hand,
                 const instrument::Tool& tool) const;
  void AddAssistant(render::Frame& frame, const simulation::Snapshot& snapshot) const;

  std::array<Hand, instrument::kHandCount> hands_;
  ShownTool assistant_;  // the third grasper
  scene::SuctionParameters suction_;
};

}  // namespace trocar::view
