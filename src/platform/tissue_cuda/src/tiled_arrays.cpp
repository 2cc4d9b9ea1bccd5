// SPDX-License-Identifier: Apache-2.0
#include "tiled_arrays.h"

#include <algorithm>
#include <string>

#include "tile_order.h"

namespace trocar::tissue_cuda {

using math::Vec3;
using tissue::TissueModel;

namespace {

constexpr std::uint32_t kSlicesPerTile = kTileNodes / kSliceNodes;
constexpr std::uint32_t kMaxLocals = 0xffff;

std::uint32_t CountSprings(const TissueModel& model, std::uint32_t model_index) {
  if (model_index == kNoNode) return 0;
  return model.spring_starts[model_index + 1] - model.spring_starts[model_index];
}

/// Numbers the nodes; within a tile those with many springs come first, so that slices are evenly filled.
template <typename Real>
void NumberNodes(const TissueModel& model, TiledArrays<Real>& arrays) {
  arrays.model_index = CalcTileOrder(model.rest, kTileNodes);
  arrays.model_index.resize(static_cast<std::size_t>(arrays.tiles) * kTileNodes, kNoNode);
  for (auto first = arrays.model_index.begin(); first != arrays.model_index.end(); first += kTileNodes) {
    std::stable_sort(first, first + kTileNodes, [&](std::uint32_t a, std::uint32_t b) {
      if ((a == kNoNode) != (b == kNoNode)) return b == kNoNode;
      return CountSprings(model, a) > CountSprings(model, b);
    });
  }
  arrays.renumbered.resize(arrays.nodes);
  for (std::uint32_t place = 0; place < arrays.model_index.size(); ++place) {
    if (arrays.model_index[place] != kNoNode) arrays.renumbered[arrays.model_index[place]] = place;
  }
}

template <typename Real>
void FillNodes(const TissueModel& model, TiledArrays<Real>& arrays) {
  for (const std::uint32_t i : arrays.model_index) {
    const bool is_node = i != kNoNode;
    const Vec3 rest = is_node ? model.rest[i] : Vec3{};
    arrays.rest.push_back({rest.x, rest.y, rest.z});
    arrays.mass.push_back(is_node ? model.mass[i] : 0.0);
    arrays.shape_stiffness.push_back(is_node ? static_cast<Real>(model.shape_stiffness[i]) : Real(0));
  }
}

/// Nodes of other tiles that the springs of a tile reach, ascending.
template <typename Real>
std::vector<std::uint32_t> FindBorder(const TissueModel& model, const TiledArrays<Real>& arrays,
                                      std::uint32_t tile) {
  std::vector<std::uint32_t> border;
  for (std::uint32_t place = tile * kTileNodes; place < (tile + 1) * kTileNodes; ++place) {
    const std::uint32_t i = arrays.model_index[place];
    if (i == kNoNode) continue;
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const std::uint32_t other = arrays.renumbered[model.half_springs[h].other];
      if (other / kTileNodes != tile) border.push_back(other);
    }
  }
  std::sort(border.begin(), border.end());
  border.erase(std::unique(border.begin(), border.end()), border.end());
  return border;
}

/// The springs of one slice, step by step, padded at their own node with no stiffness.
template <typename Real>
void AppendSlice(const TissueModel& model, std::uint32_t slice, const std::vector<std::uint32_t>& border,
                 TiledArrays<Real>& arrays) {
  const std::uint32_t first = slice * kSliceNodes, tile = first / kTileNodes;
  std::uint32_t longest = 0;
  for (std::uint32_t lane = 0; lane < kSliceNodes; ++lane) {
    longest = std::max(longest, CountSprings(model, arrays.model_index[first + lane]));
  }
  for (std::uint32_t step = 0; step < longest; ++step) {
    for (std::uint32_t lane = 0; lane < kSliceNodes; ++lane) {
      const std::uint32_t place = first + lane, i = arrays.model_index[place];
      if (step >= CountSprings(model, i)) {
        arrays.link_vectors.push_back({});
        arrays.link_rests.push_back({});
        arrays.link_others.push_back(place);
        arrays.link_locals.push_back(static_cast<std::uint16_t>(place % kTileNodes));
        continue;
      }
      const auto& half = model.half_springs[model.spring_starts[i] + step];
      const Vec3 vector = model.rest[half.other] - model.rest[i];
      const double excess = math::SquaredNorm(vector) - half.rest_length * half.rest_length;
      arrays.link_vectors.push_back({static_cast<Real>(vector.x), static_cast<Real>(vector.y),
                                     static_cast<Real>(vector.z), static_cast<Real>(half.stiffness)});
      arrays.link_rests.push_back({static_cast<Real>(half.rest_length), static_cast<Real>(excess)});
      const std::uint32_t other = arrays.renumbered[half.other];
      arrays.link_others.push_back(other);
      const auto local =
          other / kTileNodes == tile
              ? other % kTileNodes
              : kTileNodes + static_cast<std::uint32_t>(
                                 std::lower_bound(border.begin(), border.end(), other) - border.begin());
      arrays.link_locals.push_back(static_cast<std::uint16_t>(local));
    }
  }
  arrays.slice_starts.push_back(static_cast<std::uint32_t>(arrays.link_others.size()));
}

template <typename Real>
void FillStrands(const TissueModel& model, TiledArrays<Real>& arrays) {
  if (model.strand_count == 0) return;
  arrays.strand_starts.push_back(0);
  for (const std::uint32_t i : arrays.model_index) {
    if (i != kNoNode) {
      for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
        const auto& half = model.half_strands[h];
        arrays.strands.push_back({arrays.renumbered[half.other], half.strand, half.stiffness});
      }
    }
    arrays.strand_starts.push_back(static_cast<std::uint32_t>(arrays.strands.size()));
  }
}

}  // namespace

template <typename Real>
base::Result<TiledArrays<Real>> MakeTiledArrays(const TissueModel& model) {
  const auto refuse = [](const std::string& why) {
    return base::Error{base::ErrorCode::kGpuLayout, "the layout \"tiled\" " + why};
  };
  if (model.Size() == 0) return refuse("needs at least one node");
  TiledArrays<Real> arrays;
  arrays.nodes = static_cast<std::uint32_t>(model.Size());
  arrays.tiles = (arrays.nodes + kTileNodes - 1) / kTileNodes;
  NumberNodes(model, arrays);
  FillNodes(model, arrays);
  arrays.slice_starts.push_back(0);
  arrays.border_starts.push_back(0);
  for (std::uint32_t tile = 0; tile < arrays.tiles; ++tile) {
    const std::vector<std::uint32_t> border = FindBorder(model, arrays, tile);
    if (kTileNodes + border.size() > kMaxLocals) {
      return refuse("cannot hold a tile of 256 nodes with springs to " + std::to_string(border.size()) +
                    " others; use \"coalesced\"");
    }
    const auto first_link = static_cast<std::uint32_t>(arrays.link_others.size());
    for (std::uint32_t slice = 0; slice < kSlicesPerTile; ++slice) {
      AppendSlice(model, tile * kSlicesPerTile + slice, border, arrays);
    }
    arrays.max_links =
        std::max(arrays.max_links, static_cast<std::uint32_t>(arrays.link_others.size()) - first_link);
    arrays.max_border = std::max(arrays.max_border, static_cast<std::uint32_t>(border.size()));
    arrays.borders.insert(arrays.borders.end(), border.begin(), border.end());
    arrays.border_starts.push_back(static_cast<std::uint32_t>(arrays.borders.size()));
  }
  FillStrands(model, arrays);
  return arrays;
}

void FillContacts(std::span<const std::uint32_t> renumbered, const TissueModel& model,
                  std::span<const tissue::ContactSpring> contacts, TiledContacts& result) {
  result.contacts.clear();
  result.touched_nodes.clear();
  for (const tissue::ContactSpring& contact : contacts) {
    ContactEntry entry{};
    entry.rest_depth = contact.offset;
    entry.stiffness = contact.stiffness;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t node = contact.nodes[c];
      entry.nodes[c] = renumbered[node];
      entry.weights[c] = contact.weights[c];
      entry.normal[c] = contact.normal[c];
      entry.rest_depth -= contact.weights[c] * math::Dot(contact.normal, model.rest[node]);
      result.touched_nodes.push_back(entry.nodes[c]);
    }
    result.contacts.push_back(entry);
  }
  auto& touched = result.touched_nodes;
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());

  // corners by node, in the order of the contacts
  result.touch_starts.assign(touched.size() + 1, 0);
  const auto place = [&](std::uint32_t node) {
    return static_cast<std::size_t>(std::lower_bound(touched.begin(), touched.end(), node) - touched.begin());
  };
  for (const ContactEntry& entry : result.contacts) {
    for (const std::uint32_t node : entry.nodes) ++result.touch_starts[place(node) + 1];
  }
  for (std::size_t i = 0; i < touched.size(); ++i) result.touch_starts[i + 1] += result.touch_starts[i];
  result.touch_entries.resize(3 * result.contacts.size());
  for (std::uint32_t c = static_cast<std::uint32_t>(result.contacts.size()); c > 0; --c) {
    for (std::uint32_t corner = 3; corner > 0; --corner) {
      // filled from the back, so that each start ends where it began
      auto& end = result.touch_starts[place(result.contacts[c - 1].nodes[corner - 1]) + 1];
      result.touch_entries[--end] = 4 * (c - 1) + (corner - 1);
    }
  }
  // every end has walked down to its start: move them up again
  for (std::size_t i = 0; i + 1 < result.touch_starts.size(); ++i)
    result.touch_starts[i] = result.touch_starts[i + 1];
  if (!touched.empty()) result.touch_starts.back() = static_cast<std::uint32_t>(result.touch_entries.size());
}

template base::Result<TiledArrays<float>> MakeTiledArrays(const TissueModel&);
template base::Result<TiledArrays<double>> MakeTiledArrays(const TissueModel&);

}  // namespace trocar::tissue_cuda
