// SPDX-License-Identifier: Apache-2.0
/// \file procedure.h  Procedure: what an operation is about, as tables and a judge that the scene brings along.
///
/// The engine knows no procedure. It asks the tables which organ is taken out of which bed, and calls the judge at two places of the
/// tick (docs/step.md): after tools and heat, and at the end. docs/procedures.md shows how one is written.
#pragma once

#include <any>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/roles/roles.h"
#include "trocar/scene/procedure_snapshot.h"
#include "trocar/surgery/error_log.h"
#include "trocar/surgery/observation.h"
#include "trocar/surgery/surgery_snapshot.h"
#include "trocar/surgery/vessels.h"

namespace trocar::scene {

struct PatientTissue;
struct Scene;
struct VesselAnatomy;

/// Phase of a procedure.
struct PhaseRow {
  std::string_view name;   ///< in files and data sets: "ClippingCutting"
  std::string_view about;  ///< for a person: "Clipping and cutting"
};

/// Quantity that says how far a procedure has come.
struct MeasureRow {
  std::string_view name;        ///< in outcomes: "cleared_share"
  std::string_view short_name;  ///< to learners and in Python: "cleared"
  bool is_share = false;        ///< 0 not begun to 1 done; else a count
};

/// Moment up to which a part of a procedure is trained, in their order; reached ones are never taken back.
struct PartRow {
  std::string_view name;   ///< in files: "divided"
  std::string_view until;  ///< for a surgeon: "until the critical view of safety stands"
  /// \param retrieval  of the same tick
  bool (*is_reached)(const ProcedureSnapshot& now,
                     const surgery::RetrievalObservation& retrieval) noexcept = nullptr;
};

/// Finding at the end of an operation: what an injury is called, or whether there is a consequence.
struct Finding {
  std::string_view name;                       ///< in files: "strasberg"
  std::variant<bool, std::string_view> value;  ///< a text is of the procedure's own classes
  bool is_harm = false;                        ///< to what must stay: no bail-out makes it good
};

/// What is judged of an operation, now and at its end.
struct ProcedureResult {
  surgery::ErrorLog errors;
  ProcedureSnapshot now;
  bool was_view_achieved = false;    ///< at some time before
  std::vector<std::string> missing;  ///< what the view lacks, a sentence each; empty when achieved
  std::vector<Finding> findings;
  std::any detail;  ///< more of it, in the procedure's own words: see its headers
};

/// The patient as a judge has to know it; refers to what outlives the judge.
struct OperatedPatient {
  const Scene& scene;
  const PatientTissue& tissue;  ///< at rest
  const surgery::VesselMap& vessels;
  const VesselAnatomy& anatomy;  ///< of the vessels
};

/// Judge of an operation. It only looks: a tick without it leaves the same world.
class ProcedureJudge {
 public:
  virtual ~ProcedureJudge() = default;

  /// First in a tick, once tools and heat have done their part: judges the facts so far by the tissue in which they came about.
  /// \note Real-time safe.
  virtual void SeeTools(const surgery::OperationObservation& now) noexcept = 0;
  /// Then at its end: the facts since, hands, progress, view and phase.
  /// \note Real-time safe.
  virtual void Update(const surgery::OperationObservation& now) noexcept = 0;
  /// Errors of the last tick.
  virtual std::span<const surgery::ErrorEntry> NewErrors() const noexcept = 0;
  virtual const surgery::ErrorLog& Errors() const noexcept = 0;
  /// \param[in,out] snapshot  of the tables' sizes (SizeSnapshot)
  /// \note Real-time safe.
  virtual void Publish(ProcedureSnapshot& snapshot) const noexcept = 0;
  /// \param stones  as they lie now
  /// \note Allocates.
  virtual ProcedureResult CalcResult(const surgery::Vessels& vessels,
                                     const surgery::StoneCount& stones) const = 0;
  virtual void VisitState(base::StateArchive& archive) = 0;
};

/// Role of a part of the body that a procedure brings along, as patient files write it: numbers from roles::kFirstOwnRole on.
template <class Role>
struct OwnRole {
  Role role;
  const char* name;
};

/// Constant tables of a procedure; one object of static storage for each. States, recordings and snapshots hold numbers of rows: a new
/// row stands at a table's end.
struct Procedure {
  std::string_view name;  ///< in scene files
  /// Its part in a scene's fingerprint; empty of those whose scenes had fingerprints before they named a procedure.
  std::string_view fingerprint;

  /// Organ that is taken out: hollow, leaks where it is opened, leaves in a bag. None: nothing is taken out.
  std::optional<roles::OrganRole> organ;
  std::string_view organ_name;           ///< of it, to learners: what a state of environments calls it
  std::optional<roles::OrganRole> host;  ///< in whose bed it lies, and which bleeds where it is torn off
  /// Ends of that organ: where its tubes leave it, and the other one.
  std::optional<roles::LandmarkRole> neck, tip;

  std::span<const OwnRole<roles::OrganRole>> organ_roles;  ///< beyond those that every procedure knows
  std::span<const OwnRole<roles::TubeRole>> tube_roles;
  std::span<const OwnRole<roles::LandmarkRole>> landmark_roles;

  std::span<const roles::TubeRole>
      divided;  ///< ducts and arteries that may be divided; every other one must stay

  std::span<const PhaseRow> phases;
  std::span<const MeasureRow> measures;
  std::span<const std::string_view> criteria, sights;  ///< of the view; none: no view is asked for
  std::span<const surgery::ErrorRow> errors;
  std::span<const PartRow> parts;  ///< the first is the start, and always reached

  /// \param patient  whose tissue and scene outlive the judge
  std::unique_ptr<ProcedureJudge> (*make_judge)(const OperatedPatient& patient) = nullptr;
};

/// Row of the measure of that name or short name.
std::optional<std::size_t> FindMeasure(const Procedure& procedure, std::string_view name) noexcept;
/// 0 where the procedure has no such measure, or there is none.
double MeasureOf(const Procedure* procedure, const ProcedureSnapshot& now, std::string_view name) noexcept;
/// False where there is no procedure: what nothing is known of must stay.
bool MayBeDivided(const Procedure* procedure, roles::TubeRole tube) noexcept;
/// "" where there is no procedure, or no such phase.
std::string_view PhaseName(const Procedure* procedure, std::uint8_t phase) noexcept;
/// Null where there is no procedure, or no such row.
const surgery::ErrorRow* FindError(const Procedure* procedure, int row) noexcept;
/// The row of that name.
std::optional<surgery::ErrorId> FindError(const Procedure& procedure, std::string_view name) noexcept;

/// Makes a snapshot as large as the tables are.
void SizeSnapshot(const Procedure& procedure, ProcedureSnapshot& snapshot);

/// Of a scene; null where it is no operation, or nobody judges it.
const Procedure* ProcedureOf(const Scene& scene) noexcept;

}  // namespace trocar::scene
