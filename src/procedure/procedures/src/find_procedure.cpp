// SPDX-License-Identifier: Apache-2.0
#include "trocar/procedures/find_procedure.h"

#include <array>
#include <type_traits>

#include "trocar/cholecystectomy/cholecystectomy.h"

namespace trocar::procedures {

std::span<const scene::Procedure* const> ListProcedures() {
  static const std::array procedures = {&cholecystectomy::Cholecystectomy(), &cholecystectomy::TissueTask()};
  return procedures;
}

const scene::Procedure* FindProcedure(std::string_view name) {
  for (const scene::Procedure* procedure : ListProcedures()) {
    if (procedure->name == name) return procedure;
  }
  return nullptr;
}

std::string ListNames() {
  std::string names;
  for (const scene::Procedure* procedure : ListProcedures())
    names += (names.empty() ? "" : ", ") + std::string(procedure->name);
  return names;
}

namespace {

/// A procedure's own roles of that kind; of regions and neighbours there are none.
template <class Role>
std::span<const scene::OwnRole<Role>> OwnRoles(const scene::Procedure& of) {
  if constexpr (std::is_same_v<Role, roles::OrganRole>) {
    return of.organ_roles;
  } else if constexpr (std::is_same_v<Role, roles::TubeRole>) {
    return of.tube_roles;
  } else if constexpr (std::is_same_v<Role, roles::LandmarkRole>) {
    return of.landmark_roles;
  } else {
    return {};
  }
}

}  // namespace

template <class Role>
std::optional<Role> FindRole(std::string_view name) {
  if (const auto common = roles::FindRole<Role>(name)) return common;
  for (const scene::Procedure* procedure : ListProcedures()) {
    for (const scene::OwnRole<Role>& own : OwnRoles<Role>(*procedure)) {
      if (name == own.name) return own.role;
    }
  }
  return std::nullopt;
}

template <class Role>
const char* NameOf(Role role) {
  for (const scene::Procedure* procedure : ListProcedures()) {
    for (const scene::OwnRole<Role>& own : OwnRoles<Role>(*procedure)) {
      if (role == own.role) return own.name;
    }
  }
  return roles::NameOf(role);
}

template <class Role>
std::string ListRoles() {
  std::string names = roles::ListNames<Role>();
  for (const scene::Procedure* procedure : ListProcedures()) {
    for (const scene::OwnRole<Role>& own : OwnRoles<Role>(*procedure)) names += ", " + std::string(own.name);
  }
  return names;
}

template std::optional<roles::OrganRole> FindRole(std::string_view);
template std::optional<roles::TubeRole> FindRole(std::string_view);
template std::optional<roles::LandmarkRole> FindRole(std::string_view);
template std::optional<roles::RegionRole> FindRole(std::string_view);
template const char* NameOf(roles::OrganRole);
template const char* NameOf(roles::TubeRole);
template const char* NameOf(roles::LandmarkRole);
template const char* NameOf(roles::RegionRole);
template std::string ListRoles<roles::OrganRole>();
template std::string ListRoles<roles::TubeRole>();
template std::string ListRoles<roles::LandmarkRole>();
template std::string ListRoles<roles::RegionRole>();

}  // namespace trocar::procedures
