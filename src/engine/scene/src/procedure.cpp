// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/procedure.h"

#include <algorithm>

#include "trocar/scene/scene.h"

namespace trocar::scene {

std::optional<std::size_t> FindMeasure(const Procedure& procedure, std::string_view name) noexcept {
  for (std::size_t row = 0; row < procedure.measures.size(); ++row) {
    if (procedure.measures[row].name == name || procedure.measures[row].short_name == name) return row;
  }
  return std::nullopt;
}

double MeasureOf(const Procedure* procedure, const ProcedureSnapshot& now, std::string_view name) noexcept {
  const auto row = procedure == nullptr ? std::nullopt : FindMeasure(*procedure, name);
  return row ? now.Measure(*row) : 0.0;
}

bool MayBeDivided(const Procedure* procedure, roles::TubeRole tube) noexcept {
  return procedure != nullptr &&
         std::find(procedure->divided.begin(), procedure->divided.end(), tube) != procedure->divided.end();
}

std::string_view PhaseName(const Procedure* procedure, std::uint8_t phase) noexcept {
  return procedure != nullptr && phase < procedure->phases.size() ? procedure->phases[phase].name
                                                                  : std::string_view();
}

const surgery::ErrorRow* FindError(const Procedure* procedure, int row) noexcept {
  const bool is_there =
      procedure != nullptr && row >= 0 && static_cast<std::size_t>(row) < procedure->errors.size();
  return is_there ? &procedure->errors[static_cast<std::size_t>(row)] : nullptr;
}

std::optional<surgery::ErrorId> FindError(const Procedure& procedure, std::string_view name) noexcept {
  for (std::size_t row = 0; row < procedure.errors.size(); ++row) {
    if (procedure.errors[row].name == name) return surgery::ErrorId(static_cast<std::uint8_t>(row));
  }
  return std::nullopt;
}

void SizeSnapshot(const Procedure& procedure, ProcedureSnapshot& snapshot) {
  snapshot.measures.assign(procedure.measures.size(), 0.0);
  snapshot.view.criteria.assign(procedure.criteria.size(), 0);
  snapshot.view.sights.assign(procedure.sights.size(), 0);
}

const Procedure* ProcedureOf(const Scene& scene) noexcept {
  return scene.operation ? scene.operation->procedure : nullptr;
}

}  // namespace trocar::scene
