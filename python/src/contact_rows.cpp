// SPDX-License-Identifier: Apache-2.0
#include "contact_rows.h"

#include <algorithm>
#include <vector>

#include "trocar/base/assert.h"

namespace trocar::python {

void WriteContacts(const simulation::Simulation& simulation, std::span<float> rows) {
  TROCAR_ASSERT(rows.size() == kContactRows * kContactNumbers);
  std::vector<simulation::ToolContact> contacts;
  simulation.FindToolContacts(contacts);
  std::stable_sort(contacts.begin(), contacts.end(),
                   [](const auto& a, const auto& b) { return math::Norm(a.force) > math::Norm(b.force); });
  std::fill(rows.begin(), rows.end(), 0.0F);
  auto to = rows.begin();
  for (std::size_t i = 0; i < std::min(contacts.size(), kContactRows); ++i) {
    const simulation::ToolContact& contact = contacts[i];
    *to++ = 1;
    for (const math::Vec3& v : {contact.point, contact.normal, contact.force}) {
      for (int axis = 0; axis < 3; ++axis) *to++ = static_cast<float>(v[axis]);
    }
    for (const std::int32_t number : {contact.hand, contact.surface, contact.object})
      *to++ = static_cast<float>(number);
  }
}

}  // namespace trocar::python
