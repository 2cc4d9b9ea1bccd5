// SPDX-License-Identifier: Apache-2.0
/// \file help_card.h  All keys, over the picture.
#pragma once

#include <gtkmm.h>

#include <span>

#include "trocar/app/simulator_commands.h"

namespace trocar::app {

class HelpCard : public Gtk::Box {
 public:
  explicit HelpCard(std::span<const KeyHelp> rows);
};

}  // namespace trocar::app
