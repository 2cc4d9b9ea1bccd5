// SPDX-License-Identifier: Apache-2.0
#include "topology.h"

#include <utility>

#include "trocar/base/state_hash.h"
#include "trocar/geometry/editable_mesh.h"

namespace trocar::simulation {
namespace {

std::uint64_t HashChange(std::uint64_t before, const surgery::TopologyChange& change) {
  base::StateHash hash;
  hash.Add(before);
  for (const surgery::NodeChange& node : change.nodes) {
    hash.Add(std::uint64_t{node.node});
    for (const double value : {node.rest.x, node.rest.y, node.rest.z, node.mass, node.shape_stiffness})
      hash.Add(value);
  }
  for (const surgery::SpringChange& spring : change.springs) {
    hash.Add(std::uint64_t{spring.a}), hash.Add(std::uint64_t{spring.b}), hash.Add(std::uint64_t{spring.law});
    hash.Add(spring.stiffness), hash.Add(spring.rest_length);
  }
  for (const std::uint32_t strand : change.cut_strands) hash.Add(std::uint64_t{strand});
  return hash.Value();
}

}  // namespace

Topology::Topology(tissue::TissueDefinition uncut, WallSprings walls)
    : definition_(std::move(uncut)), walls_(std::move(walls)) {
  MakeModel();
}

void Topology::MakeModel() {
  model_ = tissue::MakeTissueModel(definition_);
}

void Topology::Cut(const surgery::TopologyChange& change, tissue::TissueState& state) {
  const std::vector<std::uint32_t> origins = surgery::ApplyChange(change, definition_);
  MakeModel();
  surgery::ApplyChange(change, origins, model_, state);
  // a spring that is new is of no wall: where it tears, a cut has opened the organ already
  WallSprings walls{std::vector<std::int32_t>(origins.size(), -1), std::vector<double>(origins.size(), 0.0)};
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (origins[i] == geometry::kNone) continue;
    walls.organs[i] = walls_.organs[origins[i]];
    walls.areas[i] = walls_.areas[origins[i]];
  }
  walls_ = std::move(walls);
  ++version_;
  history_ = HashChange(history_, change);
  for (const Update& update : updates_) update(*this, false);
}

void Topology::VisitState(base::StateArchive& archive) {
  const std::uint64_t history = history_;
  archive.Field("version", version_);
  archive.Field("history", history_);
  archive.Field("definition", definition_);
  archive.Field("wall_organs", walls_.organs);
  archive.Field("wall_areas", walls_.areas);
  if (!archive.IsRestoring()) return;
  is_other_ = is_other_ || history_ != history || !archive.ok();
  if (archive.ok() &&
      (walls_.organs.size() != definition_.springs.size() || walls_.areas.size() != walls_.organs.size()))
    archive.Fail("has walls of other springs");
}

void Topology::Restored() {
  if (!std::exchange(is_other_, false)) return;
  MakeModel();
  for (const Update& update : updates_) update(*this, true);
}

}  // namespace trocar::simulation
