// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_document.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "trocar/base/assert.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kGrain = 100.0;  // points are kept to 1 / kGrain pixel, as the file keeps them
constexpr std::size_t kMinPoints = 3;
constexpr std::size_t kMaxPoints = 10000;  // of one contour; a slip of a script must not fill the memory

base::Error Refused(std::string why) {
  return {base::ErrorCode::kEditRefused, std::move(why)};
}

std::size_t CountDistinct(std::span<const Vec2> points) {
  std::set<std::pair<double, double>> distinct;
  for (const Vec2& p : points) distinct.insert({p.x, p.y});
  return distinct.size();
}

auto FindSlice(auto& slices, int slice) {
  return std::lower_bound(slices.begin(), slices.end(), slice,
                          [](const SliceContours& s, int number) { return s.slice < number; });
}

std::size_t CountBytes(const SliceContours& s) {
  std::size_t bytes = sizeof(s) + s.open.size() * sizeof(Vec2);
  for (const auto* group : {&s.contours, &s.holes}) {
    for (const auto& polygon : *group) bytes += sizeof(polygon) + polygon.size() * sizeof(Vec2);
  }
  return bytes;
}

std::size_t CountBytes(const Structure& s) {
  std::size_t bytes = sizeof(s) + s.name.size();
  for (const SliceContours& slice : s.slices) bytes += CountBytes(slice);
  return bytes;
}

Structure WithoutSlices(const Structure& s) {
  Structure header = s;
  header.slices.clear();
  return header;
}

bool IsEmpty(const SliceContours& s) {
  return s.contours.empty() && s.holes.empty() && s.open.empty();
}

}  // namespace

ContourDocument::ContourDocument(ControlPoints points, std::size_t history_bytes)
    : points_(std::move(points)), history_limit_(history_bytes) {}

const SliceContours& ContourDocument::At(int structure, int slice) const {
  static const SliceContours nothing;
  if (structure < 0 || structure >= static_cast<int>(points_.structures.size())) return nothing;
  const auto& slices = points_.structures[structure].slices;
  const auto found = FindSlice(slices, slice);
  return found != slices.end() && found->slice == slice ? *found : nothing;
}

std::span<const Vec2> ContourDocument::Find(const ContourId& id) const {
  const SliceContours& content = At(id.structure, id.slice);
  const auto& group = id.is_hole ? content.holes : content.contours;
  if (id.index < 0 || id.index >= static_cast<int>(group.size())) return {};
  return group[id.index];
}

std::vector<int> ContourDocument::ContouredSlices(int structure) const {
  std::vector<int> numbers;
  if (!CheckStructure(structure).ok()) return numbers;
  for (const SliceContours& s : points_.structures[structure].slices) {
    if (!s.contours.empty()) numbers.push_back(s.slice);
  }
  return numbers;
}

// checks

base::Status ContourDocument::CheckStructure(int structure) const {
  if (structure >= 0 && structure < static_cast<int>(points_.structures.size())) return {};
  return Refused(points_.structures.empty() ? "there is no organ yet; add one first"
                                            : "there is no such organ; choose one of the list");
}

base::Status ContourDocument::CheckPlace(int structure, int slice) const {
  if (auto status = CheckStructure(structure); !status.ok()) return status;
  if (slice >= points_.first_slice && slice <= points_.last_slice) return {};
  return Refused("there is no slice " + std::to_string(slice) + "; the series has " +
                 std::to_string(points_.first_slice) + " to " + std::to_string(points_.last_slice));
}

base::Status ContourDocument::CheckContour(const ContourId& id) const {
  if (auto status = CheckPlace(id.structure, id.slice); !status.ok()) return status;
  if (!Find(id).empty()) return {};
  return Refused("slice " + std::to_string(id.slice) + " has no such contour; click one to choose it");
}

base::Result<Vec2> ContourDocument::Keep(const Vec2& p) const {
  if (!std::isfinite(p.x) || !std::isfinite(p.y)) return Refused("a point must have finite coordinates");
  const auto keep = [](double value, int size) {
    return std::round(std::clamp(value, 0.0, size - 1.0) * kGrain) / kGrain;
  };
  return Vec2{keep(p.x, points_.width), keep(p.y, points_.height)};
}

// the contour that is being drawn

base::Status ContourDocument::AddPoint(int structure, int slice, const Vec2& p) {
  return AddPath(structure, slice, std::span(&p, 1));
}

base::Status ContourDocument::AddPath(int structure, int slice, std::span<const Vec2> path) {
  if (auto status = CheckPlace(structure, slice); !status.ok()) return status;
  SliceContours after = At(structure, slice);
  for (const Vec2& p : path) {
    const auto kept = Keep(p);
    if (!kept.ok()) return kept.error();
    // a double click or the end of the last path is no second point
    if (after.open.empty() || after.open.back() != *kept) after.open.push_back(*kept);
  }
  return EditSlice(structure, slice, std::move(after), path.size() == 1 ? "add a point" : "follow an edge");
}

base::Status ContourDocument::CloseContour(int structure, int slice, bool is_hole) {
  if (auto status = CheckPlace(structure, slice); !status.ok()) return status;
  SliceContours after = At(structure, slice);
  if (after.open.empty())
    return Refused("no contour is being drawn here; click points around the organ first");
  if (is_hole && after.contours.empty()) {
    return Refused("a hole lies in a contour; draw the contour around it first");
  }
  (is_hole ? after.holes : after.contours).push_back(std::exchange(after.open, {}));
  return EditSlice(structure, slice, std::move(after), is_hole ? "close a hole" : "close a contour");
}

base::Status ContourDocument::DropOpenContour(int structure, int slice) {
  if (auto status = CheckPlace(structure, slice); !status.ok()) return status;
  SliceContours after = At(structure, slice);
  if (after.open.empty()) return Refused("no contour is being drawn here");
  after.open.clear();
  return EditSlice(structure, slice, std::move(after), "drop the points of an open contour");
}

base::Status ContourDocument::RemoveLastPoint(int structure, int slice) {
  if (auto status = CheckPlace(structure, slice); !status.ok()) return status;
  SliceContours after = At(structure, slice);
  if (after.open.empty()) return Refused("no contour is being drawn here");
  after.open.pop_back();
  return EditSlice(structure, slice, std::move(after), "remove the last point");
}

// closed contours

base::Status ContourDocument::MovePoint(const ContourId& id, std::size_t point, const Vec2& to) {
  if (auto status = CheckContour(id); !status.ok()) return status;
  if (point >= Find(id).size()) return Refused("this contour has no such point");
  const auto kept = Keep(to);
  if (!kept.ok()) return kept.error();
  SliceContours after = At(id.structure, id.slice);
  (id.is_hole ? after.holes : after.contours)[id.index][point] = *kept;
  return EditSlice(id.structure, id.slice, std::move(after), "move a point");
}

base::Status ContourDocument::InsertPoint(const ContourId& id, std::size_t before, const Vec2& p) {
  if (auto status = CheckContour(id); !status.ok()) return status;
  if (before > Find(id).size()) return Refused("this contour has no such place for a point");
  const auto kept = Keep(p);
  if (!kept.ok()) return kept.error();
  SliceContours after = At(id.structure, id.slice);
  auto& polygon = (id.is_hole ? after.holes : after.contours)[id.index];
  polygon.insert(polygon.begin() + static_cast<std::ptrdiff_t>(before), *kept);
  return EditSlice(id.structure, id.slice, std::move(after), "insert a point");
}

base::Status ContourDocument::DeletePoint(const ContourId& id, std::size_t point) {
  if (auto status = CheckContour(id); !status.ok()) return status;
  if (point >= Find(id).size()) return Refused("this contour has no such point");
  SliceContours after = At(id.structure, id.slice);
  auto& polygon = (id.is_hole ? after.holes : after.contours)[id.index];
  polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(point));
  return EditSlice(id.structure, id.slice, std::move(after), "delete a point");
}

base::Status ContourDocument::DeleteContour(const ContourId& id) {
  if (auto status = CheckContour(id); !status.ok()) return status;
  SliceContours after = At(id.structure, id.slice);
  auto& group = id.is_hole ? after.holes : after.contours;
  group.erase(group.begin() + id.index);
  if (after.contours.empty()) after.holes.clear();
  return EditSlice(id.structure, id.slice, std::move(after),
                   id.is_hole ? "delete a hole" : "delete a contour");
}

base::Status ContourDocument::ToggleHole(const ContourId& id) {
  if (auto status = CheckContour(id); !status.ok()) return status;
  SliceContours after = At(id.structure, id.slice);
  auto& from = id.is_hole ? after.holes : after.contours;
  auto& to = id.is_hole ? after.contours : after.holes;
  if (!id.is_hole && from.size() == 1) {
    return Refused("the only contour of a slice cannot be a hole; draw the contour around it first");
  }
  to.push_back(std::move(from[id.index]));
  from.erase(from.begin() + id.index);
  return EditSlice(id.structure, id.slice, std::move(after),
                   id.is_hole ? "make a hole a contour" : "make a contour a hole");
}

base::Status ContourDocument::SetContours(int structure, int slice, std::vector<std::vector<Vec2>> contours,
                                          std::vector<std::vector<Vec2>> holes, std::string_view what) {
  if (auto status = CheckPlace(structure, slice); !status.ok()) return status;
  for (auto* group : {&contours, &holes}) {
    for (auto& polygon : *group) {
      for (Vec2& p : polygon) {
        const auto kept = Keep(p);
        if (!kept.ok()) return kept.error();
        p = *kept;
      }
    }
  }
  SliceContours after = At(structure, slice);
  after.contours = std::move(contours);
  after.holes = std::move(holes);
  return EditSlice(structure, slice, std::move(after), what);
}

base::Status ContourDocument::ClearSlice(int structure, int slice) {
  if (auto status = CheckPlace(structure, slice); !status.ok()) return status;
  if (IsEmpty(At(structure, slice))) return Refused("slice " + std::to_string(slice) + " is empty");
  return EditSlice(structure, slice, {}, "clear the slice");
}

// organs

base::Status ContourDocument::AddStructure(const std::string& name, int triangle_budget) {
  if (name.empty()) return Refused("an organ needs a name, for example liver");
  if (points_.FindStructure(name) != nullptr) return Refused("there is an organ named " + name + " already");
  if (triangle_budget < 100 || triangle_budget > 1000000) {
    return Refused("a mesh has 100 to 1,000,000 triangles");
  }
  for (const TubePoints& tube : points_.tubes) {
    if (tube.name == name) return Refused("there is a duct or artery named " + name + " already");
  }
  Structure added;
  added.name = name;
  added.triangle_budget = triangle_budget;
  const int index = static_cast<int>(points_.structures.size());
  Record(StructureEdit{index, true, std::move(added)}, {index, std::nullopt, "add " + name});
  return {};
}

base::Status ContourDocument::RenameStructure(int structure, const std::string& name) {
  if (auto status = CheckStructure(structure); !status.ok()) return status;
  if (name == points_.structures[structure].name) return {};
  if (name.empty()) return Refused("an organ needs a name, for example liver");
  if (points_.FindStructure(name) != nullptr) return Refused("there is an organ named " + name + " already");
  for (const TubePoints& tube : points_.tubes) {
    if (tube.name == name) return Refused("there is a duct or artery named " + name + " already");
  }
  HeaderEdit edit{structure, WithoutSlices(points_.structures[structure]), {}};
  edit.after = edit.before;
  edit.after.name = name;
  Record(std::move(edit), {structure, std::nullopt, "rename an organ"});
  return {};
}

base::Status ContourDocument::DeleteStructure(int structure) {
  if (auto status = CheckStructure(structure); !status.ok()) return status;
  const Structure& old = points_.structures[structure];
  Record(StructureEdit{structure, false, old}, {structure, std::nullopt, "delete " + old.name});
  return {};
}

base::Status ContourDocument::SetAdaption(int structure, const EdgeAdaptionSettings& adaption) {
  if (auto status = CheckStructure(structure); !status.ok()) return status;
  // the ranges of the file's reader
  const auto is_in = [](double value, double low, double high) { return value >= low && value <= high; };
  if (!is_in(adaption.max_shift_px, 0, 30) || !is_in(adaption.blur_px, 0.3, 10) ||
      !is_in(adaption.min_gradient, 0, 1000) || !is_in(adaption.nearness, 0, 1) ||
      !is_in(adaption.smoothness, 0, 100) || !is_in(adaption.skipped_shift_px, 0, 30)) {
    return Refused("a setting of the edge search is out of range; see schemas/control-points.schema.json");
  }
  HeaderEdit edit{structure, WithoutSlices(points_.structures[structure]), {}};
  if (edit.before.adaption == adaption) return {};
  edit.after = edit.before;
  edit.after.adaption = adaption;
  Record(std::move(edit), {structure, std::nullopt, "change the edge search"});
  return {};
}

// doing, undoing

base::Status ContourDocument::EditSlice(int structure, int slice, SliceContours after,
                                        std::string_view what) {
  after.slice = slice;
  for (const auto* group : {&after.contours, &after.holes}) {
    for (const auto& polygon : *group) {
      if (const std::size_t count = CountDistinct(polygon); count < kMinPoints) {
        return Refused("a closed contour needs at least 3 different points, this one would have " +
                       std::to_string(count) + "; delete the contour instead, or add points");
      }
      if (polygon.size() > kMaxPoints) return Refused("a contour has at most 10,000 points");
    }
  }
  if (after.open.size() > kMaxPoints) return Refused("a contour has at most 10,000 points");
  if (!after.holes.empty() && after.contours.empty())
    return Refused("a hole lies in a contour; draw one first");
  SliceContours before = At(structure, slice);
  before.slice = slice;
  if (before == after) return {};
  Record(SliceEdit{structure, slice, std::move(before), std::move(after)},
         {structure, slice, std::string(what)});
  return {};
}

void ContourDocument::PutSlice(int structure, int slice, const SliceContours& content) {
  auto& slices = points_.structures[structure].slices;
  const auto found = FindSlice(slices, slice);
  const bool exists = found != slices.end() && found->slice == slice;
  if (IsEmpty(content)) {
    if (exists) slices.erase(found);
  } else if (exists) {
    *found = content;
  } else {
    slices.insert(found, content);
  }
}

void ContourDocument::Apply(const Edit& edit, bool is_forward) {
  if (const auto* slice = std::get_if<SliceEdit>(&edit)) {
    PutSlice(slice->structure, slice->slice, is_forward ? slice->after : slice->before);
  } else if (const auto* header = std::get_if<HeaderEdit>(&edit)) {
    Structure& target = points_.structures[header->structure];
    auto slices = std::move(target.slices);
    target = is_forward ? header->after : header->before;
    target.slices = std::move(slices);
  } else {
    const auto& structure = std::get<StructureEdit>(edit);
    const auto at = points_.structures.begin() + structure.index;
    if (structure.is_added == is_forward) {
      points_.structures.insert(at, structure.structure);
    } else {
      points_.structures.erase(at);
    }
  }
  ++revision_;
}

void ContourDocument::Record(Edit edit, EditPlace place) {
  Apply(edit, true);
  const std::uint64_t before = state_;
  state_ = next_state_++;
  if (!is_gesture_) {
    Step step{std::move(place), {}, before, state_};
    step.edits.push_back(std::move(edit));
    Push(std::move(step));
    return;
  }
  if (gesture_.edits.empty()) gesture_.place = std::move(place);
  // the positions that a dragged point passed are no steps
  auto* last = gesture_.edits.empty() ? nullptr : std::get_if<SliceEdit>(&gesture_.edits.back());
  auto* next = std::get_if<SliceEdit>(&edit);
  if (last != nullptr && next != nullptr && last->structure == next->structure &&
      last->slice == next->slice) {
    last->after = std::move(next->after);
  } else {
    gesture_.edits.push_back(std::move(edit));
  }
}

void ContourDocument::Push(Step step) {
  const auto count = [](const Edit& edit) {
    if (const auto* slice = std::get_if<SliceEdit>(&edit)) {
      return CountBytes(slice->before) + CountBytes(slice->after);
    }
    if (const auto* structure = std::get_if<StructureEdit>(&edit)) return CountBytes(structure->structure);
    const auto& header = std::get<HeaderEdit>(edit);
    return CountBytes(header.before) + CountBytes(header.after);
  };
  step.bytes = sizeof(step) + step.place.what.size();
  for (const Edit& edit : step.edits) step.bytes += sizeof(edit) + count(edit);
  for (const Step& gone : undone_) history_bytes_ -= gone.bytes;
  undone_.clear();
  history_bytes_ += step.bytes;
  done_.push_back(std::move(step));
  while (history_bytes_ > history_limit_ && done_.size() > 1) {
    history_bytes_ -= done_.front().bytes;
    done_.pop_front();
  }
}

void ContourDocument::BeginGesture() {
  if (is_gesture_) EndGesture();
  is_gesture_ = true;
  gesture_ = {};
  gesture_.state_before = state_;
}

void ContourDocument::EndGesture() {
  if (!is_gesture_) return;
  is_gesture_ = false;
  // a drag that came back to where it began is nothing
  std::erase_if(gesture_.edits, [](const Edit& edit) {
    const auto* slice = std::get_if<SliceEdit>(&edit);
    return slice != nullptr && slice->before == slice->after;
  });
  if (gesture_.edits.empty()) {
    state_ = gesture_.state_before;
    return;
  }
  gesture_.state_after = state_;
  Push(std::exchange(gesture_, {}));
}

void ContourDocument::CancelGesture() {
  if (!is_gesture_) return;
  is_gesture_ = false;
  for (auto edit = gesture_.edits.rbegin(); edit != gesture_.edits.rend(); ++edit) Apply(*edit, false);
  state_ = gesture_.state_before;
  gesture_ = {};
}

std::optional<EditPlace> ContourDocument::Undo() {
  if (!CanUndo()) return std::nullopt;
  Step step = std::move(done_.back());
  done_.pop_back();
  for (auto edit = step.edits.rbegin(); edit != step.edits.rend(); ++edit) Apply(*edit, false);
  state_ = step.state_before;
  undone_.push_back(std::move(step));
  return undone_.back().place;
}

std::optional<EditPlace> ContourDocument::Redo() {
  if (!CanRedo()) return std::nullopt;
  Step step = std::move(undone_.back());
  undone_.pop_back();
  for (const Edit& edit : step.edits) Apply(edit, true);
  state_ = step.state_after;
  done_.push_back(std::move(step));
  return done_.back().place;
}

}  // namespace trocar::contours
