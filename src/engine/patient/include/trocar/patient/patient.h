// SPDX-License-Identifier: Apache-2.0
/// \file patient.h  A patient: organs, named regions, bed attachments, ducts and vessels, landmarks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/geometry/tube.h"
#include "trocar/roles/roles.h"

namespace trocar::patient {

/// Names are for files and persons; programs ask for roles. A file may state a role; otherwise it is that of a
/// conventional name.

/// Vertices of one organ that share a role, for example "diaphragmatic_face".
struct Region {
  std::string name;
  std::vector<std::uint32_t> vertices;  ///< ascending
  roles::RegionRole role = roles::ConventionalRole<roles::RegionRole>(name);

  friend bool operator==(const Region&, const Region&) = default;
};

/// One closed organ.
struct Organ {
  std::string name;             ///< "liver", "gallbladder"
  geometry::TriangleMesh mesh;  ///< closed, manifold, outward; world frame [m]
  std::vector<Region> regions;
  roles::OrganRole role = roles::ConventionalRole<roles::OrganRole>(name);

  /// The region of that role, or null.
  const Region* RegionOf(roles::RegionRole wanted) const;
};

/// Connective tissue between a vertex of one organ and a vertex of another; it can be dissected.
struct Attachment {
  std::string name;  ///< "gallbladder_bed"
  std::uint32_t organ_a = 0, vertex_a = 0;
  std::uint32_t organ_b = 0, vertex_b = 0;

  friend bool operator==(const Attachment&, const Attachment&) = default;
};

enum class TubeKind { kDuct, kArtery };
/// "duct", "artery"
constexpr const char* KindName(TubeKind kind) noexcept {
  return roles::NameOf(kind == TubeKind::kArtery ? roles::TissueRole::kArtery : roles::TissueRole::kDuct);
}
constexpr std::optional<TubeKind> FindKind(std::string_view name) noexcept {
  for (const TubeKind kind : {TubeKind::kDuct, TubeKind::kArtery}) {
    if (name == KindName(kind)) return kind;
  }
  return std::nullopt;
}

/// Duct or vessel. `from` and `to` name an organ, another tube, or nothing where it leaves the scene.
struct Tube {
  std::string name;  ///< "cystic_duct"
  TubeKind kind = TubeKind::kDuct;
  std::string from, to;
  geometry::CentreLine line;  ///< world frame [m]
  bool is_seen = true;        ///< false: placed by landmarks because the images do not show it
  roles::TubeRole role = roles::ConventionalRole<roles::TubeRole>(name);

  friend bool operator==(const Tube&, const Tube&) = default;
};

struct Landmark {
  std::string name;     ///< "umbilicus", "fundus", "infundibulum"
  math::Vec3 position;  ///< world frame [m]
  roles::LandmarkRole role = roles::ConventionalRole<roles::LandmarkRole>(name);

  friend bool operator==(const Landmark&, const Landmark&) = default;
};

/// One named finding about the patient: what was drawn, set or measured. Not all of them are geometry.
struct Parameter {
  std::string name;                         ///< "cystic_duct_length"
  std::variant<double, std::string> value;  ///< a finite number in `unit`, or a word
  std::string unit;                         ///< "mm", "mL", "kPa"; "" for shares and words
  std::string source;                       ///< publication, "set by the user", "measured on the mesh"

  friend bool operator==(const Parameter&, const Parameter&) = default;
};

/// Structure beside the operated organs. It is seen, keeps tools out and gives way a little, but is not simulated.
struct Neighbour {
  std::string name;             ///< "stomach"
  geometry::TriangleMesh mesh;  ///< closed, manifold, outward, of one part or several; world frame [m]
  bool is_seen = true;          ///< false: a template placed by landmarks because the images do not show it
  roles::NeighbourRole role = roles::ConventionalRole<roles::NeighbourRole>(name);
};

/// Use of a port: for the laparoscope, a hand of the surgeon, or the assistant.
enum class PortUse : std::uint8_t { kLaparoscope, kLeftHand, kRightHand, kAssistant };
inline constexpr std::size_t kPortUseCount = 4;
/// "laparoscope", "left_hand", "right_hand", "assistant": as files write it.
const char* NameOf(PortUse use) noexcept;
/// The use of that name; nothing for an unknown one.
std::optional<PortUse> FindPortUse(std::string_view name) noexcept;

/// Where an instrument passes this patient's insufflated wall, in place of what a scene says.
struct Port {
  PortUse use = PortUse::kLaparoscope;
  math::Vec3 position;  ///< world frame [m]
  std::string reason;   ///< a sentence: why there

  friend bool operator==(const Port&, const Port&) = default;
};

/// How the table is tilted for this patient, in place of what a scene says.
struct Table {
  double head_up = 0, right_up = 0;  ///< -30 to 30 degrees [rad]
  std::string reason;                ///< a sentence: why so

  friend bool operator==(const Table&, const Table&) = default;
};

/// Label of the segmentation that a patient was made from, with the structure that it was taken for.
struct SourceLabel {
  int label = 0;
  std::string meaning;  ///< "gallbladder", "kidney_right"
  std::string reason;   ///< a clause: why
  std::string doubt;    ///< a clause: what speaks against it; empty: nothing

  friend bool operator==(const SourceLabel&, const SourceLabel&) = default;
};

/// The first whose role one before it has, or null. The same name twice is another mistake, and no such one.
template <class Thing>
const Thing* FindSecondOfRole(const std::vector<Thing>& things) {
  for (std::size_t i = 0; i < things.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (things[i].role != decltype(Thing::role)::kOther && things[i].role == things[j].role &&
          things[i].name != things[j].name)
        return &things[i];
    }
  }
  return nullptr;
}

/// An organ that lies in the bed of another; indices of Patient::organs, -1 where the patient has none.
struct PatientBed {
  int organ = -1, host = -1;

  bool IsWhole() const { return organ >= 0 && host >= 0; }
  friend bool operator==(const PatientBed&, const PatientBed&) = default;
};

/// World frame: metres, x to the patient's left, y cranial, z anterior; origin at the umbilicus on the
/// insufflated wall.
struct Patient {
  std::string name;
  std::string provenance;  ///< where it comes from, with credit
  std::vector<Organ> organs;
  std::vector<Attachment> attachments;
  std::vector<Tube> tubes;
  std::vector<Landmark> landmarks;
  std::vector<Parameter> parameters;  ///< none for a patient built from photographs
  std::vector<Neighbour> neighbours;  ///< none: a picture shows the usual abdomen, which nothing touches
  std::vector<Port> ports;            ///< one of each use at most; a scene's own where there is none
  std::optional<Table> table;         ///< a scene's own where there is none
  std::vector<SourceLabel> labels;    ///< none for a patient that was not made of a label map

  /// Index of the organ of that role, or -1.
  int OrganOf(roles::OrganRole role) const;
  /// Organs in their beds: those that anatomy knows (roles::kOrganBeds), then what else is attached to another organ. Of the known
  /// ones one organ may be missing.
  std::vector<PatientBed> ListBeds() const;
  /// Index of the first hollow organ, or -1.
  int HollowOrgan() const;
  /// Index of the first duct or artery of that role, or -1.
  int TubeOf(roles::TubeRole role) const;
  /// The role of the organ at that index; kOther beyond the organs, where tubes are.
  roles::OrganRole RoleOfOrgan(int organ) const;
  /// The landmark of that role, or null.
  const Landmark* LandmarkOf(roles::LandmarkRole role) const;

  // what a file or a person names

  /// Index of the organ of that name, or -1.
  int FindOrgan(std::string_view organ_name) const;
  /// Index of the duct or artery of that name, or -1.
  int FindTube(std::string_view tube_name) const;
  /// Index of the organ or tube of that name, tubes after organs, or -1: what a tube's end joins.
  int FindPart(std::string_view part_name) const;
  /// The role of the organ of that name; kOther where there is none.
  roles::OrganRole FindOrganRole(std::string_view organ_name) const {
    return RoleOfOrgan(FindOrgan(organ_name));
  }
  /// The landmark of that name, else the one whose role is called so; null where there is none.
  const Landmark* FindLandmark(std::string_view landmark_name) const;
  const Parameter* FindParameter(std::string_view parameter_name) const;
  /// The neighbour of that role, or null.
  const Neighbour* NeighbourOf(roles::NeighbourRole role) const;
  const Port* PortOf(PortUse use) const;
};

/// Names in a patient become names of files, so that they are plain words: a-z, 0-9 and _, at most 64.
bool IsPlainName(std::string_view name) noexcept;

/// Names of the paper's four boundary rules (section 3.2.2).
inline constexpr const char* kDiaphragmaticFace = roles::NameOf(roles::RegionRole::kDiaphragmaticFace);
inline constexpr const char* kFalciform = roles::NameOf(roles::RegionRole::kFalciform);
inline constexpr const char* kCoronary = roles::NameOf(roles::RegionRole::kCoronary);
inline constexpr const char* kGallbladderBed = roles::NameOf(roles::RegionRole::kGallbladderBed);

/// Closed, manifold, outward organs and neighbours; at most one of each role, and so with landmarks, ports and an organ's
/// regions; regions and attachments in range; tubes finite with positive radii; names of parameters unique and their numbers finite.
base::Status CheckPatient(const Patient& patient);

}  // namespace trocar::patient
