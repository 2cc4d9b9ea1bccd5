// SPDX-License-Identifier: Apache-2.0
// Prints, as a template for gettext, the texts that stand in tables of the program: errors, commands with their help, buttons and
// keys, settings, the home page. xgettext finds those that stand in calls.
#include <cstdio>
#include <set>
#include <string>
#include <string_view>

#include "trocar/centre/centre_commands.h"
#include "trocar/core/error_codes.h"
#include "trocar/editor/contour_commands.h"
#include "trocar/editor/patient_commands.h"
#include "trocar/presenter/home.h"
#include "trocar/presenter/replay_commands.h"
#include "trocar/presenter/settings_form.h"
#include "trocar/presenter/simulator_commands.h"

namespace {

std::set<std::string> printed;

void Print(std::string_view text) {
  if (text.empty() || !printed.insert(std::string(text)).second) return;
  std::string quoted;
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  std::printf("\nmsgid \"%s\"\nmsgstr \"\"\n", quoted.c_str());
}

template <typename Commands>
void PrintCommands(const Commands& commands) {
  for (const auto& command : commands) {
    for (const char* text : {command.help.group, command.help.gesture, command.help.meaning,
                             command.button.label, command.button.tip})
      Print(text);
    for (trocar::gui::KeyStroke stroke : command.keys) {
      stroke.control = stroke.shift = false;
      // letters and signs are themselves in every language
      if (stroke.key != 0 && KeyText(stroke).size() > 3) Print(KeyText(stroke));
    }
  }
}

}  // namespace

int main() {
  using namespace trocar;
  std::puts("msgid \"\"\nmsgstr \"\"\n\"Content-Type: text/plain; charset=UTF-8\\n\"");
  for (const core::ErrorEntry& entry : core::ErrorTable()) Print(entry.meaning);
  PrintCommands(presenter::SimulatorCommands());
  PrintCommands(presenter::ReplayCommands());
  PrintCommands(centre::CentreCommands());
  PrintCommands(editor::ContourCommands());
  PrintCommands(editor::PatientCommands());
  // what a button says in its other state
  Print("Pause");
  for (const presenter::SettingRow& row : presenter::SettingRows()) {
    for (const char* text : {row.group, row.label, row.tooltip}) Print(text);
  }
  for (const presenter::SolverChoice& choice : presenter::SolverChoices()) Print(choice.label);
  for (const presenter::HomeEntry& entry : presenter::HomeEntries()) {
    Print(entry.title);
    Print(entry.about);
  }
  // what a video's job is doing
  for (const char* what : {"Reading", "Seeking", "Drawing"}) Print(what);
}
