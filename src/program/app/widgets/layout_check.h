// SPDX-License-Identifier: Apache-2.0
/// \file layout_check.h  Opens one page of the windows after the other and looks whether all of it is seen.
#pragma once

#include <gtkmm.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/gui/layout_walk.h"

namespace trocar::app {

class LayoutCheck {
 public:
  struct Page {
    std::string name;
    std::function<void()> open;
    std::function<Gtk::Window*()> window;  ///< that shows it
    /// Whether it shows what it is about; empty: at once.
    std::function<bool()> is_there;
  };

  /// \param width, height  of the screen that all has to fit on [pixels]
  LayoutCheck(std::vector<Page> pages, int width, int height, std::filesystem::path report);
  /// \param on_done  called once, when the report is written
  void Start(std::function<void(const base::Status&)> on_done);

 private:
  struct Finding {
    std::string page;
    int width = 0, height = 0;  // of the window
    std::size_t seen = 0;
    bool is_there = true;
    std::vector<gui::Misfit> misfits;
    std::vector<std::string> texts;
  };
  bool Look();
  void Next();
  base::Status Write() const;

  std::vector<Page> pages_;
  int width_, height_;
  std::filesystem::path report_;
  std::size_t at_ = 0;
  int looks_ = 0;
  std::vector<Finding> findings_;
  std::function<void(const base::Status&)> on_done_;
};

}  // namespace trocar::app
