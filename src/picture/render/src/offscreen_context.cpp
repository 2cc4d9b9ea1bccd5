// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/offscreen_context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <string_view>
#include <vector>

namespace trocar::render {
namespace {

constexpr const char* kRemedy =
    "; install libegl1 and libgl1-mesa-dri (apt-get install libegl1 libgl1-mesa-dri), then ask `trocar "
    "doctor`";

base::Error NoGraphics(const std::string& why) {
  return {base::ErrorCode::kNoGraphics, "no OpenGL context can be made: " + why + kRemedy};
}

base::Error TooOld(const std::string& version) {
  return {base::ErrorCode::kGraphicsTooOld,
          "OpenGL here is " + version + ", 3.3 is needed; update the graphics driver, or unset " +
              "MESA_GL_VERSION_OVERRIDE, or draw in software with LIBGL_ALWAYS_SOFTWARE=1"};
}

/// Process that was the first, here or among this one's parents, to ask for graphics; 0 before that.
std::atomic<::pid_t> first_process{0};

bool IsFork() noexcept {
  const ::pid_t first = first_process.load();
  return first != 0 && first != ::getpid();
}

base::Error NotInForks() {
  return {base::ErrorCode::kEnvironmentState,
          "this process is a fork of one that has begun to draw, and graphics drivers do not work in forks; "
          "start "
          "processes that draw with \"spawn\" or \"forkserver\", or fork before the first picture"};
}

bool HasWord(const char* words, std::string_view word) {
  const std::string_view text = words == nullptr ? std::string_view() : words;
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || text[at - 1] == ' ') && (end == text.size() || text[end] == ' ')) return true;
  }
  return false;
}

template <typename Function>
Function FindFunction(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

/// Displays that need no window system, best first.
std::vector<EGLDisplay> FindDisplays() {
  std::vector<EGLDisplay> displays;
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  // through eglGetProcAddress, because epoxy ends the program where an entry point is missing
  const auto get_display = FindFunction<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  if (get_display == nullptr || !HasWord(extensions, "EGL_EXT_platform_base")) return displays;
  const auto add = [&displays](EGLDisplay display) {
    if (display != EGL_NO_DISPLAY) displays.push_back(display);
  };
  if (HasWord(extensions, "EGL_MESA_platform_surfaceless")) {
    add(get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr));
  }
  const auto query_devices = FindFunction<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  if (query_devices != nullptr && HasWord(extensions, "EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_TRUE) {
      for (EGLint i = 0; i < count; ++i) {
        add(get_display(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
      }
    }
  }
  return displays;
}

std::string GlText(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text == nullptr ? "unknown" : reinterpret_cast<const char*>(text);
}

}  // namespace

struct OffscreenContext::Content {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  std::string version, renderer;

  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  // the display stays initialised: EGL shares it between all contexts of the process
  ~Content() {
    if (context == EGL_NO_CONTEXT || IsFork()) return;
    if (eglGetCurrentContext() == context) {
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    eglDestroyContext(display, context);
  }

  bool MakeCurrent() { return eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE; }
};

OffscreenContext::OffscreenContext(std::unique_ptr<Content> content) : content_(std::move(content)) {}
OffscreenContext::OffscreenContext(OffscreenContext&&) noexcept = default;
OffscreenContext& OffscreenContext::operator=(OffscreenContext&&) noexcept = default;
OffscreenContext::~OffscreenContext() = default;

base::Result<OffscreenContext> OffscreenContext::Make() {
  if (IsFork()) return NotInForks();
  // epoxy ends the program where the library is missing, so look before it does; the handle is kept on
  // purpose
  if (::dlopen("libEGL.so.1", RTLD_LAZY | RTLD_GLOBAL) == nullptr)
    return NoGraphics("libEGL.so.1 is not installed");

  ::pid_t none = 0;
  first_process.compare_exchange_strong(none, ::getpid());
  std::string why = "EGL offers no display that works without a window system";
  std::string old_version;
  for (const EGLDisplay display : FindDisplays()) {
    if (eglInitialize(display, nullptr, nullptr) != EGL_TRUE) {
      why = "EGL finds no driver";
      continue;
    }
    const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
    if (!HasWord(extensions, "EGL_KHR_surfaceless_context") ||
        !HasWord(extensions, "EGL_KHR_create_context") || eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) {
      why = "the EGL driver has no desktop OpenGL without a surface";
      continue;
    }
    const EGLint config_wish[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE,
                                  EGL_NONE};
    EGLConfig config = nullptr;
    EGLint config_count = 0;
    if (eglChooseConfig(display, config_wish, &config, 1, &config_count) != EGL_TRUE || config_count == 0) {
      why = "the EGL driver has no configuration for desktop OpenGL";
      continue;
    }
    auto content = std::make_unique<Content>();
    content->display = display;
    const EGLint core_3_3[] = {EGL_CONTEXT_MAJOR_VERSION_KHR,
                               3,
                               EGL_CONTEXT_MINOR_VERSION_KHR,
                               3,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK_KHR,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT_KHR,
                               EGL_NONE};
    content->context = eglCreateContext(display, config, EGL_NO_CONTEXT, core_3_3);
    const bool is_core = content->context != EGL_NO_CONTEXT;
    // an older driver refuses 3.3: take what it has, only to say which version that is
    if (!is_core) content->context = eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
    if (content->context == EGL_NO_CONTEXT || !content->MakeCurrent()) {
      why = "the EGL driver makes no context";
      continue;
    }
    content->version = GlText(GL_VERSION);
    content->renderer = GlText(GL_RENDERER);
    if (!is_core || epoxy_gl_version() < 33) {
      old_version = content->version;
      continue;
    }
    return OffscreenContext(std::move(content));
  }
  if (!old_version.empty()) return TooOld(old_version);
  return NoGraphics(why);
}

base::Status OffscreenContext::MakeCurrent() {
  if (IsFork()) return NotInForks();
  if (!content_->MakeCurrent()) return NoGraphics("the context is current on another thread");
  return {};
}

void OffscreenContext::Release() {
  if (IsFork()) return;
  eglMakeCurrent(content_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

const std::string& OffscreenContext::VersionText() const {
  return content_->version;
}
const std::string& OffscreenContext::RendererText() const {
  return content_->renderer;
}

}  // namespace trocar::render
