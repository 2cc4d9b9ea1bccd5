// SPDX-License-Identifier: Apache-2.0
/// \file volume_opening.h  Removal of the parts of an organ that are too thin for its triangles.
#pragma once

#include "trocar/meshing/volume.h"

namespace trocar::contours {

/// Length of an edge of the mesh that so many even triangles make of the volume's surface [mm].
///
/// The area is that of the faces between samples inside and outside, times 2/3: what a surface that looks
/// every way has of it.
double CalcEdgeLength(const meshing::ScalarVolume& volume, int triangles);

/// Takes away what no ball of `radius_mm` inside the volume reaches (a morphological opening): edges of a thin
/// lobe that is slanted against the slices, and tips between two slices. Within a slice they may be thick.
/// Sample by sample, so within half a sample; a ball of fewer than two samples changes nothing, nor does one
/// that fits nowhere.
/// \param volume  values above 0 are inside; elsewhere than at what is taken away they stay as they are
void OpenVolume(meshing::ScalarVolume& volume, double radius_mm);

}  // namespace trocar::contours
