// SPDX-License-Identifier: Apache-2.0
/// \file help_card.h  All keys, over the picture.
#pragma once

#include <gtkmm.h>

namespace trocar::app {

class HelpCard : public Gtk::Box {
 public:
  HelpCard();
};

}  // namespace trocar::app
