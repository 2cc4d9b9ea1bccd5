// SPDX-License-Identifier: Apache-2.0
/// \file contour_workspace.h  Pictures and contours at work together: what the contour window holds, without
/// a window.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/contours/contour_document.h"
#include "trocar/contours/grow_contours.h"
#include "trocar/contours/intelligent_scissors.h"
#include "trocar/contours/mesh_job.h"
#include "trocar/contours/slice_fits.h"
#include "trocar/contours/slice_store.h"
#include "trocar/images/image_series.h"

namespace trocar::contours {

/// Files and options that a workspace is opened with.
struct WorkspaceOptions {
  std::filesystem::path images;       ///< any series that ImageSeries opens
  std::filesystem::path points;       ///< file of contours; need not exist yet. Empty: none
  std::filesystem::path reference;    ///< label map to compare with; empty: none
  images::ImageSeriesOptions series;  ///< what the pictures do not say; the file of contours goes first
};

/// Points that a propagated contour got, and how far the pictures agree there.
struct Propagation {
  int slice = 0;             ///< the slice that was filled
  double confidence = 1;     ///< of the least certain point, 0 to 1
  std::size_t contours = 0;  ///< holes too
};

class ContourWorkspace {
 public:
  /// Opens the series, reads the contours or begins new ones as the series lies.
  ///
  /// A new document has the organs liver and gallbladder, without contours.
  /// \return the first error of any file; kImageSizeDiffers when the contours belong to other pictures
  static base::Result<ContourWorkspace> Open(const WorkspaceOptions& options,
                                             const images::Progress& progress = {});

  ContourWorkspace(ContourWorkspace&&) noexcept;
  ContourWorkspace& operator=(ContourWorkspace&&) noexcept;
  ~ContourWorkspace();

  ContourDocument& Document() { return *document_; }
  const ContourDocument& Document() const { return *document_; }
  const images::ImageSeriesInfo& Series() const { return series_->Info(); }
  const WorkspaceOptions& Options() const { return options_; }
  /// The document is the recovered one from now on, and not saved.
  void Replace(ControlPoints points);
  /// Text of the file as it was last read or written; empty for a new one.
  const std::string& SavedText() const { return saved_text_; }
  /// Writes the contours.
  /// \param path  becomes the document's file
  base::Status Save(const std::filesystem::path& path);

  /// Slices that there are pictures of, ascending.
  const std::vector<int>& Slices() const { return series_->Info().slice_numbers; }
  /// The slice nearest to `slice` that there is a picture of, `steps` further.
  int StepSlice(int slice, int steps) const;

  // pictures; edges are always sought in the suggested grey window, whatever is shown
  base::Result<std::shared_ptr<const images::ColorImage>> Picture(int slice) {
    return store_->Picture(slice);
  }
  base::Result<images::ColorImage> PictureInWindow(int slice, const images::DisplayWindow& window) const;
  std::shared_ptr<SliceStore> Store() const { return store_; }
  std::shared_ptr<SliceFits> Fits() const { return fits_; }

  /// Fit of the closed contours of a slice.
  base::Result<std::shared_ptr<const SliceFit>> Fit(int structure, int slice,
                                                    FitEffort effort = FitEffort::kWhole);
  /// A copy of what the organ's surface depends on.
  MeshRequest MakeMeshRequest(int structure) const;

  /// Copy of what GrowOrgan needs for a click into an organ, for use in a thread.
  /// \pre the structure is there (TROCAR_ASSERT)
  GrowthRequest MakeGrowthRequest(int structure, int slice, const math::Vec2& click) const;

  /// Carries the contours of a slice into another one, through the slices between them.
  /// \param is_replacing  contours that stand there already go; else they are left and the command refused
  /// \return kEditRefused when there is nothing to carry, or no such slice
  base::Result<Propagation> Propagate(int structure, int from, int to, bool is_replacing = false);

  /// Path along edges from the last point of the open contour to `target` [pixels]; a straight line where
  /// nothing is open. Cheap while the last point stays.
  base::Result<std::vector<math::Vec2>> FindScissorsPath(int structure, int slice, const math::Vec2& target);
  /// Adds that path to the open contour, with as few points as follow it within a pixel.
  base::Status FollowEdge(int structure, int slice, const math::Vec2& target);

  /// Borders of the reference's labels in a slice, in pixels of the picture: pairs of ends, by label.
  struct ReferenceLines {
    int label = 0;
    std::vector<std::array<math::Vec2, 2>> lines;
  };
  /// Shows this map from now on, or none.
  /// \param labels  a voxel a pixel, as images::AlignLabels makes it
  void UseReference(std::optional<images::LabelVolume> labels) { reference_ = std::move(labels); }
  bool HasReference() const { return reference_.has_value(); }
  std::vector<ReferenceLines> FindReference(int slice) const;

 private:
  ContourWorkspace();

  WorkspaceOptions options_;
  std::optional<images::ImageSeries> series_;
  std::unique_ptr<ContourDocument> document_;
  std::string saved_text_;
  std::shared_ptr<SliceStore> store_;  // shared with threads that fit
  std::shared_ptr<SliceFits> fits_;    // also shared with threads that fit
  std::optional<images::LabelVolume> reference_;
  // scissors, ready for the slice and seed that were last asked for
  std::unique_ptr<IntelligentScissors> scissors_;
  int scissors_slice_ = 0;
  std::optional<math::Vec2> scissors_seed_;
};

/// Place of a pixel in the patient, LPS [mm], when the series says where it lies; else nothing.
std::optional<std::array<double, 3>> FindPatientPlace(const images::ImageSeriesInfo& series, int slice,
                                                      const math::Vec2& p);

}  // namespace trocar::contours
