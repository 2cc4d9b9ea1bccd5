// SPDX-License-Identifier: Apache-2.0
// The contour window's files: open, save, build the patient, and the question before work is lost.
#include <utility>

#include "contour_window.h"

namespace trocar::app {

void ContourWindow::ChooseAndOpen() {
  chooser_ = Gtk::FileChooserNative::create("Open contours", *this, Gtk::FileChooser::Action::OPEN, "Open",
                                            "Cancel");
  const auto filter = Gtk::FileFilter::create();
  filter->set_name("Contours (JSON)");
  filter->add_pattern("*.json");
  chooser_->add_filter(filter);
  chooser_->signal_response().connect([this](int response) {
    if (response != static_cast<int>(Gtk::ResponseType::ACCEPT)) return;
    auto options = workspace_ != nullptr ? workspace_->Options() : loading_options_;
    options.points = chooser_->get_file()->get_path();
    const auto open = [this, options] { StartLoading(options); };
    if (workspace_ == nullptr || !workspace_->Document().IsDirty()) return open();
    bars_.Ask("The contours that are open are not saved.",
              {{"Save, then open", [this, open] { Save() ? open() : ChooseAndSave(open); }, true},
               {"Open without saving",
                [this, open] {
                  if (autosave_ != nullptr) autosave_->Discard();
                  open();
                }},
               {"Stay", [] {}}});
  });
  chooser_->show();
}

bool ContourWindow::Save() {
  const auto file = workspace_->Options().points;
  if (file.empty()) {
    ChooseAndSave([] {});
    return false;
  }
  if (const auto status = workspace_->Save(file); !status.ok()) {
    Report(status.error());
    return false;
  }
  if (autosave_ != nullptr) autosave_->Discard();
  Tell("Saved " + file.filename().string());
  ShowAll();
  return true;
}

void ContourWindow::ChooseAndSave(std::function<void()> then) {
  chooser_ = Gtk::FileChooserNative::create("Save contours", *this, Gtk::FileChooser::Action::SAVE, "Save",
                                            "Cancel");
  chooser_->set_current_name("control_points.json");
  chooser_->signal_response().connect([this, then = std::move(then)](int response) {
    if (response != static_cast<int>(Gtk::ResponseType::ACCEPT)) return;
    const std::filesystem::path file = chooser_->get_file()->get_path();
    if (const auto status = workspace_->Save(file); !status.ok()) return Report(status.error());
    // the side file goes with the name
    if (autosave_ != nullptr) autosave_->Discard();
    autosave_.reset();
    if (TakeLock()) StartAutosave();
    Tell("Saved " + file.filename().string());
    ShowAll();
    then();
  });
  chooser_->show();
}

void ContourWindow::ChooseAndBuild() {
  if (builder_.joinable()) return Tell("A patient is being built already", true);
  if (workspace_->Document().IsDirty() || workspace_->Options().points.empty()) {
    // the build reads the file, so that it can be repeated from the command line
    if (workspace_->Options().points.empty()) return ChooseAndSave([this] { ChooseAndBuild(); });
    if (!Save()) return;
  }
  chooser_ = Gtk::FileChooserNative::create("Folder for the patient", *this, Gtk::FileChooser::Action::SAVE,
                                            "Build", "Cancel");
  chooser_->set_current_name("patient");
  chooser_->signal_response().connect([this](int response) {
    if (response != static_cast<int>(Gtk::ResponseType::ACCEPT)) return;
    StartBuild(chooser_->get_file()->get_path());
  });
  chooser_->show();
}

void ContourWindow::StartBuild(const std::filesystem::path& folder) {
  build_folder_ = folder;
  anatomy::BuildOptions options;
  options.control_points = workspace_->Options().points;
  options.images = workspace_->Options().images;
  options.dicom_series = workspace_->Options().series.series;
  options.output = folder;
  if (!workspace_->Options().reference.empty()) options.reference = workspace_->Options().reference;
  build_stop_ = {};
  options.stop = build_stop_.get_token();
  busy_.set_visible(true);
  stop_build_.set_visible(true);
  stop_build_.set_sensitive(true);
  builder_ = std::thread([this, options] {
    building_.emplace(anatomy::BuildPatient(options, [this](std::string_view what, double fraction) {
      {
        const std::lock_guard lock(progress_mutex_);
        progress_what_ = what;
        progress_fraction_ = fraction;
      }
      progressed_.emit();
    }));
    built_.emit();
  });
  ShowAll();
}

void ContourWindow::StopBuild() {
  build_stop_.request_stop();
  stop_build_.set_sensitive(false);
}

void ContourWindow::FinishBuild() {
  builder_.join();
  busy_.set_visible(false);
  stop_build_.set_visible(false);
  const auto report = std::move(*building_);
  building_.reset();
  if (!report.ok() && report.error().code == core::ErrorCode::kCancelled) {
    Tell("The patient was given up; nothing was written");
  } else if (!report.ok()) {
    Report(report.error());
  } else {
    std::string text = "Wrote the patient " + build_folder_.string() + ":";
    for (const auto& organ : report->organs) {
      text += " " + organ.name + " " + std::to_string(organ.triangles) + " triangles, " +
              std::to_string(static_cast<int>(organ.volume_ml + 0.5)) + " mL;";
    }
    text.back() = '.';
    bars_.ShowNotice(text + " Check it with: trocar anatomy check");
  }
  ShowAll();
}

bool ContourWindow::OnClose() {
  const bool is_watched = options_.screenshot.empty() && !options_.is_measuring;
  if (is_closing_ || !is_watched || workspace_ == nullptr || !workspace_->Document().IsDirty()) {
    if (builder_.joinable() && !is_closing_) {
      bars_.Ask("The patient is still being built.", {{"Wait", [] {}, true},
                                                      {"Give it up and close",
                                                       [this] {
                                                         build_stop_.request_stop();
                                                         is_closing_ = true;
                                                         close();
                                                       }},
                                                      {"Close when it is done", [this] {
                                                         is_closing_ = true;
                                                         close();
                                                       }}});
      return true;
    }
    if (autosave_ != nullptr) autosave_->Discard();
    return false;
  }
  const auto leave = [this] {
    is_closing_ = true;
    close();
  };
  bars_.Ask("The contours are not saved.",
            {{"Save and close",
              [this, leave] {
                workspace_->Options().points.empty() ? ChooseAndSave(leave) : Save() ? leave() : void();
              },
              true},
             {"Close without saving", leave},
             {"Stay", [] {}}});
  return true;
}

}  // namespace trocar::app
