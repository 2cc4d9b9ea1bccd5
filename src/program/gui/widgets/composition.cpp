// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/composition.h"

#include <epoxy/gl.h>
#include <gtk/gtk.h>

#include "trocar/gui/software_renderer.h"

namespace trocar::gui {

void ChooseComposition() {
  GdkDisplay* display = gdk_display_get_default();
  GdkGLContext* context = display == nullptr ? nullptr : gdk_display_create_gl_context(display, nullptr);
  // without OpenGL the picture itself says so
  if (context == nullptr) return;
  if (gdk_gl_context_realize(context, nullptr)) {
    gdk_gl_context_make_current(context);
    const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    if (renderer != nullptr && IsSoftwareRenderer(renderer)) g_setenv("GSK_RENDERER", "cairo", FALSE);
    gdk_gl_context_clear_current();
  }
  g_object_unref(context);
}

}  // namespace trocar::gui
