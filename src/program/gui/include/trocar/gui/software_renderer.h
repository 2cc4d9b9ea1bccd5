// SPDX-License-Identifier: Apache-2.0
/// \file software_renderer.h  Is OpenGL done by the processor?
#pragma once

#include <string_view>

namespace trocar::gui {

/// \param renderer  what OpenGL says in GL_RENDERER, for example "llvmpipe (LLVM 15.0.6, 256 bits)"
/// \return true for Mesa's software drivers, old and new
bool IsSoftwareRenderer(std::string_view renderer) noexcept;

}  // namespace trocar::gui
