// SPDX-License-Identifier: Apache-2.0
/// \file ct_render.h  Tissues on a lattice as a CT scanner would show them: CT numbers by contrast phase, partial volume,
/// blur and noise, written as a DICOM series without any person.
/// Source: CT numbers without contrast: Prokop and Galanski, "Spiral and multislice computed tomography of the body",
/// Thieme 2003; with contrast: Bae, "Intravenous contrast medium administration and scan timing at CT", Radiology 2010
/// (a liver gains 50 HU or more in the portal venous phase). Values from the middle of the ranges given there.
/// Noise: Kijewski and Judy, "The noise power spectrum of CT images", Phys. Med. Biol. 1987: it rises from zero at low
/// frequencies and falls where the reconstruction smooths.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"

namespace trocar::images {

/// When the picture was taken after contrast medium was given into a vein.
enum class CtPhase { kNone, kArterial, kPortalVenous };

/// "none", "arterial", "portal".
std::optional<CtPhase> FindCtPhase(std::string_view name);
std::string_view NameOf(CtPhase phase);

enum class CtTissue : std::uint8_t {
  kAir,
  kLung,
  kFat,
  kSkin,
  kMuscle,
  kBone,  ///< between cortical and spongy
  kDisc,
  kNerve,
  kHeart,
  kArterialBlood,
  kVenousBlood,   ///< of the veins of the body
  kHepaticBlood,  ///< of portal and hepatic veins
  kBowelWall,
  kBowelContent,
  kRenalCortex,
  kRenalMedulla,
  kSpleen,
  kPancreas,
  kLiver,
  kGallbladderWall,
  kBile,
  kCount
};

/// CT number of a tissue [HU].
double FindHounsfield(CtTissue tissue, CtPhase phase);

/// Tissues on a lattice whose columns run to the left, rows to posterior and slices to superior.
struct TissueVolume {
  std::array<int, 3> size = {0, 0, 0};          ///< voxels, first axis fastest
  std::array<double, 3> step_mm = {1, 1, 1};    ///< > 0
  std::array<double, 3> origin_mm = {0, 0, 0};  ///< centre of the first voxel, LPS
  std::vector<CtTissue> tissues;                ///< (size product)

  std::size_t Index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * size[1] + j) * size[0] + i;
  }
};

/// How the scanner sees.
struct CtSettings {
  CtPhase phase = CtPhase::kPortalVenous;
  double pixel_mm = 0.8;  ///< 0.3 to 4
  double slice_mm = 3.0;  ///< thickness and distance of the slices, 0.5 to 10
  double blur_mm = 0.5;   ///< standard deviation of the point spread in the plane, 0 to 3; 0.5: a soft kernel
  double noise_hu = 12.0;  ///< standard deviation of the noise, 0 to 100
  std::uint64_t seed = 1;  ///< of the noise
};

/// A CT series: axes as TissueVolume.
struct CtVolume {
  std::array<int, 3> size = {0, 0, 0};
  double pixel_mm = 1, slice_mm = 1;
  std::array<double, 3> origin_mm = {0, 0, 0};  ///< centre of the first voxel, LPS
  std::vector<std::int16_t> hounsfield;         ///< (size product) [HU]
  CtPhase phase = CtPhase::kNone;
};

/// Each voxel has the mean of what lies in it, by volume, blurred in the plane, with noise.
/// \return kUsage for a setting out of range; kCancelled
base::Result<CtVolume> RenderCt(const TissueVolume& tissues, const CtSettings& settings,
                                std::stop_token stop = {}, const Progress& progress = {});

/// One CT image file a slice, slice-NNNN.dcm, in an existing folder. Attributes that name a person are there where the
/// standard demands them, and empty. The same volume gives the same bytes.
/// \return kFileUnwritable
base::Status WriteDicom(const std::filesystem::path& folder, const CtVolume& volume,
                        const Progress& progress = {});

/// Label of the voxel that a place lies in; 0 beyond the map.
/// \param p  LPS [mm]
/// \pre the map's steps are at right angles (IsOblique)
int LabelAt(const LabelVolume& labels, const std::array<double, 3>& p);
/// Whether two of the map's steps are further from a right angle than rounding leaves them.
bool IsOblique(const LabelVolume& labels);

/// Labels of a map at the CT's voxels: each has the label of the map's voxel that its centre lies in.
/// \pre the map's steps are at right angles (TROCAR_ASSERT)
LabelVolume LabelsOn(const CtVolume& volume, const LabelVolume& labels);

}  // namespace trocar::images
