// SPDX-License-Identifier: Apache-2.0
#include "operation_plan.h"

#include "state_fields.h"

namespace trocar::agent {

Place Place::At(const math::Vec3& p) {
  Place place = Of(Kind::kPoint);
  place.p = p;
  return place;
}

Place Place::AtNode(std::uint32_t node) {
  Place place = Of(Kind::kNode);
  place.node = node;
  return place;
}

Place Place::OnTube(std::size_t tube, double share) {
  Place place = Of(Kind::kTube);
  place.tube = tube;
  place.share = share;
  return place;
}

Place Place::Aim(std::size_t tube, double share, double back) {
  Place place = OnTube(tube, share);
  place.kind = Kind::kAim;
  place.back = back;
  return place;
}

Place Place::BehindTip(int hand, double back) {
  Place place = Of(Kind::kBehindTip);
  place.hand = hand;
  place.back = back;
  return place;
}

Place Place::Of(Kind kind) {
  Place place;
  place.kind = kind;
  return place;
}

Place Place::ForHook() const {
  Place place = *this;
  place.is_for_hook = true;
  return place;
}

void Place::VisitState(base::StateArchive& archive) {
  archive.Field("kind", kind);
  archive.Field("hand", hand);
  archive.Field("is_for_hook", is_for_hook);
  archive.Field("node", node);
  archive.Field("tube", tube);
  archive.Field("share", share);
  archive.Field("back", back);
  archive.Field("p", p);
  archive.Field("strands", strands);
}

void HoldFilter::VisitState(base::StateArchive& archive) {
  archive.Field("kind", kind);
  archive.Field("peels", peels);
}

void SurgeonAct::VisitState(base::StateArchive& archive) {
  archive.Field("kind", kind);
  archive.Field("doing", doing);
  archive.Field("time_limit", time_limit);
  archive.Field("hand", hand);
  archive.Field("place", place);
  archive.Field("hurry", hurry);
  archive.Field("seconds", seconds);
  archive.Field("share", share);
  archive.Field("amount", amount);
  archive.Field("distance", distance);
  archive.Field("by", by);
  archive.Field("count", count);
  archive.Field("side", side);
  archive.Field("node", node);
  archive.Field("tube", tube);
  archive.Field("tubes", tubes);
  archive.Field("strands", strands);
  archive.Field("may", may);
  archive.Field("is_on", is_on);
  archive.Field("tool", tool);
  archive.Field("tool_kind", tool_kind);
  archive.Field("command", command);
  archive.Field("camera", camera);
}

void Traction::VisitState(base::StateArchive& archive) {
  archive.Field("most", most);
  archive.Field("most_pull", most_pull);
  archive.Field("enough_pull", enough_pull);
  archive.Field("ways", ways);
  archive.Field("way", way);
  archive.Field("p_hold", p_hold);
  archive.Field("drawn", drawn);
  archive.Field("is_swinging", is_swinging);
  archive.Field("swings_left", swings_left);
  archive.Field("seconds", seconds);
  archive.Field("fibres_before", fibres_before);
}

void HookTarget::VisitState(base::StateArchive& archive) {
  archive.Field("fibre", fibre);
  archive.Field("spin", spin);
  VisitQueue(archive, "path", path);
  archive.Field("aside", aside);
  archive.Field("seconds", seconds);
  archive.Field("apart", apart);
  archive.Field("heated", heated);
}

void DissectionGoal::VisitState(base::StateArchive& archive) {
  archive.Field("what", what);
  archive.Field("strands", strands);
  archive.Field("order", order);
  archive.Field("enough", enough);
  archive.Field("until", until);
  archive.Field("traction", traction);
  archive.Field("way", way);
  archive.Field("may", may);
  archive.Field("left_before", left_before);
}

void Dissection::VisitState(base::StateArchive& archive) {
  archive.Field("goal", goal);
  archive.Field("attempts", attempts);
  archive.Field("left", left);
  archive.Field("parted_at_reset", parted_at_reset);
  archive.Field("target", target);
  archive.Field("traction", traction);
  archive.Field("waits", waits);
  archive.Field("is_bold", is_bold);
  archive.Field("backing_off", backing_off);
  archive.Field("holds_left", holds_left);
}

void Spreading::VisitState(base::StateArchive& archive) {
  archive.Field("strands", strands);
  archive.Field("weights", weights);
  archive.Field("is_sharp", is_sharp);
  archive.Field("tries", tries);
  archive.Field("stage", stage);
  archive.Field("pose_tip", pose.tip);
  archive.Field("pose_opening", pose.opening);
  archive.Field("pose_worth", pose.worth);
  archive.Field("left_before", left_before);
  archive.Field("aim", aim);
  archive.Field("fruitless", fruitless);
}

void Division::VisitState(base::StateArchive& archive) {
  archive.Field("tubes", tubes);
  archive.Field("avoid", avoid);
  archive.Field("acts_left", acts_left);
  archive.Field("care", care);
}

}  // namespace trocar::agent
