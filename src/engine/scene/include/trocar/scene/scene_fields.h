// SPDX-License-Identifier: Apache-2.0
/// \file scene_fields.h  Every value of a scene that decides a state, a picture or a verdict.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>

#include "trocar/base/fields.h"
#include "trocar/scene/procedure.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {
namespace fields_detail {

// Fields for a person to read, and the place of a file. All other fields of all structs are visited, later additions, too.
template <typename T>
bool IsOnlyTold(const T& /*owner*/, const void* /*field*/) {
  return false;
}
inline bool IsOnlyTold(const Scene& owner, const void* field) {
  return field == &owner.patient_folder;
}
inline bool IsOnlyTold(const Task& owner, const void* field) {
  return field == &owner.name || field == &owner.about;
}
inline bool IsOnlyTold(const ErrorRule& owner, const void* field) {
  return field == &owner.about;
}
/// The patches are in the scene and in the parameters already.
inline bool IsOnlyTold(const OperationLevel& owner, const void* field) {
  return field == &owner.about || field == &owner.scene_patch || field == &owner.parameters_patch;
}
inline bool IsOnlyTold(const OrganMaterial& owner, const void* field) {
  return field == &owner.source;
}
inline bool IsOnlyTold(const patient::Patient& owner, const void* field) {
  return field == &owner.name || field == &owner.provenance || field == &owner.labels;
}
inline bool IsOnlyTold(const patient::Parameter& owner, const void* field) {
  return field == &owner.source;
}
inline bool IsOnlyTold(const patient::Port& owner, const void* field) {
  return field == &owner.reason;
}
inline bool IsOnlyTold(const patient::Table& owner, const void* field) {
  return field == &owner.reason;
}

template <typename T>
struct IsPerhaps : std::false_type {};
template <typename T>
struct IsPerhaps<std::optional<T>> : std::true_type {};
template <typename T>
struct IsEither : std::false_type {};
template <typename... T>
struct IsEither<std::variant<T...>> : std::true_type {};

}  // namespace fields_detail

/// Calls visitor.Value(leaf) for every number, enumerator and text, and visitor.Length(list), visitor.Presence(optional) and
/// visitor.Choice(variant) before what those hold, in an order that is fixed.
/// \param value  a Scene or a part of one, const or not
template <typename T, typename Visitor>
void VisitFields(T& value, Visitor& visitor) {
  using Plain = std::remove_const_t<T>;
  namespace detail = fields_detail;
  if constexpr (std::is_arithmetic_v<Plain> || std::is_enum_v<Plain> || std::is_same_v<Plain, std::string>) {
    visitor.Value(value);
  } else if constexpr (std::is_same_v<Plain, const Procedure*>) {
    std::string fingerprint(value == nullptr ? std::string_view() : value->fingerprint);
    if (!fingerprint.empty()) visitor.Value(fingerprint);
  } else if constexpr (base::kIsList<Plain>) {
    visitor.Length(value);
    for (auto& element : value) VisitFields(element, visitor);
  } else if constexpr (base::kIsFixedList<Plain>) {
    for (auto& element : value) VisitFields(element, visitor);
  } else if constexpr (detail::IsPerhaps<Plain>::value) {
    visitor.Presence(value);
    if (value) VisitFields(*value, visitor);
  } else if constexpr (detail::IsEither<Plain>::value) {
    visitor.Choice(value);
    std::visit([&](auto& held) { VisitFields(held, visitor); }, value);
  } else {
    base::ForEachField(value, [&](auto& field) {
      if constexpr (!std::is_same_v<std::remove_const_t<std::remove_reference_t<decltype(field)>>,
                                    std::filesystem::path>) {
        if (!detail::IsOnlyTold(value, &field)) VisitFields(field, visitor);
      }
    });
  }
}

/// Fingerprint of all of them.
std::uint64_t CalcSceneFingerprint(const Scene& scene);

}  // namespace trocar::scene
