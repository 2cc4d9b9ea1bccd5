// SPDX-License-Identifier: Apache-2.0
/// \file shaders.h  GLSL 3.30 sources. Everything is lit in the camera's frame, in metres.
#pragma once

#include <string>

#include "trocar/render/looks.h"

namespace trocar::render {

extern const char* const kSurfaceVertexShader;  ///< for both fragment shaders below
extern const char* const kFragmentHead;         ///< goes before either of them
extern const char* const kShadingFunctions;     ///< goes between, after MakeEffectColours
extern const char* const kTissueFragmentShader;
extern const char* const kToolFragmentShader;
extern const char* const kScreenVertexShader;  ///< the picture's circle or rectangle
extern const char* const kVersion;             ///< first line of a source that the line kFine may follow
extern const char* const kFine;                ///< defines FINE: with what Quality::kHigh adds
extern const char* const kSmeared;             ///< defines SMEARED: with what sticks to the lens
extern const char* const kPlain;  ///< defines PLAIN: a tool of even plastic or rubber, without texture
extern const char* const kSmoothFragmentShader;  ///< softens stairs where brightness jumps, adds the glow
extern const char* const kFullVertexShader;      ///< the whole target
extern const char* const kGlowFragmentShader;    ///< what is bright, then blurred along one axis
extern const char* const kMaskVertexShader;      ///< black frame round the picture, nearest of all
extern const char* const kMaskFragmentShader;

/// The colours of Looks::effects as constants of the shaders, "const vec3 kSmoke = vec3(...);" for each.
std::string MakeEffectColours(const Looks& looks);

}  // namespace trocar::render
