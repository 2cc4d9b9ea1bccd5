// SPDX-License-Identifier: Apache-2.0
/// \file guides.h  Guides that help a beginner to see depth in a flat picture: marks that are drawn, and no part of the scene.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::presenter {

/// Where a straight line first meets something that a tool can touch: tissue, fibres and fat between organs, and things that no
/// hand holds.
///
/// \param from       [m]
/// \param direction  unit
/// \param surfaces   of Simulation::Surfaces(); where an operation has cut, the snapshot's triangles take their place
/// \param strands    of Simulation::Strands(); those that are divided are nothing
/// \return  distance [m], or nothing within kLongestGuide
std::optional<double> FindDistanceAhead(const scene::Scene& scene,
                                        std::span<const scene::SurfaceInfo> surfaces,
                                        std::span<const scene::StrandInfo> strands,
                                        const simulation::Snapshot& snapshot, const math::Vec3& from,
                                        const math::Vec3& direction) noexcept;
inline constexpr double kLongestGuide = 0.20;  // [m]

/// A ring that is drawn over the scene. \param normal  unit
view::Trail MakeRing(const math::Vec3& centre, const math::Vec3& normal, double radius,
                     render::Material material);

/// The thing that the next step of the task is about, and where it is to go once it is in the jaws.
struct NextStep {
  int object = -1;           ///< Scene::objects, or -1
  std::vector<int> regions;  ///< Task::regions that are free; empty before the thing has been taken
};
NextStep FindNextStep(const scene::Task& task, const simulation::Snapshot& snapshot);

/// From each tip a line to what lies below it (in a box: downwards; in a patient: the way of the wheel, along the line of sight),
/// with a ring where it meets it; a ring round a tip that is about to touch, and another colour once it does; a ring round jaws that hold; a ring round the next thing, and round the places for it.
std::vector<view::Trail> MakeGuides(const scene::Scene& scene, std::span<const scene::SurfaceInfo> surfaces,
                                    std::span<const scene::StrandInfo> strands,
                                    const simulation::Snapshot& snapshot);

/// "open", "closed", "holds ring 1", "holds the liver"; empty for a tool without jaws that holds nothing.
std::string DescribeJaws(const scene::Scene& scene, const simulation::Snapshot& snapshot,
                         instrument::Hand hand);

}  // namespace trocar::presenter
