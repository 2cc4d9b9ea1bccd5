// SPDX-License-Identifier: Apache-2.0
/// \file fine_shaders.h  GLSL 3.30 sources for fibres, blobs and what light passes through.
#pragma once

namespace trocar::render {

extern const char* const kFibreVertexShader;
extern const char* const kBlobVertexShader;
extern const char* const kClearVertexShader;  ///< for surfaces of materials with opacity below 1

// these go after kShadingFunctions
extern const char* const kFineFragmentShader;   ///< fibres and blobs
extern const char* const kClearFragmentShader;  ///< films, puddles and the pouch; leaves opacity in alpha

}  // namespace trocar::render
