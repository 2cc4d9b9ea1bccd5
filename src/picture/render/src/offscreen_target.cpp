// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/offscreen_target.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <vector>

#include "trocar/base/assert.h"

namespace trocar::render {

struct OffscreenTarget::Content {
  int width = 0, height = 0;
  GLuint framebuffer = 0, colour = 0, depth = 0;

  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteRenderbuffers(1, &colour);
    glDeleteRenderbuffers(1, &depth);
  }
};

OffscreenTarget::OffscreenTarget(std::unique_ptr<Content> content) : content_(std::move(content)) {}
OffscreenTarget::OffscreenTarget(OffscreenTarget&&) noexcept = default;
OffscreenTarget& OffscreenTarget::operator=(OffscreenTarget&&) noexcept = default;
OffscreenTarget::~OffscreenTarget() = default;

base::Result<OffscreenTarget> OffscreenTarget::Make(int width, int height) {
  TROCAR_ASSERT(width >= 1 && width <= 8192 && height >= 1 && height <= 8192);
  auto content = std::make_unique<Content>();
  content->width = width;
  content->height = height;
  glGenFramebuffers(1, &content->framebuffer);
  glGenRenderbuffers(1, &content->colour);
  glGenRenderbuffers(1, &content->depth);
  glBindRenderbuffer(GL_RENDERBUFFER, content->colour);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, content->depth);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, content->framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, content->colour);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, content->depth);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return base::Error{base::ErrorCode::kNoGraphics,
                       "the driver refuses a framebuffer of " + std::to_string(width) + " x " +
                           std::to_string(height) + " pixels; choose a smaller picture"};
  }
  return OffscreenTarget(std::move(content));
}

int OffscreenTarget::Width() const {
  return content_->width;
}
int OffscreenTarget::Height() const {
  return content_->height;
}

void OffscreenTarget::Bind() {
  glBindFramebuffer(GL_FRAMEBUFFER, content_->framebuffer);
}

void OffscreenTarget::Read(Image& image) {
  image.width = content_->width;
  image.height = content_->height;
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(image.width);
  const auto rows = static_cast<std::size_t>(image.height);
  image.pixels.resize(row_bytes * rows);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, content_->framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE, image.pixels.data());
  // OpenGL's first row is the bottom one
  for (std::size_t row = 0; row < rows / 2; ++row) {
    std::swap_ranges(image.pixels.begin() + static_cast<std::ptrdiff_t>(row * row_bytes),
                     image.pixels.begin() + static_cast<std::ptrdiff_t>((row + 1) * row_bytes),
                     image.pixels.begin() + static_cast<std::ptrdiff_t>((rows - 1 - row) * row_bytes));
  }
}

}  // namespace trocar::render
