// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/command.h"

#include "trocar/host/translate.h"

namespace trocar::gui {
namespace {

struct NamedKey {
  std::uint32_t key;
  const char* name;
};
constexpr NamedKey kNamedKeys[] = {{' ', host::Mark("Space")},
                                   {',', host::Mark("Comma")},
                                   {key::kBackSpace, host::Mark("Backspace")},
                                   {key::kTab, host::Mark("Tab")},
                                   {key::kReturn, host::Mark("Enter")},
                                   {key::kEscape, host::Mark("Esc")},
                                   {key::kHome, host::Mark("Home")},
                                   {key::kLeft, host::Mark("Left")},
                                   {key::kUp, host::Mark("Up")},
                                   {key::kRight, host::Mark("Right")},
                                   {key::kDown, host::Mark("Down")},
                                   {key::kPageUp, host::Mark("Page Up")},
                                   {key::kEnd, host::Mark("End")},
                                   {key::kInsert, host::Mark("Insert")},
                                   {key::kPageDown, host::Mark("Page Down")},
                                   {key::kDelete, host::Mark("Delete")}};
constexpr std::uint32_t kF12 = 0xffc9;

constexpr const char* kBetweenKeys = "   ";

std::string NameOf(std::uint32_t symbol) {
  for (const NamedKey& each : kNamedKeys) {
    if (each.key == symbol) return each.name;
  }
  if (symbol >= key::kF1 && symbol <= kF12) return "F" + std::to_string(symbol - key::kF1 + 1);
  if (symbol >= 'a' && symbol <= 'z') symbol -= 'a' - 'A';
  return std::string(1, static_cast<char>(symbol));
}

void Join(std::string& text, const std::string& more, const char* between) {
  if (more.empty()) return;
  if (!text.empty()) text += between;
  text += more;
}

}  // namespace

std::string KeyText(const KeyStroke& stroke) {
  return std::string(stroke.control ? "Ctrl+" : "") + (stroke.shift ? host::Translate("Shift+") : "") +
         host::Translate(NameOf(stroke.key));
}

void AppendHelp(std::span<const KeyStroke> keys, const CommandHelp& help, std::vector<KeyHelp>& rows) {
  if (*help.group != '\0') rows.push_back({help.group, "", ""});
  if (rows.empty()) return;
  KeyHelp& row = rows.back();
  Join(row.keys, host::Translate(help.gesture), kBetweenKeys);
  for (const KeyStroke& stroke : keys) {
    if (stroke.key != 0) Join(row.keys, KeyText(stroke), kBetweenKeys);
  }
  Join(row.meaning, host::Translate(help.meaning), ", ");
}

std::vector<KeyHelp> SortByGroup(std::vector<KeyHelp> rows, std::span<const char* const> groups) {
  std::vector<KeyHelp> sorted;
  for (const char* group : groups) {
    for (const KeyHelp& row : rows) {
      if (row.group == group) sorted.push_back(row);
    }
  }
  return sorted;
}

std::string TipText(const char* tip, std::span<const KeyStroke> keys) {
  std::string names;
  for (const KeyStroke& stroke : keys) {
    if (stroke.key != 0) Join(names, KeyText(stroke), host::Translate(" or ").c_str());
  }
  const std::string text = host::Translate(tip);
  return names.empty() ? text : text + " (" + names + ")";
}

}  // namespace trocar::gui
