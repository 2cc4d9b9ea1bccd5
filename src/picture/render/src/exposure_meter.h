// SPDX-License-Identifier: Apache-2.0
/// \file exposure_meter.h  Exposure as a camera controls it: from its own last picture, smoothly, within bounds.
///
/// It knows no clock: how fast it follows depends on the frames' own times, so that the same frames give the same pictures.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <span>

namespace trocar::render {

/// Bounds of the exposure [-].
inline constexpr double kLeastExposure = 0.30, kMostExposure = 2.6;

/// Exposure that suits a picture.
/// \param pixels    (4 n) red, green, blue, anything; of the round picture only
/// \param exposure  with which it was taken [-]
/// \return  within the bounds [-]; `exposure` for a picture in which nothing is lit
double CalcWantedExposure(std::span<const std::uint8_t> pixels, double exposure) noexcept;

/// Needs the OpenGL context of the renderer that owns it.
class ExposureMeter {
 public:
  ExposureMeter() = default;
  ExposureMeter(const ExposureMeter&) = delete;
  ExposureMeter& operator=(const ExposureMeter&) = delete;
  ~ExposureMeter();

  /// Takes over the last picture, and gives the exposure of the next.
  /// \param time  of the scene [s]; after a leap in it the exposure is to be found anew
  double Next(double time);
  /// Keeps a small copy of the bound read framebuffer's picture for the next call of Next.
  /// \param has_mask  only its circle counts
  void Look(bool has_mask, int width, int height);
  /// A first picture, or one after a leap, is drawn again until its exposure suits it.
  bool IsToBeDrawnAgain() const { return rounds_left_ > 0; }

 private:
  static constexpr int kColumns = 48, kRows = 27;

  double ReadWanted();

  GLuint framebuffer_ = 0, colour_ = 0;
  bool has_mask_ = true, has_picture_ = false;
  double aspect_ = 1;
  int rounds_left_ = 0;
  double time_ = 0, exposure_ = 1;
  std::array<std::uint8_t, 4 * std::size_t{kColumns} * kRows> pixels_{}, lit_{};
};

}  // namespace trocar::render
