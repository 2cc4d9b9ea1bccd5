// SPDX-License-Identifier: Apache-2.0
/// \file failure_card.h  Card over the picture with the error that ended the simulation, and its remedy.
#pragma once

#include <gtkmm.h>

#include "trocar/base/result.h"

namespace trocar::app {

class FailureCard : public Gtk::Box {
 public:
  FailureCard();
  /// Shows the error; once.
  void Show(const base::Error& error);
};

}  // namespace trocar::app
