// SPDX-License-Identifier: Apache-2.0
/// \file organ_attachment.h  Attachment of an organ that is taken off: its bed, adhesions, and the tubes that enter it.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "trocar/surgery/vessels.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

/// A duct or artery that ends in the organ.
struct EnteringTube {
  std::uint32_t tube = 0;
  std::vector<std::uint32_t> nodes;        ///< of its line, from the organ on
  std::vector<std::uint32_t> end_strands;  ///< that tie it to the organ
};

/// Constant.
class OrganAttachment {
 public:
  OrganAttachment() = default;
  /// \param strands  of bed and adhesions
  OrganAttachment(std::vector<std::uint32_t> strands, std::vector<EnteringTube> entering)
      : strands_(std::move(strands)), entering_(std::move(entering)) {}

  /// Neither bed nor adhesion holds it, and no tube that enters it is whole.
  /// \note Real-time safe.
  bool IsFree(const tissue::TissueState& tissue, const Vessels& vessels) const noexcept;

 private:
  std::vector<std::uint32_t> strands_;
  std::vector<EnteringTube> entering_;
};

}  // namespace trocar::surgery
