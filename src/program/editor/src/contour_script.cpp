// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_script.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>

namespace trocar::editor {

using math::Vec2;

namespace {

using base::Error;
using base::ErrorCode;

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

/// What a step works on. Words are read first: what is no number changes nothing.
struct Run {
  const ScriptStep& step;
  ContourEditor& editor;
  Words words;

  contours::ContourWorkspace& Workspace() const { return editor.Workspace(); }
  contours::ContourDocument& Document() const { return editor.Workspace().Document(); }

  /// Does the command unless a word was wrong; what goes wrong names the line.
  template <typename Command>
  base::Status Do(Command&& command) {
    if (words.Complaint()) return *words.Complaint();
    const base::Status status = command();
    return status.ok() ? status : AtLine(step.line, status.error().code, status.error().message);
  }
  base::Status Refuse(ErrorCode code, const std::string& what) const { return AtLine(step.line, code, what); }
};

// organs

base::Status ChooseOrgan(Run& run) {
  const auto& structures = run.Document().Points().structures;
  for (std::size_t i = 0; i < structures.size(); ++i) {
    if (structures[i].name != run.step.words[0]) continue;
    run.editor.ChooseStructure(static_cast<int>(i));
    return {};
  }
  return run.Refuse(ErrorCode::kUnknownName, "there is no organ named " + run.step.words[0]);
}

base::Status AddOrgan(Run& run) {
  constexpr int kTriangles = 1000;
  const int budget = run.step.words.size() > 1 ? run.words.Whole(1) : kTriangles;
  return run.Do([&] {
    auto status = run.Document().AddStructure(run.step.words[0], budget);
    if (status.ok())
      run.editor.ChooseStructure(static_cast<int>(run.Document().Points().structures.size()) - 1);
    return status;
  });
}

base::Status RenameOrgan(Run& run) {
  return run.Do([&] { return run.Document().RenameStructure(run.editor.Structure(), run.step.words[0]); });
}

base::Status DeleteOrgan(Run& run) {
  return run.Do([&] {
    auto status = run.Document().DeleteStructure(run.editor.Structure());
    run.editor.ChooseStructure(0);
    return status;
  });
}

base::Status SetReach(Run& run) {
  const double reach = run.words.Number(0);
  return run.Do([&]() -> base::Status {
    if (run.Document().Points().structures.empty())
      return Error{ErrorCode::kEditRefused, "there is no organ yet"};
    auto adaption = run.Document().Points().structures[run.editor.Structure()].adaption;
    adaption.max_shift_px = reach;
    return run.Document().SetAdaption(run.editor.Structure(), adaption);
  });
}

// slices and contours

base::Status GoToSlice(Run& run) {
  const int to = run.words.Whole(0);
  return run.Do([&]() -> base::Status {
    run.editor.SetSlice(to);
    if (run.editor.Slice() == to) return {};
    return Error{ErrorCode::kImageSliceMissing, "the series has no slice " + std::to_string(to)};
  });
}

base::Status Click(Run& run) {
  const Vec2 p = run.words.Place(0);
  return run.Do([&] { return run.Document().AddPoint(run.editor.Structure(), run.editor.Slice(), p); });
}

base::Status FollowEdge(Run& run) {
  const Vec2 p = run.words.Place(0);
  return run.Do([&] { return run.Workspace().FollowEdge(run.editor.Structure(), run.editor.Slice(), p); });
}

base::Status CloseContour(Run& run) {
  return run.Do([&] { return run.Document().CloseContour(run.editor.Structure(), run.editor.Slice()); });
}

base::Status CloseHole(Run& run) {
  return run.Do(
      [&] { return run.Document().CloseContour(run.editor.Structure(), run.editor.Slice(), true); });
}

base::Status Drop(Run& run) {
  return run.Do([&] { return run.Document().DropOpenContour(run.editor.Structure(), run.editor.Slice()); });
}

base::Status MovePoint(Run& run) {
  const auto id = run.words.Contour(0, run.editor);
  const std::size_t point = run.words.Index(1);
  const Vec2 p = run.words.Place(2);
  return run.Do([&] { return run.Document().MovePoint(id, point, p); });
}

base::Status InsertPoint(Run& run) {
  const auto id = run.words.Contour(0, run.editor);
  const std::size_t point = run.words.Index(1);
  const Vec2 p = run.words.Place(2);
  return run.Do([&] { return run.Document().InsertPoint(id, point, p); });
}

base::Status DeletePoint(Run& run) {
  const auto id = run.words.Contour(0, run.editor);
  const std::size_t point = run.words.Index(1);
  return run.Do([&] { return run.Document().DeletePoint(id, point); });
}

base::Status DeleteContour(Run& run) {
  const auto id = run.words.Contour(0, run.editor);
  return run.Do([&] { return run.Document().DeleteContour(id); });
}

base::Status ToggleHole(Run& run) {
  const auto id = run.words.Contour(0, run.editor);
  return run.Do([&] { return run.Document().ToggleHole(id); });
}

base::Status Choose(Run& run) {
  const auto id = run.words.Contour(0, run.editor);
  std::optional<std::size_t> point;
  if (run.step.words.size() > 1) point = run.words.Index(1);
  return run.Do([&]() -> base::Status {
    const auto polygon = run.Document().Find(id);
    if (polygon.empty() || (point && *point >= polygon.size()))
      return Error{ErrorCode::kEditRefused, "there is no such contour or point"};
    run.editor.Choose(ContourChoice{id, point});
    return {};
  });
}

base::Status ClearSlice(Run& run) {
  return run.Do([&] { return run.Document().ClearSlice(run.editor.Structure(), run.editor.Slice()); });
}

base::Status Propagate(Run& run) {
  const int to = run.words.Whole(0);
  return run.Do([&]() -> base::Status {
    const auto carried = run.Workspace().Propagate(run.editor.Structure(), run.editor.Slice(), to);
    if (!carried.ok()) return carried.error();
    run.editor.SetSlice(to);
    return {};
  });
}

base::Status Grow(Run& run) {
  const Vec2 click = run.words.Place(0);
  return run.Do([&]() -> base::Status {
    if (run.Document().Points().structures.empty())
      return Error{ErrorCode::kEditRefused, "there is no organ yet"};
    const auto grown = contours::GrowOrgan(
        run.Workspace().MakeGrowthRequest(run.editor.Structure(), run.editor.Slice(), click));
    return grown.ok() ? contours::ApplyGrowth(run.Document(), *grown) : grown.error();
  });
}

base::Status Undo(Run& run) {
  if (!run.Document().CanUndo()) return run.Refuse(ErrorCode::kEditRefused, "there is nothing to undo");
  run.editor.Do(ContourAction::kUndo);
  return {};
}

base::Status Redo(Run& run) {
  if (!run.Document().CanRedo()) return run.Refuse(ErrorCode::kEditRefused, "there is nothing to redo");
  run.editor.Do(ContourAction::kRedo);
  return {};
}

base::Status Save(Run& run) {
  return run.Do([&] { return run.Workspace().Save(run.step.words[0]); });
}

// the view

base::Status SetScissors(Run& run) {
  const std::string& word = run.step.words[0];
  if (word != "on" && word != "off")
    return run.Refuse(ErrorCode::kScriptInvalid, "write: scissors on, or scissors off");
  run.editor.SetScissors(word == "on");
  return {};
}

base::Status MovePointer(Run& run) {
  const Vec2 p = run.words.Place(0);
  return run.Do([&]() -> base::Status {
    run.editor.Hover(ToCanvas(run.editor.view, run.editor.size, p));
    return {};
  });
}

base::Status SetView(Run& run) {
  const Vec2 centre = run.words.Place(0);
  const double zoom = run.words.Number(2);
  return run.Do([&]() -> base::Status {
    if (!(zoom >= kLeastZoom && zoom <= kMostZoom))
      return Error{ErrorCode::kScriptInvalid, "the zoom lies between 0.05 and 40"};
    run.editor.view.centre = centre;
    run.editor.view.zoom = zoom;
    return {};
  });
}

base::Status Fit(Run& run) {
  const std::string& word = run.step.words[0];
  if (word != "picture" && word != "organ")
    return run.Refuse(ErrorCode::kScriptInvalid, "write: fit picture, or fit organ");
  run.editor.Do(word == "organ" ? ContourAction::kFitOrgan : ContourAction::kFitView);
  return {};
}

struct Verb {
  const char* name;
  int least, most;  // words
  const char* words;
  const char* meaning;
  base::Status (*act)(Run&);  // null: the window's affair
};

constexpr Verb kVerbs[] = {
    {"sizes", 5, 5, "PX SL COL ROW NUM", "window: first, where the pictures do not say them; mm, directions",
     nullptr},
    {"organ", 1, 1, "NAME", "choose an organ", ChooseOrgan},
    {"add-organ", 1, 2, "NAME [TRIANGLES]", "add an organ and choose it", AddOrgan},
    {"rename-organ", 1, 1, "NAME", "rename the chosen organ", RenameOrgan},
    {"delete-organ", 0, 0, "", "delete the chosen organ", DeleteOrgan},
    {"slice", 1, 1, "N", "go to a slice", GoToSlice},
    {"click", 2, 2, "X Y", "set a point of the open contour", Click},
    {"edge", 2, 2, "X Y", "follow the edge to a place (scissors)", FollowEdge},
    {"close", 0, 0, "", "close the open contour", CloseContour},
    {"close-hole", 0, 0, "", "close the open contour as a hole", CloseHole},
    {"drop", 0, 0, "", "drop the open contour", Drop},
    {"move", 4, 4, "C I X Y", "move point I of contour C (h0, h1, ... are holes)", MovePoint},
    {"insert", 4, 4, "C I X Y", "insert a point before point I of contour C", InsertPoint},
    {"delete-point", 2, 2, "C I", "delete point I of contour C", DeletePoint},
    {"delete", 1, 1, "C", "delete a contour", DeleteContour},
    {"hole", 1, 1, "C", "make a contour a hole, or a hole a contour", ToggleHole},
    {"choose", 1, 2, "C [I]", "choose a contour and a point of it", Choose},
    {"clear", 0, 0, "", "clear the slice", ClearSlice},
    {"propagate", 1, 1, "N", "carry the slice's contours to slice N and go there", Propagate},
    {"grow", 2, 2, "X Y", "grow the organ from a click into it, in all slices", Grow},
    {"undo", 0, 0, "", "undo", Undo},
    {"redo", 0, 0, "", "redo", Redo},
    {"reach", 1, 1, "PX", "how far points may move to an edge", SetReach},
    {"save", 1, 1, "FILE", "save the contours", Save},
    {"scissors", 1, 1, "on|off", "window: scissors mode", SetScissors},
    {"pointer", 2, 2, "X Y", "window: the pointer lies there", MovePointer},
    {"view", 3, 3, "X Y ZOOM", "window: what lies in the middle, pixels of the screen a pixel", SetView},
    {"fit", 1, 1, "picture|organ", "window: show the whole", Fit},
    {"show", 2, 2, "PART on|off", "window: reference, ghosts, points, fill or help", nullptr},
    {"answer", 1, 8, "LABEL", "window: press the button LABEL of a question that is shown", nullptr},
    {"build", 1, 1, "FOLDER", "window: build the patient of the saved contours", nullptr},
    {"stop-build", 0, 0, "", "window: give the patient up that is being built", nullptr},
    {"await", 1, 1, "mesh|build", "window: wait until the surfaces, or the patient, are made", nullptr},
};

const Verb* FindVerb(std::string_view name) {
  for (const Verb& verb : kVerbs) {
    if (verb.name == name) return &verb;
  }
  return nullptr;
}

}  // namespace

base::Result<std::vector<ScriptStep>> ParseContourScript(std::string_view text, std::string_view source) {
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

base::Result<bool> RunScriptStep(const ScriptStep& step, ContourEditor& editor) {
  const Verb* verb = FindVerb(step.verb);
  if (verb == nullptr || verb->act == nullptr) return false;
  Run run{step, editor, Words(step)};
  if (const base::Status status = verb->act(run); !status.ok()) return status.error();
  return true;
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

}  // namespace trocar::editor
