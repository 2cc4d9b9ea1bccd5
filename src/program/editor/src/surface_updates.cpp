// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/surface_updates.h"

#include <utility>

namespace trocar::editor {

SurfaceUpdates::Change SurfaceUpdates::Request(bool is_all) {
  Change change;
  const auto& document = workspace_.Document();
  const auto& structures = document.Points().structures;
  // organs that came or went change all indices
  change.is_everything_new = is_all || structures.size() != meshed_.size();
  if (change.is_everything_new) {
    job_.Cancel();
    meshed_.assign(structures.size(), {});
  }
  for (int s = 0; s < static_cast<int>(structures.size()); ++s) {
    auto request = workspace_.MakeMeshRequest(s);
    contours::Structure& before = meshed_[static_cast<std::size_t>(s)];
    const contours::Structure& now = request.content;
    const bool is_same =
        before.slices == now.slices && before.adaption == now.adaption && before.name == now.name;
    if (is_same && !change.is_everything_new) continue;
    before = now;
    if (document.ContouredSlices(s).empty()) {
      change.without.push_back(s);
    } else {
      job_.Request(std::move(request));
    }
  }
  return change;
}

}  // namespace trocar::editor
