// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/window_screenshot.h"

namespace trocar::gui {

namespace {

/// False where it has nothing to show yet.
base::Result<bool> TrySave(Gtk::Widget& widget, const std::filesystem::path& path) {
  const auto paintable = Gtk::WidgetPaintable::create(widget);
  const auto snapshot = Gtk::Snapshot::create();
  paintable->snapshot(snapshot, widget.get_width(), widget.get_height());
  GskRenderNode* node = gtk_snapshot_to_node(snapshot->gobj());
  GtkNative* native = gtk_widget_get_native(widget.gobj());
  GdkTexture* texture = node == nullptr || native == nullptr
                            ? nullptr
                            : gsk_renderer_render_texture(gtk_native_get_renderer(native), node, nullptr);
  const bool is_saved = texture != nullptr && gdk_texture_save_to_png(texture, path.c_str());
  const bool is_drawn = texture != nullptr;
  if (is_drawn) g_object_unref(texture);
  if (node != nullptr) gsk_render_node_unref(node);
  if (!is_drawn) return false;
  if (is_saved) return true;
  return base::Error{base::ErrorCode::kFileUnwritable,
                     "cannot write " + path.string() + ": check the folder and its permissions"};
}

base::Status Save(Gtk::Widget& widget, const std::filesystem::path& path) {
  const auto saved = TrySave(widget, path);
  if (!saved.ok()) return saved.error();
  if (*saved) return {};
  return base::Error{base::ErrorCode::kNoGraphics,
                     "the window shows nothing that " + path.string() + " could hold; try again"};
}

}  // namespace

base::Result<bool> TrySaveScreenshot(Gtk::Window& window, const std::filesystem::path& path) {
  return TrySave(window, path);
}

base::Status SaveScreenshot(Gtk::Window& window, const std::filesystem::path& path) {
  return Save(window, path);
}

base::Status SaveWidgetPicture(Gtk::Widget& widget, const std::filesystem::path& path) {
  return Save(widget, path);
}

}  // namespace trocar::gui
