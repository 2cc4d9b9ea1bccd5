// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/contour_script.h"

#include <charconv>
#include <cstdio>
#include <optional>

namespace trocar::app {
namespace {

using core::Error;
using core::ErrorCode;

struct Verb {
  const char* name;
  int least, most;  // words
  const char* words;
  const char* meaning;
};

constexpr Verb kVerbs[] = {
    {"sizes", 5, 5, "PX SL COL ROW NUM", "window: first, where the pictures do not say them; mm, directions"},
    {"organ", 1, 1, "NAME", "choose an organ"},
    {"add-organ", 1, 2, "NAME [TRIANGLES]", "add an organ and choose it"},
    {"rename-organ", 1, 1, "NAME", "rename the chosen organ"},
    {"delete-organ", 0, 0, "", "delete the chosen organ"},
    {"slice", 1, 1, "N", "go to a slice"},
    {"click", 2, 2, "X Y", "set a point of the open contour"},
    {"edge", 2, 2, "X Y", "follow the edge to a place (scissors)"},
    {"close", 0, 0, "", "close the open contour"},
    {"close-hole", 0, 0, "", "close the open contour as a hole"},
    {"drop", 0, 0, "", "drop the open contour"},
    {"move", 4, 4, "C I X Y", "move point I of contour C (h0, h1, ... are holes)"},
    {"insert", 4, 4, "C I X Y", "insert a point before point I of contour C"},
    {"delete-point", 2, 2, "C I", "delete point I of contour C"},
    {"delete", 1, 1, "C", "delete a contour"},
    {"hole", 1, 1, "C", "make a contour a hole, or a hole a contour"},
    {"choose", 1, 2, "C [I]", "choose a contour and a point of it"},
    {"clear", 0, 0, "", "clear the slice"},
    {"propagate", 1, 1, "N", "carry the slice's contours to slice N and go there"},
    {"undo", 0, 0, "", "undo"},
    {"redo", 0, 0, "", "redo"},
    {"reach", 1, 1, "PX", "how far points may move to an edge"},
    {"save", 1, 1, "FILE", "save the contours"},
    {"scissors", 1, 1, "on|off", "window: scissors mode"},
    {"pointer", 2, 2, "X Y", "window: the pointer lies there"},
    {"view", 3, 3, "X Y ZOOM", "window: what lies in the middle, pixels of the screen a pixel"},
    {"fit", 1, 1, "picture|organ", "window: show the whole"},
    {"show", 2, 2, "PART on|off", "window: reference, ghosts, points, fill or help"},
    {"answer", 1, 8, "LABEL", "window: press the button LABEL of a question that is shown"},
    {"build", 1, 1, "FOLDER", "window: build the patient of the saved contours"},
    {"stop-build", 0, 0, "", "window: give the patient up that is being built"},
    {"await", 1, 1, "mesh|build", "window: wait until the surfaces, or the patient, are made"},
};

const Verb* FindVerb(std::string_view name) {
  for (const Verb& verb : kVerbs) {
    if (verb.name == name) return &verb;
  }
  return nullptr;
}

Error AtLine(int line, ErrorCode code, const std::string& what) {
  return {code, "line " + std::to_string(line) + " of the script: " + what};
}

std::optional<double> ReadNumber(const std::string& word) {
  double value = 0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (failure != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Words of one step as what they mean; the first that does not is remembered.
class Words {
 public:
  explicit Words(const ScriptStep& step) : step_(step) {}

  double Number(std::size_t i) {
    const auto value = ReadNumber(step_.words[i]);
    if (!value) Complain(i, "a number");
    return value.value_or(0);
  }
  int Whole(std::size_t i) {
    const double value = Number(i);
    const bool is_whole = value >= -1e9 && value <= 1e9 && value == static_cast<int>(value);
    if (!is_whole) Complain(i, "a whole number");
    return is_whole ? static_cast<int>(value) : 0;
  }
  std::size_t Index(std::size_t i) {
    const int value = Whole(i);
    if (value < 0) Complain(i, "an index from 0");
    return static_cast<std::size_t>(std::max(value, 0));
  }
  Vec2 Place(std::size_t i) { return {Number(i), Number(i + 1)}; }
  contours::ContourId Contour(std::size_t i, const ContourEditor& editor) {
    contours::ContourId id{editor.Structure(), editor.Slice(), false, 0};
    std::string word = step_.words[i];
    if (word.starts_with('h')) id.is_hole = true, word.erase(0, 1);
    const auto index = ReadNumber(word);
    if (!index || *index < 0 || *index > 1e6 || *index != static_cast<int>(*index)) {
      Complain(i, "a contour such as 0, or a hole such as h0");
      return id;
    }
    id.index = static_cast<int>(*index);
    return id;
  }
  const std::optional<Error>& Complaint() const { return complaint_; }

 private:
  void Complain(std::size_t i, const char* wanted) {
    if (!complaint_)
      complaint_ =
          AtLine(step_.line, ErrorCode::kScriptInvalid, "\"" + step_.words[i] + "\" is not " + wanted);
  }
  const ScriptStep& step_;
  std::optional<Error> complaint_;
};

}  // namespace

core::Result<std::vector<ScriptStep>> ParseContourScript(std::string_view text, std::string_view source) {
  std::vector<ScriptStep> steps;
  int line = 0;
  while (!text.empty()) {
    ++line;
    const auto end = text.find('\n');
    std::string_view row = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    row = row.substr(0, row.find('#'));
    std::vector<std::string> words;
    while (true) {
      const auto begin = row.find_first_not_of(" \t\r");
      if (begin == std::string_view::npos) break;
      row.remove_prefix(begin);
      const auto stop = std::min(row.find_first_of(" \t\r"), row.size());
      words.emplace_back(row.substr(0, stop));
      row.remove_prefix(stop);
    }
    if (words.empty()) continue;
    ScriptStep step{line, words.front(), {words.begin() + 1, words.end()}};
    const Verb* verb = FindVerb(step.verb);
    const std::string where = std::string(source) + ", line " + std::to_string(line) + ": ";
    if (verb == nullptr) {
      return Error{ErrorCode::kScriptInvalid,
                   where + "there is no command \"" + step.verb + "\"; trocar-window --help lists them"};
    }
    const int count = static_cast<int>(step.words.size());
    if (count < verb->least || count > verb->most) {
      return Error{ErrorCode::kScriptInvalid, where + "write it as: " + verb->name + " " + verb->words};
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

core::Result<bool> RunScriptStep(const ScriptStep& step, ContourEditor& editor) {
  auto& workspace = editor.Workspace();
  auto& document = workspace.Document();
  const int structure = editor.Structure(), slice = editor.Slice();
  Words words(step);
  // reads first; what is no number changes nothing
  const auto run = [&](auto&& command) -> core::Result<bool> {
    if (words.Complaint()) return *words.Complaint();
    const core::Status status = command();
    if (!status.ok()) return AtLine(step.line, status.error().code, status.error().message);
    return true;
  };
  const auto done = [] { return core::Status(); };
  const std::string& verb = step.verb;
  if (verb == "organ") {
    return run([&]() -> core::Status {
      const auto& structures = document.Points().structures;
      for (std::size_t i = 0; i < structures.size(); ++i) {
        if (structures[i].name != step.words[0]) continue;
        editor.ChooseStructure(static_cast<int>(i));
        return {};
      }
      return Error{ErrorCode::kUnknownName, "there is no organ named " + step.words[0]};
    });
  }
  if (verb == "add-organ") {
    const int budget = step.words.size() > 1 ? words.Whole(1) : 1000;
    return run([&] {
      auto status = document.AddStructure(step.words[0], budget);
      if (status.ok()) editor.ChooseStructure(static_cast<int>(document.Points().structures.size()) - 1);
      return status;
    });
  }
  if (verb == "rename-organ") return run([&] { return document.RenameStructure(structure, step.words[0]); });
  if (verb == "delete-organ") {
    return run([&] {
      auto status = document.DeleteStructure(structure);
      editor.ChooseStructure(0);
      return status;
    });
  }
  if (verb == "slice") {
    const int to = words.Whole(0);
    return run([&]() -> core::Status {
      editor.SetSlice(to);
      if (editor.Slice() == to) return {};
      return Error{ErrorCode::kImageSliceMissing, "the series has no slice " + std::to_string(to)};
    });
  }
  if (verb == "click" || verb == "edge") {
    const Vec2 p = words.Place(0);
    return run([&] {
      return verb == "click" ? document.AddPoint(structure, slice, p)
                             : workspace.FollowEdge(structure, slice, p);
    });
  }
  if (verb == "close" || verb == "close-hole") {
    return run([&] { return document.CloseContour(structure, slice, verb == "close-hole"); });
  }
  if (verb == "drop") return run([&] { return document.DropOpenContour(structure, slice); });
  if (verb == "move" || verb == "insert") {
    const auto id = words.Contour(0, editor);
    const std::size_t point = words.Index(1);
    const Vec2 p = words.Place(2);
    return run([&] {
      return verb == "move" ? document.MovePoint(id, point, p) : document.InsertPoint(id, point, p);
    });
  }
  if (verb == "delete-point") {
    const auto id = words.Contour(0, editor);
    const std::size_t point = words.Index(1);
    return run([&] { return document.DeletePoint(id, point); });
  }
  if (verb == "delete" || verb == "hole") {
    const auto id = words.Contour(0, editor);
    return run([&] { return verb == "delete" ? document.DeleteContour(id) : document.ToggleHole(id); });
  }
  if (verb == "choose") {
    const auto id = words.Contour(0, editor);
    std::optional<std::size_t> point;
    if (step.words.size() > 1) point = words.Index(1);
    return run([&]() -> core::Status {
      const auto polygon = document.Find(id);
      if (polygon.empty() || (point && *point >= polygon.size())) {
        return Error{ErrorCode::kEditRefused, "there is no such contour or point"};
      }
      editor.Choose(ContourChoice{id, point});
      return {};
    });
  }
  if (verb == "clear") return run([&] { return document.ClearSlice(structure, slice); });
  if (verb == "propagate") {
    const int to = words.Whole(0);
    return run([&]() -> core::Status {
      const auto carried = workspace.Propagate(structure, slice, to);
      if (!carried.ok()) return carried.error();
      editor.SetSlice(to);
      return {};
    });
  }
  if (verb == "undo" || verb == "redo") {
    return run([&]() -> core::Status {
      if (verb == "undo" ? document.CanUndo() : document.CanRedo()) {
        editor.Do(verb == "undo" ? ContourAction::kUndo : ContourAction::kRedo);
        return {};
      }
      return Error{ErrorCode::kEditRefused, "there is nothing to " + verb};
    });
  }
  if (verb == "reach") {
    const double reach = words.Number(0);
    return run([&]() -> core::Status {
      if (document.Points().structures.empty())
        return Error{ErrorCode::kEditRefused, "there is no organ yet"};
      auto adaption = document.Points().structures[structure].adaption;
      adaption.max_shift_px = reach;
      return document.SetAdaption(structure, adaption);
    });
  }
  if (verb == "save") return run([&] { return workspace.Save(step.words[0]); });
  if (verb == "scissors") {
    if (step.words[0] != "on" && step.words[0] != "off") {
      return AtLine(step.line, ErrorCode::kScriptInvalid, "write: scissors on, or scissors off");
    }
    editor.SetScissors(step.words[0] == "on");
    return run(done);
  }
  if (verb == "pointer") {
    const Vec2 p = words.Place(0);
    return run([&]() -> core::Status {
      editor.Hover(ToCanvas(editor.view, editor.size, p));
      return {};
    });
  }
  if (verb == "view") {
    const Vec2 centre = words.Place(0);
    const double zoom = words.Number(2);
    return run([&]() -> core::Status {
      if (!(zoom >= kLeastZoom && zoom <= kMostZoom)) {
        return Error{ErrorCode::kScriptInvalid, "the zoom lies between 0.05 and 40"};
      }
      editor.view.centre = centre;
      editor.view.zoom = zoom;
      return {};
    });
  }
  if (verb == "fit") {
    if (step.words[0] != "picture" && step.words[0] != "organ") {
      return AtLine(step.line, ErrorCode::kScriptInvalid, "write: fit picture, or fit organ");
    }
    editor.Do(step.words[0] == "organ" ? ContourAction::kFitOrgan : ContourAction::kFitView);
    return run(done);
  }
  return false;
}

std::string DescribeContourScript() {
  std::string text;
  for (const Verb& verb : kVerbs) {
    char line[160];
    std::snprintf(line, sizeof(line), "  %-13s %-17s %s\n", verb.name, verb.words, verb.meaning);
    text += line;
  }
  return text;
}

}  // namespace trocar::app
