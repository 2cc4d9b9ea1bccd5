// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/hints.h"

#include <string_view>

#include "trocar/host/translate.h"

namespace trocar::presenter {
namespace {

std::string Fill(const Situation& situation, std::string_view text) {
  static const KeyBindings first;
  return (situation.bindings != nullptr ? *situation.bindings : first).Fill(text);
}

std::string ModeTemplate(const Situation& situation) {
  if (!situation.is_loaded) return host::Translate("Choose above what to train  ·  {help} all keys");
  if (situation.is_paused)
    return host::Translate("Paused: mouse and keys move nothing  ·  {run} goes on  ·  {help} all keys");
  if (situation.is_demonstration)
    return host::Translate(
        "The script holds both hands  ·  {demonstration} takes over  ·  {run} pauses  ·  {help} all keys");
  if (situation.is_laparoscope_held && situation.is_camera_task)
    return host::Translate(
        "Laparoscope: mouse looks round  ·  wheel in and out  ·  {left-hand}, {right-hand}: a hand  ·  Esc "
        "frees the "
        "mouse  ·  {help} all keys");
  if (situation.is_laparoscope_held)
    return host::Translate(
        "Laparoscope: mouse looks round  ·  wheel in and out  ·  let {hold-laparoscope} or the {button:look} "
        "button go: hands again");
  const std::string hand =
      situation.is_right_hand ? host::Translate("Right hand") : host::Translate("Left hand");
  if (!situation.device.empty())
    return host::TranslateWith("{1} holds the hands  ·  {run} pauses  ·  {help} all keys",
                               {situation.device});
  if (!situation.is_pointer_taken)
    return host::TranslateWith(
        "{1}: click into the picture to take it with the mouse, or use the arrow keys  ·  {help} all keys",
        {hand});
  std::string text = host::TranslateWith(
      "{1}: mouse moves  ·  wheel in, out  ·  {button:close} button closes, {button:open} opens", {hand});
  text += situation.is_right_hand ? host::Translate("  ·  {left-hand} left hand")
                                  : host::Translate("  ·  {right-hand} right hand");
  if (situation.has_tools) text += host::Translate("  ·  {next-tool} tool");
  return host::TranslateWith(
      "{1}  ·  hold {hold-laparoscope}: look  ·  Esc frees the mouse  ·  {help} all keys", {text});
}

}  // namespace

std::string HintText(const Situation& situation) {
  if (!situation.is_loaded) return situation.is_loading ? host::Translate("Loading …") : "";
  if (situation.is_paused) return Fill(situation, host::Translate("Paused. {run} goes on."));
  if (situation.is_demonstration_over)
    return Fill(
        situation,
        host::Translate("The demonstration is over. {demonstration} takes over, {reset} plays it again."));
  if (situation.is_demonstration)
    return Fill(
        situation,
        host::Translate("Demonstration: the script holds both instruments. {demonstration} takes over."));
  if (situation.is_camera_task && !situation.is_pointer_taken)
    return Fill(situation,
                host::Translate("Click into the picture to take the laparoscope. {help} shows all keys."));
  if (situation.is_laparoscope_held) return "";
  if (!situation.is_pointer_taken)
    return Fill(situation,
                host::Translate("Click into the picture to take the instruments. {help} shows all keys."));
  return "";
}

std::string BadgeText(const Situation& situation) {
  if (!situation.is_loaded) return "";
  if (situation.is_laparoscope_held) return host::Translate("Laparoscope");
  if (situation.is_demonstration) return host::Translate("Demonstration");
  const auto hand = [](const std::string& name, const std::string& jaws, bool is_chosen) {
    return std::string(is_chosen ? "▶ " : "") + name + (jaws.empty() ? "" : " " + jaws);
  };
  std::string text;
  if (situation.left_jaws.empty() && situation.right_jaws.empty()) {
    text = situation.is_right_hand ? host::Translate("Right hand") : host::Translate("Left hand");
  } else {
    text = hand(host::Translate("Left hand"), situation.left_jaws, !situation.is_right_hand) + "  ·  " +
           hand(host::Translate("Right hand"), situation.right_jaws, situation.is_right_hand);
  }
  if (situation.is_slow) text += host::Translate("  ·  slow motion");
  if (situation.is_fulcrum_mirrored) text += host::Translate("  ·  real trocar");
  if (situation.has_camera_holder) text += host::Translate("  ·  automatic camera");
  return text;
}

std::string ModeText(const Situation& situation) {
  return Fill(situation, ModeTemplate(situation));
}

std::string StateText(const Situation& situation) {
  if (!situation.is_loaded) return situation.is_loading ? host::Translate("Loading") : "";
  if (situation.is_paused) return host::Translate("Paused");
  return situation.is_demonstration ? host::Translate("Demonstration") : host::Translate("Running");
}

}  // namespace trocar::presenter
