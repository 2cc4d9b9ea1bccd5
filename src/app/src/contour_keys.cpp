// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/contour_keys.h"

namespace trocar::app {
namespace {

// X11 key symbols (X11/keysymdef.h); letters are their ASCII code
enum KeySymbol : std::uint32_t {
  kBackSpace = 0xff08,
  kReturn = 0xff0d,
  kEscape = 0xff1b,
  kHome = 0xff50,
  kLeft = 0xff51,
  kUp = 0xff52,
  kRight = 0xff53,
  kDown = 0xff54,
  kPageUp = 0xff55,
  kPageDown = 0xff56,
  kEnd = 0xff57,
  kPadEnter = 0xff8d,
  kPadPlus = 0xffab,
  kPadMinus = 0xffad,
  kF1 = 0xffbe,
  kF11 = 0xffc8,
  kDeleteKey = 0xffff,
};

struct Binding {
  std::uint32_t key;
  bool control, shift;
  ContourAction action;
};

constexpr Binding kBindings[] = {
    {kUp, false, false, ContourAction::kNextSlice},
    {kDown, false, false, ContourAction::kPreviousSlice},
    {kPageUp, false, false, ContourAction::kStepForward},
    {kPageDown, false, false, ContourAction::kStepBack},
    {kRight, false, false, ContourAction::kNextContoured},
    {kLeft, false, false, ContourAction::kPreviousContoured},
    {kHome, false, false, ContourAction::kFirstContoured},
    {kEnd, false, false, ContourAction::kLastContoured},
    {kReturn, false, false, ContourAction::kCloseContour},
    {kPadEnter, false, false, ContourAction::kCloseContour},
    {kEscape, false, false, ContourAction::kCancel},
    {kDeleteKey, false, false, ContourAction::kDelete},
    {kBackSpace, false, false, ContourAction::kDelete},
    {kDeleteKey, false, true, ContourAction::kDeleteContour},
    {kDeleteKey, true, false, ContourAction::kClearSlice},
    {'h', false, false, ContourAction::kToggleHole},
    {'n', false, false, ContourAction::kNextOrgan},
    {'p', false, false, ContourAction::kPropagateForward},
    {'p', false, true, ContourAction::kPropagateBack},
    {'s', false, false, ContourAction::kToggleScissors},
    {'z', true, false, ContourAction::kUndo},
    {'z', true, true, ContourAction::kRedo},
    {'y', true, false, ContourAction::kRedo},
    {'f', false, false, ContourAction::kFitView},
    {'f', false, true, ContourAction::kFitOrgan},
    {'+', false, false, ContourAction::kZoomIn},
    {'+', false, true, ContourAction::kZoomIn},
    {'=', false, false, ContourAction::kZoomIn},
    {kPadPlus, false, false, ContourAction::kZoomIn},
    {'-', false, false, ContourAction::kZoomOut},
    {kPadMinus, false, false, ContourAction::kZoomOut},
    {'m', false, false, ContourAction::kMirror},
    {'r', false, false, ContourAction::kToggleReference},
    {'g', false, false, ContourAction::kToggleGhosts},
    {'t', false, false, ContourAction::kToggleStages},
    {'a', false, false, ContourAction::kToggleFill},
    {'o', true, false, ContourAction::kOpen},
    {'s', true, false, ContourAction::kSave},
    {'s', true, true, ContourAction::kSaveAs},
    {'b', true, false, ContourAction::kBuild},
    {kF1, false, false, ContourAction::kToggleHelp},
    {kF11, false, false, ContourAction::kToggleFullscreen},
    {'q', true, false, ContourAction::kQuit},
};

constexpr KeyHelp kHelp[] = {
    {"Contour", "Click", "set a point; on a point: drag it; on the curve: insert one"},
    {"Contour", "Enter   double click", "close the contour (or click its first point)"},
    {"Contour", "Right click   Delete", "delete the point; while drawing, the last one"},
    {"Contour", "Shift+Delete   Ctrl+Delete", "delete the contour; clear the slice"},
    {"Contour", "S", "scissors: the line follows the edge between clicks"},
    {"Contour", "H   N", "contour is a hole; next organ"},
    {"Contour", "P   Shift+P", "carry the contours to the next slice, to the one before"},
    {"Contour", "Esc", "give up the drag, the choice, the open contour"},
    {"Contour", "Ctrl+Z   Ctrl+Shift+Z", "undo, redo"},
    {"Slices", "Wheel   Up Down", "next slice, slice before"},
    {"Slices", "Page Up   Page Down", "as many slices as the step"},
    {"Slices", "Left Right   Home End", "next slice with contours, slice before; first, last"},
    {"View", "Ctrl+Wheel   + -", "zoom at the pointer"},
    {"View", "Middle drag   Space+drag", "move the picture"},
    {"View", "Right drag", "grey pictures: window (sideways) and level (up, down)"},
    {"View", "F   Shift+F", "whole picture; the organ"},
    {"View", "T   A   G   R", "points, fill, neighbours' contours, reference"},
    {"View", "M", "as radiology shows it, or as the file lies"},
    {"File", "Ctrl+S   Ctrl+Shift+S   Ctrl+O", "save, save as, open"},
    {"File", "Ctrl+B", "build the patient"},
    {"File", "F1   F11   Ctrl+Q", "this help, full screen, quit"},
};

}  // namespace

ContourAction FindContourAction(std::uint32_t keyval, bool control, bool shift) noexcept {
  if (keyval >= 'A' && keyval <= 'Z') keyval += 'a' - 'A';
  for (const Binding& binding : kBindings) {
    if (binding.key == keyval && binding.control == control && binding.shift == shift) return binding.action;
  }
  return ContourAction::kNone;
}

bool WorksEverywhere(ContourAction action) noexcept {
  switch (action) {
    case ContourAction::kOpen:
    case ContourAction::kSave:
    case ContourAction::kSaveAs:
    case ContourAction::kBuild:
    case ContourAction::kToggleHelp:
    case ContourAction::kToggleFullscreen:
    case ContourAction::kQuit:
      return true;
    default:
      return false;
  }
}

std::span<const KeyHelp> ContourKeyHelpRows() noexcept {
  return kHelp;
}

}  // namespace trocar::app
