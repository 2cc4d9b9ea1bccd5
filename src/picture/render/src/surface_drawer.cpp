// SPDX-License-Identifier: Apache-2.0
#include "surface_drawer.h"

#include <array>

#include "camera_matrices.h"
#include "fine_shaders.h"
#include "shaders.h"
#include "single_precision.h"

namespace trocar::render {
namespace {

/// Uniforms of a material: those that all three shaders share, then the shader's own.
void SetLook(const Program& program, const MaterialLook& look, float tool_wear) {
  const auto inverse = [](float tile) { return tile > 0.0f ? 1.0f / tile : 0.0f; };
  program.Set("u_low", look.low);
  program.Set("u_high", look.high);
  program.Set("u_gloss", Colour{look.wet, look.wet_exponent, look.sheen});
  if (look.opacity < 1.0f) {
    program.Set("u_opacity", look.opacity);
    program.Set("u_bump_scale", inverse(look.bump_tile));
    program.Set("u_bump", look.bump);
    return;
  }
  if (!look.is_tissue) {
    program.Set("u_grooves", look.grooves);
    program.Set("u_wear", tool_wear * look.wear);
    program.Set("u_lines", std::array<float, 2>{inverse(look.line_tile), look.lines});
    return;
  }
  program.Set("u_cell", look.cell);
  program.Set("u_vessel", look.vessel);
  program.Set("u_wrap", look.wrap);
  program.Set("u_detail_scale", Colour{inverse(look.detail_tile[0]), inverse(look.detail_tile[1]),
                                       inverse(look.detail_tile[2])});
  program.Set("u_broad_scale", inverse(look.broad_tile));
  program.Set("u_bump_scale", inverse(look.bump_tile));
  program.Set("u_amounts", Colour{look.cell_amount, look.vessel_amount, look.vessel_width});
  program.Set("u_bump", look.bump);
  program.Set("u_glow", look.glow);
}

}  // namespace

SurfaceDrawer::~SurfaceDrawer() {
  for (const Program& program : GetPrograms()) glDeleteProgram(program.name);
}

base::Status SurfaceDrawer::Make(const Looks& looks) {
  const std::string colours = MakeEffectColours(looks);
  for (const bool is_fine : {false, true}) {
    const auto tissue =
        MakeProgram({kSurfaceVertexShader}, {kVersion, is_fine ? kFine : "", kFragmentHead, colours.c_str(),
                                             kShadingFunctions, kTissueFragmentShader});
    if (!tissue) return tissue.error();
    tissue_[is_fine ? 1 : 0] = *tissue;
  }
  const auto tool = MakeProgram({kSurfaceVertexShader}, {kVersion, kFragmentHead, colours.c_str(),
                                                         kShadingFunctions, kToolFragmentShader});
  if (!tool) return tool.error();
  tool_ = *tool;
  const auto plain = MakeProgram({kSurfaceVertexShader}, {kVersion, kPlain, kFragmentHead, colours.c_str(),
                                                          kShadingFunctions, kToolFragmentShader});
  if (!plain) return plain.error();
  plain_ = *plain;
  const auto clear = MakeProgram({kClearVertexShader}, {kVersion, kFragmentHead, colours.c_str(),
                                                        kShadingFunctions, kClearFragmentShader});
  if (!clear) return clear.error();
  clear_ = *clear;
  noise_.Make();
  return {};
}

void SurfaceDrawer::Begin(Quality quality, double tool_wear, bool is_coarse) {
  glVertexAttrib4f(3, 0, 0, 0, 0);  // of surfaces without marks
  glVertexAttrib1f(5, 0);
  noise_.Bind();
  is_fine_ = quality == Quality::kHigh;
  is_coarse_ = is_coarse;
  tool_wear_ = ToFloat(tool_wear);
  for (const Program& program : {Tissue(), tool_, plain_, clear_}) {
    glUseProgram(program.name);
    program.Set("u_pattern", 0);
    program.Set("u_bumps", 1);
  }
}

void SurfaceDrawer::End() {
  NoiseTextures::Unbind();
}

const Program& SurfaceDrawer::FindProgram(const MaterialLook& look) const {
  if (look.opacity < 1.0f) return clear_;
  if (look.is_tissue) return Tissue();
  return look.grooves > 0.0f || look.wear > 0.0f ? tool_ : plain_;
}

void SurfaceDrawer::Draw(const Surface& surface, const math::Pose& X_camera_surface, const math::Vec3& scale,
                         const MaterialLook& look) {
  const Program& program = FindProgram(look);
  glUseProgram(program.name);
  program.Set("u_camera_from_surface", MakeMatrix(X_camera_surface, scale));
  program.Set("u_rotation", MakeRotation(X_camera_surface.rotation));
  SetLook(program, look, tool_wear_);
  if (!look.is_tissue && look.opacity >= 1.0f)
    program.Set("u_axis", ToFloat(math::Rotate(X_camera_surface.rotation, {0, 0, 1})));
  glBindVertexArray(surface.array);
  const bool is_coarse = is_coarse_ && surface.coarse_count > 0;
  const std::size_t first = is_coarse ? static_cast<std::size_t>(surface.index_count) : 0;
  glDrawElements(GL_TRIANGLES, is_coarse ? surface.coarse_count : surface.index_count, GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(first * sizeof(GLuint)));
}

}  // namespace trocar::render
