// SPDX-License-Identifier: Apache-2.0
/// \file surgeon.h  Scripted surgeons: they act through Input alone and know only what Snapshot shows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/base/state_archive.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::agent {

/// A pair of hands with a mind. The same scene, seed and snapshots give the same inputs.
class Surgeon {
 public:
  virtual ~Surgeon() = default;
  /// Acts of hands, feet and the assistant in the next tick.
  /// \param seen  after the last tick
  virtual scene::Input Act(const simulation::Snapshot& seen) = 0;
  /// Nothing is left to do, or the surgeon has given up.
  virtual bool HasFinished() const = 0;
  /// Its memory: the plan, timers, random streams. Restored into a surgeon made from the same entry, scene and seed, it
  /// goes on as the one that was saved, from the snapshot that one would have seen next.
  virtual void VisitState(base::StateArchive& archive) = 0;
  /// For one who takes over: how the laparoscope lay at the start, from where sides are counted.
  virtual void KnowFirstView(const instrument::TrocarJoints& /*laparoscope*/) {}
  /// The work under way, for a person: "ring_3: hand over".
  virtual std::string_view Doing() const = 0;
  /// Phase of an operation that it means to be in, by its own plan and not by what is judged: a row of Procedure::phases. Nothing
  /// where it has no such plan.
  virtual std::optional<std::uint8_t> OwnPhase() const { return std::nullopt; }
  /// Why an operation was ended before its end because going on would not be safe; "" while it goes on, where it was
  /// finished, and where nobody meant to finish it.
  virtual std::string_view BailOutReason() const { return {}; }
};

/// One kind of surgeon. Several may have the same name when they suit different scenes.
struct SurgeonEntry {
  const char* name;   ///< "expert", "novice", "drops_object"
  const char* about;  ///< one line
  /// ErrorRule::name (or an operation's error) that this one commits; "" for the able ones.
  const char* error;
  bool (*suits)(const scene::Scene& scene);
  std::unique_ptr<Surgeon> (*make)(std::shared_ptr<const scene::Scene> scene, std::uint64_t seed);
};

/// Every kind there is.
std::vector<SurgeonEntry> ListSurgeons();

/// \return kUnknownName with those that suit the scene
base::Result<std::unique_ptr<Surgeon>> MakeSurgeon(std::string_view name,
                                                   std::shared_ptr<const scene::Scene> scene,
                                                   std::uint64_t seed);

}  // namespace trocar::agent
