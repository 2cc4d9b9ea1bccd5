// SPDX-License-Identifier: Apache-2.0
/// \file phantom.h  Cryosection pictures of a patient that was never photographed: the chain from pictures to
/// a patient can be tried and judged with no data, and the truth is known.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/control_points.h"
#include "trocar/images/image_stack.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

struct PhantomOptions {
  std::uint64_t seed = 0;  ///< of textures, grain and the simulated person's slips
  double pixel_mm = 0.8;   ///< 0.3 to 4
  double slice_mm = 1.0;   ///< 0.5 to 8
  double noise = 1.0;      ///< grain and uneven light; 0 none, 1 as a fair photograph, up to 5
  double blur_px = 0.7;    ///< standard deviation of the lens's blur [pixels], 0 to 5
  int every = 8;           ///< the control points lie on every so many slices, 1 to 64
  int points = 12;         ///< control points a contour, 6 to 64
  double slip_mm = 3.0;    ///< how far each one is off, in a random direction, 0 to 20
};

/// Labels in the truth, as in the Visible Human reference.
inline constexpr std::uint8_t kLiverLabel = 1, kGallbladderLabel = 2, kDuctLabel = 3, kArteryLabel = 4;

/// The pictures' frame: columns to the left, rows to posterior, slices to inferior, as radiology shows axial
/// slices; so the patient's right is at the picture's left.
class Phantom {
 public:
  /// \return kPatientInvalid without liver or gallbladder; kUsage for an option out of range
  static base::Result<Phantom> Make(const patient::Patient& patient, const PhantomOptions& options);

  Phantom(Phantom&&) noexcept;
  Phantom& operator=(Phantom&&) noexcept;
  ~Phantom();

  int Width() const;       ///< [pixels]
  int Height() const;      ///< [pixels]
  int SliceCount() const;  ///< numbered from 1

  /// One picture: surroundings, organs with smooth borders, texture, blur and grain.
  /// \param slice  1 to SliceCount() (TROCAR_ASSERT)
  images::ColorImage DrawSlice(int slice) const;
  /// Which organ each pixel's centre lies in.
  /// \return (height * width)
  std::vector<std::uint8_t> LabelSlice(int slice) const;

  /// How the pictures lie, and what a hasty person would have clicked: points beside the true contours on
  /// every n-th slice, the ducts and landmarks as they are.
  contours::ControlPoints MakeControlPoints() const;
  /// All labels, with their names, at their place in the world (LPS).
  images::LabelVolume MakeLabels(const images::Progress& progress = {}) const;

 private:
  struct Content;
  explicit Phantom(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

/// NRRD file, uncompressed, with the labels' names as 3D Slicer keeps them; ReadLabelVolume reads it back.
/// \pre no label is larger than 255 (TROCAR_ASSERT)
base::Status WriteLabelVolume(const std::filesystem::path& path, const images::LabelVolume& volume);

/// Writes slices/phantom-NNNN.png, labels.nrrd, control_points.json and patient/ (the truth) into a folder.
///
/// \param folder  is made; it must not exist, or be empty
/// \return kFileUnwritable, or the error of Phantom::Make
base::Status WritePhantom(const std::filesystem::path& folder, const patient::Patient& patient,
                          const PhantomOptions& options, const images::Progress& progress = {});

}  // namespace trocar::anatomy
