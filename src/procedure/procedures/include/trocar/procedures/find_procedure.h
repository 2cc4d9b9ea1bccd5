// SPDX-License-Identifier: Apache-2.0
/// \file find_procedure.h  All procedures that there are. A new one is a line in find_procedure.cpp: docs/procedures.md.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "trocar/scene/procedure.h"

namespace trocar::procedures {

/// Of a scene with a patient, and of tissue that a training task makes for itself, where the file names none.
inline constexpr const char* kUsualProcedure = "cholecystectomy";
inline constexpr const char* kTissueTask = "tissue_task";

/// In the order of the list; never empty, never null.
std::span<const scene::Procedure* const> ListProcedures();
/// Null where there is none of that name.
const scene::Procedure* FindProcedure(std::string_view name);
/// "cholecystectomy, tissue_task": for messages.
std::string ListNames();

/// The role of that name: one that every procedure knows, or a procedure's own.
template <class Role>
std::optional<Role> FindRole(std::string_view name);
/// Its name in files, also of a procedure's own.
template <class Role>
const char* NameOf(Role role);
/// "liver, gallbladder": all of them, for messages.
template <class Role>
std::string ListRoles();

}  // namespace trocar::procedures
