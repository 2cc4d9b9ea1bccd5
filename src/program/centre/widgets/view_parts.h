// SPDX-License-Identifier: Apache-2.0
// Building blocks of the pages: texts, tables, plots side by side.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <string>
#include <vector>

#include "trocar/centre/result_page.h"
#include "trocar/report/drawing.h"

namespace trocar::centre {

/// A text that takes as many lines as it needs; its parent owns it.
Gtk::Label& MakeText(const std::string& text, const char* style);
/// A text in one line.
Gtk::Label& MakeLine(const std::string& text, const char* style);
Gtk::Button& MakeButton(const std::string& label, std::function<void()> act, const char* style = nullptr);
/// A box with a title, as the panels have them.
Gtk::Box& MakeCard(const std::string& title);
/// The page scrolls as a whole.
Gtk::ScrolledWindow& MakePage(Gtk::Widget& content);
void Clear(Gtk::Box& box);
/// "good", "caution", "bad" or "plain": a class of the style sheet.
const char* StyleOf(Tone tone);
/// A plot as wide as it may be, its height in proportion.
Gtk::Widget& MakePlot(const report::Drawing& drawing, int width);

/// Cells in columns; the head stands in the first row.
class Table : public Gtk::Grid {
 public:
  explicit Table(const std::vector<std::string>& head);
  /// Puts a widget into the next cell of the row.
  void Add(Gtk::Widget& widget);
  void AddText(const std::string& text, const char* style = "value", bool is_wide = false);
  void EndRow();

 private:
  int row_ = 0, column_ = 0;
};

}  // namespace trocar::centre
