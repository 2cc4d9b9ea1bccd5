// SPDX-License-Identifier: Apache-2.0
/// \file fine_shaders.h  GLSL 3.30 sources for fibres, blobs and what light passes through.
#pragma once

namespace trocar::render {

// fibres and blobs: lit at their corners, of which there is one every few pixels
extern const char* const kFineVertexHead;  ///< goes before kShadingFunctions
extern const char* const kFineVertexShader;
extern const char* const kFineFragmentShader;

// surfaces of materials with opacity below 1; the fragment shader goes after kShadingFunctions and leaves opacity in alpha
extern const char* const kClearVertexShader;
extern const char* const kClearFragmentShader;

}  // namespace trocar::render
