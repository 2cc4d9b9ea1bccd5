// SPDX-License-Identifier: Apache-2.0
/// \file topology.h  The one owner of what is joined to what: nodes and springs as surgery has left them.
///
/// Users of nodes and springs (solver, volumes, contacts, ...) register once. They are notified in the same way after a cut,
/// after a state was restored and after a surgery began again.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/surgery/topology_change.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::simulation {

/// The springs of organs' walls: what tears in them, and how large a hole it leaves.
struct WallSprings {
  std::vector<std::int32_t> organs;  ///< (springs) organ whose wall each is part of, or -1
  std::vector<double> areas;         ///< (springs) part of that organ's surface [m^2]
};

class Topology {
 public:
  /// Notification of a user that it goes on with the changed system. Only where `is_restored` it has to forget the former
  /// system: then anything may be different, and its own state is restored afterwards.
  using Update = std::function<void(const Topology& topology, bool is_restored)>;

  Topology() = default;
  /// \param uncut  the system before any cut, its spare nodes included
  Topology(tissue::TissueDefinition uncut, WallSprings walls);

  const tissue::TissueDefinition& Definition() const { return definition_; }
  const tissue::TissueModel& Model() const { return model_; }  ///< stays where it is as long as this does
  const WallSprings& Walls() const { return walls_; }
  /// Cuts since the start that changed nodes or springs; 0: uncut.
  std::uint32_t Version() const { return version_; }

  void Register(Update update) { updates_.push_back(std::move(update)); }

  /// Takes a cut into model and state, and notifies all that registered, in their order.
  /// \note Not real-time safe: allocates.
  void Cut(const surgery::TopologyChange& change, tissue::TissueState& state);

  /// Version, nodes, springs and walls. What is registered has to be notified by Restored() once meshes and lines have been
  /// restored, too.
  void VisitState(base::StateArchive& archive);
  /// After restoring: makes the model and notifies all that registered, unless all is as it was.
  void Restored();

 private:
  void MakeModel();

  tissue::TissueDefinition definition_;
  tissue::TissueModel model_;
  WallSprings walls_;
  std::uint32_t version_ = 0;
  std::uint64_t history_ = 0;  // fingerprint of all cuts so far
  bool is_other_ = false;      // restored, and not yet notified
  std::vector<Update> updates_;
};

}  // namespace trocar::simulation
