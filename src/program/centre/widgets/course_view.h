// SPDX-License-Identifier: Apache-2.0
// The map of a course.
#pragma once

#include <gtkmm.h>

#include <string>

#include "trocar/centre/centre_presenter.h"

namespace trocar::centre {

class CourseView : public Gtk::Box {
 public:
  CourseView();

  void Use(CentrePresenter& presenter) { presenter_ = &presenter; }
  void Show(const CentrePage& page);

 private:
  void ShowMap(const CoursePage& page, Gtk::Box& into);
  void ShowStep(const CoursePage& page);

  CentrePresenter* presenter_ = nullptr;
  Gtk::Box* detail_ = nullptr;  // of the step that is chosen
  std::string chosen_;
};

}  // namespace trocar::centre
