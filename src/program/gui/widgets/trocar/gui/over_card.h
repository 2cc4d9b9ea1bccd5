// SPDX-License-Identifier: Apache-2.0
/// \file over_card.h  A card that lies over a picture: where it has no room it scrolls.
#pragma once

#include <gtkmm.h>

namespace trocar::gui {

/// Lays a card over a picture, in the middle; it is seen while it is visible.
/// \param card  outlives the overlay's content
/// \return what scrolls, which takes the keyboard's arrows and pages where the card has nothing to choose
Gtk::ScrolledWindow& AddOverCard(Gtk::Overlay& overlay, Gtk::Widget& card);

/// A window's size at first: no larger than the screen.
void FitToScreen(Gtk::Window& window, int width, int height);

}  // namespace trocar::gui
