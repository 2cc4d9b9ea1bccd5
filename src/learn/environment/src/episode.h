// SPDX-License-Identifier: Apache-2.0
/// \file episode.h  Defaults for an episode of a scene: how long it lasts, and whether it is about the camera.
#pragma once

#include "trocar/scene/scene.h"

namespace trocar::environment {

/// After which an episode is cut off where nobody says otherwise [s].
double UsualSeconds(const scene::Scene& scene) noexcept;

/// Whether a goal is about what the laparoscope shows.
bool IsAboutCamera(const scene::Scene& scene) noexcept;

}  // namespace trocar::environment
