// SPDX-License-Identifier: Apache-2.0
/// \file critical_view_picture.h  The critical view of safety as two pictures, from the front and from behind: the "doublet" by
/// which people score it.
/// Source: Sanford and Strasberg, "A simple effective method for generation of a permanent record of the critical view of
/// safety during laparoscopic cholecystectomy by intraoperative 'doublet' photography", J Am Coll Surg 2014.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/render/image.h"
#include "trocar/simulation/simulation.h"

namespace trocar::view {

struct CriticalViewPicture {
  render::Image image;
  /// Of the eye about the cystic duct, as DissectionFacts::view_azimuth: negative from the front [rad].
  double azimuth = 0;
  /// The cystic duct, the middle of the triangle's window and where tubes enter the gallbladder lie in it with neither
  /// organ nor fat before them. Where no such place was found, the picture is taken from 0.7 rad to that side all the same.
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
base::Result<CriticalViewDoublet> RenderCriticalViewDoublet(const simulation::Simulation& simulation,
                                                            int width = 1280, int height = 720);

/// As above, each side of another moment of the same operation.
base::Result<CriticalViewDoublet> RenderCriticalViewDoublet(const simulation::Simulation& front,
                                                            const simulation::Simulation& back, int width,
                                                            int height);

/// A moment as it is drawn: without smoke, and without what is pooled, as after suction. It would hide the triangle, and the
/// ground that it lies on is not drawn.
simulation::Snapshot ClearField(simulation::Snapshot snapshot);

/// Keeps the states in which the two views of an achieved critical view came to count. A view counts for the verdict once it was
/// seen long enough, and is forgotten where a criterion is no longer whole.
class CriticalViewMoments {
 public:
  struct Moment {
    double time = 0;               ///< [s]
    std::vector<std::byte> state;  ///< saved; empty: there is none
  };

  /// After each tick, until the view is achieved; later ones change nothing.
  /// \param save  called where the state is to be kept: Simulation::Save
  void AfterStep(const scene::ViewScore& score, double time,
                 const std::function<void(std::vector<std::byte>&)>& save);
  bool IsAchieved() const { return is_achieved_; }
  /// Of the achieved view; the later of the two is the verdict's.
  const Moment& Front() const { return moments_[0]; }
  const Moment& Behind() const { return moments_[1]; }
  double Time() const { return std::max(moments_[0].time, moments_[1].time); }

 private:
  std::array<Moment, 2> moments_;
  bool is_achieved_ = false;
};

}  // namespace trocar::view
