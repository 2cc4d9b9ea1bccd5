// SPDX-License-Identifier: Apache-2.0
/// \file critical_view_picture.h  The critical view of safety as two pictures of one moment, from the front and from behind:
/// the "doublet" by which people score it.
/// Source: Sanford and Strasberg, "A simple effective method for generation of a permanent record of the critical view of
/// safety during laparoscopic cholecystectomy by intraoperative 'doublet' photography", J Am Coll Surg 2014.
#pragma once

#include <array>

#include "trocar/core/result.h"
#include "trocar/render/image.h"
#include "trocar/simulation/simulation.h"

namespace trocar::view {

struct CriticalViewPicture {
  render::Image image;
  /// Of the eye about the cystic duct, as DissectionFacts::view_azimuth: negative from the front [rad].
  double azimuth = 0;
  /// The cystic duct and the middle of the triangle lie in it with no organ before them. Where no such place was found,
  /// the picture is taken from 0.7 rad to that side all the same.
  bool shows_triangle = false;
};

struct CriticalViewDoublet {
  CriticalViewPicture front, back;
};

/// Draws the present state of an operation from both sides. The lens may be where no trocar would let it be: the pictures
/// show what is there, not what the trainee saw.
///
/// \param width, height  of each picture, 16 to 4096 [pixels]
/// \return kUsage where the scene has no cystic and common hepatic duct, or for a wrong size; kNoGraphics,
///         kGraphicsTooOld, kShaderFailed
/// \note Takes an OpenGL context of its own on the calling thread and gives it up at the end.
core::Result<CriticalViewDoublet> RenderCriticalViewDoublet(const simulation::Simulation& simulation,
                                                            int width = 1280, int height = 720);

}  // namespace trocar::view
