// SPDX-License-Identifier: Apache-2.0
// Remarks of instructors, and the forms GOALS and OSATS.
#pragma once

#include <gtkmm.h>

#include "trocar/centre/centre_presenter.h"

namespace trocar::centre {

class ReviewView : public Gtk::Box {
 public:
  ReviewView(const ReviewPage& review, CentrePresenter& presenter);

 private:
  void AddRemarks(const ReviewPage& review);
  void AddForm(std::size_t index, Gtk::Box& into);

  CentrePresenter& presenter_;
  Gtk::Entry remark_;
  Gtk::SpinButton seconds_;
  std::vector<ReviewPage::Form> forms_;
};

}  // namespace trocar::centre
