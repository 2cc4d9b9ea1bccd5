// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/file_dialog.h"

#include <utility>

#include "trocar/host/translate.h"

namespace trocar::gui {

void FileDialog::Ask(Gtk::Window& parent, const FileRequest& request,
                     std::function<void(std::filesystem::path)> act) {
  const bool is_new = !request.new_name.empty();
  const std::string accept = !request.accept.empty() ? request.accept
                             : is_new                ? host::Translate("Save")
                                                     : host::Translate("Open");
  dialog_ = Gtk::FileChooserNative::create(request.title, parent,
                                           is_new              ? Gtk::FileChooser::Action::SAVE
                                           : request.is_folder ? Gtk::FileChooser::Action::SELECT_FOLDER
                                                               : Gtk::FileChooser::Action::OPEN,
                                           accept, host::Translate("Cancel"));
  for (const FileRequest::Kind& kind : request.kinds) {
    const auto filter = Gtk::FileFilter::create();
    filter->set_name(kind.name);
    filter->add_pattern(kind.pattern);
    dialog_->add_filter(filter);
  }
  if (is_new) dialog_->set_current_name(request.new_name);
  dialog_->signal_response().connect([this, act = std::move(act)](int response) {
    if (response != Gtk::ResponseType::ACCEPT) return;
    const auto file = dialog_->get_file();
    const std::string path = file ? file->get_path() : "";
    // to ask again gives up this dialog, and this function with it
    const auto then = act;
    if (!path.empty()) then(path);
  });
  dialog_->show();
}

void FileDialog::Ask(Gtk::Widget& asker, const FileRequest& request,
                     std::function<void(std::filesystem::path)> act) {
  if (auto* window = dynamic_cast<Gtk::Window*>(asker.get_root())) Ask(*window, request, std::move(act));
}

}  // namespace trocar::gui
