// SPDX-License-Identifier: Apache-2.0
#include "exposure_meter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "trocar/render/frame.h"
#include "trocar/render/tone_curve.h"

namespace trocar::render {
namespace {

constexpr double kMiddle = 0.17;       // light that the picture's geometric mean is led to [-]
constexpr double kBrightShare = 0.96;  // this share of the picture ...
constexpr double kBrightLight = 1.5;   // ... stays below this light [-]
constexpr double kDarkest = 0.004;     // light; darker pixels do not drag the mean down further [-]
/// A camera makes up for most of a change of light, not all of it: what is near stays brighter.
constexpr double kFollowing = 0.75;
constexpr double kSettling = 0.35;  // s in which a change is followed to 63 %
constexpr double kLeap = 1.0;       // s; a frame so much later is of another moment
constexpr int kRounds = 4;          // of drawing after a leap

}  // namespace

double CalcWantedExposure(std::span<const std::uint8_t> pixels, double exposure) noexcept {
  std::array<int, 256> counts{};
  int all = 0;
  double logs = 0;
  for (std::size_t i = 0; i + 3 < pixels.size(); i += 4) {
    // nothing is drawn there: what is lit is as bright for that
    if (pixels[i] == 0 && pixels[i + 1] == 0 && pixels[i + 2] == 0) continue;
    const double shown = (0.299 * pixels[i] + 0.587 * pixels[i + 1] + 0.114 * pixels[i + 2]) / 255.0;
    ++counts[static_cast<std::size_t>(std::clamp(255.0 * shown + 0.5, 0.0, 255.0))];
    logs += std::log(std::max(kDarkest, CalcLightShown(std::min(shown, 0.995))));
    ++all;
  }
  if (all == 0) return exposure;
  const double middle = std::exp(logs / all) / exposure;
  int below = 0, bright = 0;
  while (bright < 255 && below + counts[static_cast<std::size_t>(bright)] < kBrightShare * all)
    below += counts[static_cast<std::size_t>(bright++)];
  const double brightest = CalcLightShown(std::min(bright / 255.0, 0.995)) / exposure;
  const double wanted =
      std::min(std::pow(kMiddle / middle, kFollowing), kBrightLight / std::max(brightest, 1e-6));
  return std::clamp(wanted, kLeastExposure, kMostExposure);
}

ExposureMeter::~ExposureMeter() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteRenderbuffers(1, &colour_);
}

double ExposureMeter::Next(double time) {
  if (!has_picture_) {
    rounds_left_ = kRounds;
  } else if (rounds_left_ > 0) {
    --rounds_left_;
    exposure_ = ReadWanted();
  } else if (time < time_ || time > time_ + kLeap) {
    rounds_left_ = kRounds;
  } else if (time > time_) {
    const double share = 1.0 - std::exp(-(time - time_) / kSettling);
    exposure_ *= std::pow(ReadWanted() / exposure_, share);
  }
  time_ = time;
  return exposure_;
}

void ExposureMeter::Look(bool has_mask, int width, int height) {
  GLint drawn = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn);
  if (framebuffer_ == 0) {
    glGenFramebuffers(1, &framebuffer_);
    glGenRenderbuffers(1, &colour_);
    glBindRenderbuffer(GL_RENDERBUFFER, colour_);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, kColumns, kRows);
    glBindRenderbuffer(GL_RENDERBUFFER, 0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
    glFramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
  }
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
  // one pixel of each field: the mean of a thousand of them does not flicker
  glBlitFramebuffer(0, 0, width, height, 0, 0, kColumns, kRows, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(drawn));
  has_mask_ = has_mask;
  aspect_ = static_cast<double>(width) / height;
  has_picture_ = true;
}

double ExposureMeter::ReadWanted() {
  GLint read = 0;
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, kColumns, kRows, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read));
  std::size_t count = 0;
  constexpr double kRim = 0.85;  // share of the circle's radius; farther out it is dark by itself
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const double down = 2.0 * (y + 0.5) / kRows - 1.0, right = (2.0 * (x + 0.5) / kColumns - 1.0) * aspect_;
      if (has_mask_ && std::hypot(down, right) > kRim * kMaskDiameter) continue;
      std::copy_n(pixels_.begin() + 4 * (static_cast<std::ptrdiff_t>(y) * kColumns + x), 4,
                  lit_.begin() + static_cast<std::ptrdiff_t>(4 * count++));
    }
  }
  return CalcWantedExposure(std::span(lit_).first(4 * count), exposure_);
}

}  // namespace trocar::render
