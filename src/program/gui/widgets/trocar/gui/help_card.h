// SPDX-License-Identifier: Apache-2.0
/// \file help_card.h  All keys, over the picture.
#pragma once

#include <gtkmm.h>

#include <vector>

#include "trocar/gui/command.h"

namespace trocar::gui {

class HelpCard : public Gtk::Box {
 public:
  explicit HelpCard(const std::vector<KeyHelp>& rows);
};

}  // namespace trocar::gui
