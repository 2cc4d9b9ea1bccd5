// SPDX-License-Identifier: Apache-2.0
/// \file puddle_look.h  Look of a mixture of blood, bile and rinse.
#pragma once

#include "trocar/render/frame.h"
#include "trocar/render/looks.h"

namespace trocar::render {

/// Look of a puddle: as clear as its liquids by their shares, and as coloured as their pigments.
MaterialLook MixLook(const Looks& looks, const Puddle& puddle);
/// The liquid that gives a puddle most of its colour.
Material FindLiquid(const Looks& looks, const Puddle& puddle);

}  // namespace trocar::render
