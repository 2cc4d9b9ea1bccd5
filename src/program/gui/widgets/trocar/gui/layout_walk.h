// SPDX-License-Identifier: Apache-2.0
/// \file layout_walk.h  Looks at every widget of a window, whether one is cut off or lies off the screen.
#pragma once

#include <gtkmm.h>

#include <string>
#include <vector>

namespace trocar::gui {

struct Misfit {
  std::string what;    ///< "text cut off", "off the window", "window wider than the screen"
  std::string widget;  ///< kind and style classes, from the window on
  std::string text;    ///< of a label; may be empty
  int excess = 0;      ///< how far [pixels]
};

/// Widgets that are seen: texts that end in an ellipsis or are larger than their place, widgets that reach beyond the window or
/// beyond what they can be scrolled in, and a window that is larger than the screen.
/// \param window         shown, and laid out
/// \param width, height  of the screen [pixels]
std::vector<Misfit> FindMisfits(Gtk::Window& window, int width, int height);

/// How many widgets FindMisfits looks at: a walk that sees nothing finds nothing.
std::size_t CountSeen(Gtk::Window& window);

/// Texts of all labels that are seen, for a check of their language.
std::vector<std::string> ListTexts(Gtk::Window& window);

}  // namespace trocar::gui
