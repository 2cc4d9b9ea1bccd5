// SPDX-License-Identifier: Apache-2.0
/// \file patient.h  A patient: organs, named regions, bed attachments, ducts and vessels, landmarks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trocar/core/result.h"
#include "trocar/geometry/triangle_mesh.h"
#include "trocar/geometry/tube.h"

namespace trocar::anatomy {

using math::Vec3;

/// Vertices of one organ that share a role, for example "diaphragmatic_face".
struct Region {
  std::string name;
  std::vector<std::uint32_t> vertices;  ///< ascending

  friend bool operator==(const Region&, const Region&) = default;
};

/// One closed organ.
struct Organ {
  std::string name;             ///< "liver", "gallbladder"
  geometry::TriangleMesh mesh;  ///< closed, manifold, outward; world frame [m]
  std::vector<Region> regions;
};

/// Connective tissue between a vertex of one organ and a vertex of another; it can be dissected.
struct Attachment {
  std::string name;  ///< "gallbladder_bed"
  std::uint32_t organ_a = 0, vertex_a = 0;
  std::uint32_t organ_b = 0, vertex_b = 0;

  friend bool operator==(const Attachment&, const Attachment&) = default;
};

enum class TubeKind { kDuct, kArtery };

/// Duct or vessel. `from` and `to` name an organ, another tube, or nothing where it leaves the scene.
struct Tube {
  std::string name;  ///< "cystic_duct"
  TubeKind kind = TubeKind::kDuct;
  std::string from, to;
  geometry::CentreLine line;  ///< world frame [m]
  bool is_seen = true;        ///< false: placed by landmarks because the images do not show it

  friend bool operator==(const Tube&, const Tube&) = default;
};

struct Landmark {
  std::string name;  ///< "umbilicus", "fundus", "infundibulum"
  Vec3 position;     ///< world frame [m]

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

  /// Index of the organ, or -1.
  int FindOrgan(std::string_view organ_name) const;
  const Landmark* FindLandmark(std::string_view landmark_name) const;
  const Parameter* FindParameter(std::string_view parameter_name) const;
};

/// Names of the paper's four boundary rules (section 3.2.2).
inline constexpr const char* kDiaphragmaticFace = "diaphragmatic_face";
inline constexpr const char* kFalciform = "falciform";
inline constexpr const char* kCoronary = "coronary";
inline constexpr const char* kGallbladderBed = "gallbladder_bed";

/// Reads a patient folder: patient.json and one PLY file an organ, in LPS millimetres; converted here, once,
/// to the world frame.
/// \return the file's error, or kPatientInvalid with what is inconsistent
core::Result<Patient> ReadPatient(const std::filesystem::path& folder);

/// A patient as its folder has it, right or wrong.
struct UncheckedPatient {
  Patient patient;                       ///< an organ whose mesh cannot be read has none
  std::vector<core::Error> mesh_errors;  ///< (organs) kNone where the mesh was read
};

/// Reads what ReadPatient reads without CheckPatient, for those who look for what is wrong.
/// \return an error only where patient.json itself cannot be read
core::Result<UncheckedPatient> ReadPatientUnchecked(const std::filesystem::path& folder);

/// Writes the folder that ReadPatient reads; nothing is left behind when it fails.
core::Status WritePatient(const std::filesystem::path& folder, const Patient& patient);

/// Closed, manifold, outward organs; regions and attachments in range; tubes finite with positive radii;
/// names of parameters unique and their numbers finite.
core::Status CheckPatient(const Patient& patient);

}  // namespace trocar::anatomy
