// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/gallstone_spill.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/math/elementary.h"
#include "trocar/math/state_fields.h"

namespace trocar::surgery {

using math::Pose;
using math::Vec3;

base::Result<GallstoneSpill> GallstoneSpill::Make(std::span<const double> diameters,
                                                  geometry::TriangleMesh omentum,
                                                  const StoneSettings& settings) {
  GallstoneSpill made;
  made.settings_ = settings;
  for (const double diameter : diameters) {
    Stone stone;
    stone.body.radius = 0.5 * diameter;
    made.stones_.push_back(stone);
  }
  made.loose_.reserve(made.stones_.size() + kMostOthers);
  auto bed = std::make_shared<Bed>();
  bed->mesh = std::move(omentum);
  auto surface = MakeOrganSurface(bed->mesh.positions, 0, bed->mesh);
  if (!surface.ok()) return surface.error();
  bed->surface = std::move(*surface);
  made.bed_ = std::move(bed);
  return made;
}

void GallstoneSpill::Reset() noexcept {
  for (Stone& stone : stones_) {
    const double radius = stone.body.radius;
    stone = {};
    stone.body.radius = radius;
  }
  held_ = {-1, -1};
  has_taken_ = {};
  carried_ = 0;
}

bool GallstoneSpill::HasInside() const noexcept {
  return std::any_of(stones_.begin(), stones_.end(),
                     [](const Stone& stone) { return stone.place == StonePlace::kInside; });
}

int GallstoneSpill::Spill(double leaked, double content, const WallHole& hole) noexcept {
  const double passing = CalcPassingDiameter(hole.rim);
  const auto fits = [passing](const Stone& stone) {
    return stone.place == StonePlace::kInside && 2.0 * stone.body.radius <= passing;
  };
  const auto fitting = static_cast<std::size_t>(std::count_if(stones_.begin(), stones_.end(), fits));
  carried_ += CalcStoneOutflow(leaked, content, fitting);
  int count = 0;
  for (; carried_ >= 1.0; carried_ -= 1.0) {
    const auto next = std::find_if(stones_.begin(), stones_.end(), fits);
    if (next == stones_.end()) break;
    next->place = StonePlace::kSpilled;
    next->body.position = hole.position + (next->body.radius + settings_.out_gap) * hole.outwards;
    next->body.velocity = settings_.out_speed * hole.outwards;
    next->body.anchor = next->body.position;
    ++count;
  }
  return count;
}

void GallstoneSpill::AddSpilled() noexcept {
  for (Stone& stone : stones_) {
    if (stone.place == StonePlace::kSpilled) loose_.push_back(&stone.body);
  }
}

void GallstoneSpill::Move(StoneGround ground, std::span<const Pose> X_world_tools,
                          std::span<LooseStone* const> others, double seconds) noexcept {
  for (std::size_t hand = 0; hand < held_.size(); ++hand) {
    if (held_[hand] < 0) continue;
    Stone& stone = stones_[static_cast<std::size_t>(held_[hand])];
    stone.body.position = X_world_tools[hand] * stone.p_tool;
  }
  if (bed_ == nullptr) return;
  loose_.assign(others.begin(),
                others.begin() + static_cast<std::ptrdiff_t>(std::min(others.size(), kMostOthers)));
  AddSpilled();
  if (loose_.empty()) return;
  ground.bed = &bed_->surface;
  ground.bed_positions = bed_->mesh.positions;
  MoveStones(ground, seconds, loose_);
}

void GallstoneSpill::ForgetSupports() noexcept {
  loose_.clear();
  AddSpilled();
  surgery::ForgetSupports(loose_);
}

void GallstoneSpill::LetGo(int hand) noexcept {
  std::int32_t& held = held_[static_cast<std::size_t>(hand)];
  Stone& stone = stones_[static_cast<std::size_t>(held)];
  stone.place = StonePlace::kSpilled;
  stone.body.support = LooseStone::kOnNothing;
  stone.body.velocity = {};
  stone.body.anchor = stone.body.position;
  stone.body.still_seconds = 0;
  held = -1;
}

double GallstoneSpill::StopJaw(int hand, const instrument::Tool& tool, const Pose& X_world_tool,
                               double jaw_before, double jaw, bool can_take) noexcept {
  std::int32_t& held = held_[static_cast<std::size_t>(hand)];
  const double closed = settings_.closed_share * tool.max_jaw, open = settings_.open_share * tool.max_jaw;
  if (held >= 0) {
    const double opening = stones_[static_cast<std::size_t>(held)].opening;
    if (jaw > std::max(opening + settings_.let_go, open)) LetGo(hand);
    return std::max(jaw, opening);
  }
  if (!can_take || !(jaw < jaw_before)) return jaw;
  const Pose X_tool_world = math::Inverse(X_world_tool);
  double widest = 0;
  for (std::size_t i = 0; i < stones_.size(); ++i) {
    const Stone& stone = stones_[i];
    if (stone.place != StonePlace::kSpilled) continue;
    const Vec3 p = X_tool_world * stone.body.position;
    const double radius = stone.body.radius, from_hinge = tool.jaw_length - p.z;
    if (from_hinge < settings_.near_hinge * tool.jaw_length || p.z < -settings_.jaw_reach * radius) continue;
    if (std::fabs(p.x) > 0.5 * tool.jaw_width + settings_.jaw_reach * radius) continue;
    if (std::fabs(p.y) > from_hinge * math::Tan(0.5 * jaw_before)) continue;
    const double opening = 2.0 * math::Asin(std::min(1.0, radius / from_hinge));
    // taken as both jaws touch it, or as they close
    const double at = std::max(opening, closed);
    if (jaw_before <= at || jaw > at || opening <= widest) continue;
    widest = opening;
    held = static_cast<std::int32_t>(i);
  }
  if (held < 0) return jaw;
  Stone& stone = stones_[static_cast<std::size_t>(held)];
  const Vec3 p = X_tool_world * stone.body.position;
  stone.place = StonePlace::kHeld;
  stone.opening = widest;
  stone.p_tool = {p.x, 0.0, p.z};  // the jaws centre it
  has_taken_[static_cast<std::size_t>(hand)] = true;
  return std::max(jaw, widest);
}

double GallstoneSpill::HeldDiameter(int hand) const noexcept {
  const std::int32_t held = HeldBy(hand);
  return held < 0 ? 0.0 : 2.0 * stones_[static_cast<std::size_t>(held)].body.radius;
}

bool GallstoneSpill::HasTaken(int hand) noexcept {
  return std::exchange(has_taken_[static_cast<std::size_t>(hand)], false);
}

int GallstoneSpill::Aspirate(const Vec3& p_world_tip, double bore) noexcept {
  int count = 0;
  for (Stone& stone : stones_) {
    const double radius = stone.body.radius;
    if (stone.place != StonePlace::kSpilled || 2.0 * radius > bore) continue;
    if (math::Distance(stone.body.position, p_world_tip) > radius + settings_.suction_reach) continue;
    stone.place = StonePlace::kAspirated;
    ++count;
  }
  return count;
}

int GallstoneSpill::CatchInBag(const Pose& X_world_bag) noexcept {
  const Pose X_bag_world = math::Inverse(X_world_bag);
  constexpr double kRadius = 0.5 * instrument::kBagMouth;
  int count = 0;
  for (Stone& stone : stones_) {
    if (stone.place != StonePlace::kSpilled || stone.body.IsLying()) continue;
    // the ring lies ahead of the tool's tip, the pouch hangs below it
    const Vec3 p = X_bag_world * stone.body.position;
    if (math::Hypot(p.x, p.z + kRadius) > kRadius || p.y > 0.0 || p.y < -instrument::kBagDepth) continue;
    stone.place = StonePlace::kInBag;
    ++count;
  }
  return count;
}

int GallstoneSpill::TakeOut(int hand) noexcept {
  std::int32_t& held = held_[static_cast<std::size_t>(hand)];
  if (held < 0) return 0;
  stones_[static_cast<std::size_t>(held)].place = StonePlace::kTakenOut;
  held = -1;
  return 1;
}

int GallstoneSpill::BagWith(std::int32_t organ) noexcept {
  int count = 0;
  for (Stone& stone : stones_) {
    if (stone.place != StonePlace::kSpilled || stone.body.support != organ) continue;
    stone.place = StonePlace::kInBag;
    ++count;
  }
  return count;
}

StoneCount GallstoneSpill::Count() const noexcept {
  StoneCount count;
  count.all = static_cast<int>(stones_.size());
  for (const Stone& stone : stones_) {
    switch (stone.place) {
      case StonePlace::kInside:
        ++count.inside;
        break;
      case StonePlace::kSpilled:
      case StonePlace::kHeld:
        ++count.spilled;
        break;
      case StonePlace::kInBag:
        ++count.in_bag;
        break;
      case StonePlace::kAspirated:
        ++count.aspirated;
        break;
      case StonePlace::kTakenOut:
        ++count.taken_out;
        break;
    }
  }
  return count;
}

void GallstoneSpill::Publish(std::span<StoneSnapshot> stones) const noexcept {
  TROCAR_ASSERT(stones.size() >= stones_.size());
  for (std::size_t i = 0; i < stones_.size(); ++i) {
    const Stone& stone = stones_[i];
    StoneSnapshot& shown = stones[i];
    shown = {stone.body.position, stone.body.radius, stone.place, -1};
    for (int hand = 0; hand < instrument::kHandCount; ++hand) {
      if (HeldBy(hand) == static_cast<std::int32_t>(i)) shown.hand = hand;
    }
  }
}

void GallstoneSpill::Stone::VisitState(base::StateArchive& archive) {
  archive.Field("body", body);
  archive.Field("place", place);
  archive.Field("opening", opening);
  archive.Field("p_tool", p_tool);
}

void GallstoneSpill::VisitState(base::StateArchive& archive) {
  archive.FixedField("stones", stones_);
  archive.Field("held", held_);
  archive.Field("has_taken", has_taken_);
  archive.Field("carried", carried_);
  const auto is_stone = [&](std::int32_t i) {
    return i >= -1 && i < static_cast<std::int32_t>(stones_.size());
  };
  if (archive.IsRestoring() && !std::all_of(held_.begin(), held_.end(), is_stone)) {
    held_ = {-1, -1};
    archive.Fail("are held that there are not");
  }
}

}  // namespace trocar::surgery
