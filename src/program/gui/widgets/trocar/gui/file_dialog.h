// SPDX-License-Identifier: Apache-2.0
/// \file file_dialog.h  The system's dialog that asks for a file.
#pragma once

#include <gtkmm.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace trocar::gui {

struct FileRequest {
  /// Of files: "Recordings", "*.trocar".
  struct Kind {
    std::string name, pattern;
  };
  std::string title;
  std::string accept;       ///< on the button; empty: "Save" or "Open"
  std::string new_name;     ///< proposed for a file that is written; empty: one that is there is opened
  std::vector<Kind> kinds;  ///< that are shown; empty: all
  bool is_folder = false;   ///< a folder that is there is chosen
};

/// Asks one question at a time. It is a member of the window or view that asks: with it goes the request, which would otherwise
/// answer somebody who is no longer there.
class FileDialog {
 public:
  /// \param act  told the file; not at all where the person cancels. It may ask again
  void Ask(Gtk::Window& parent, const FileRequest& request, std::function<void(std::filesystem::path)> act);
  /// As above, for a widget, in whose window the dialog opens; nothing while it is in none.
  void Ask(Gtk::Widget& asker, const FileRequest& request, std::function<void(std::filesystem::path)> act);

 private:
  Glib::RefPtr<Gtk::FileChooserNative> dialog_;
};

}  // namespace trocar::gui
