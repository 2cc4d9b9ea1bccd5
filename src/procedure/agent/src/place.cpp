// SPDX-License-Identifier: Apache-2.0
#include "place.h"

#include <utility>

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

Place Place::BetweenJaws(std::size_t tube, double arc, double jaw_length) {
  Place place = OnTube(tube, arc);
  place.kind = Kind::kBetweenJaws;
  place.back = jaw_length;
  return place;
}

Place Place::MiddleOf(std::vector<std::uint32_t> strands) {
  Place place = Of(Kind::kStrands);
  place.strands = std::move(strands);
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

}  // namespace trocar::agent
