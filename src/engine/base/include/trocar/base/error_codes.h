// SPDX-License-Identifier: Apache-2.0
/// \file error_codes.h  Every error code of the project, in one table (src/error_codes.cpp). Tests assert
/// codes.
#pragma once

#include <span>
#include <string_view>

namespace trocar::base {

enum class ErrorCode {
  kNone,
  // files and text
  kFileMissing,
  kFileUnreadable,
  kFileUnwritable,
  kJsonSyntax,
  kJsonField,
  kNumberNotFinite,
  kFileTooLarge,
  kFileInUse,
  // images
  kImageFolderMissing,
  kImageSliceMissing,
  kImageSizeDiffers,
  kImageUndecodable,
  kImageSpacingUnknown,
  kImageSeriesMixed,
  kImageSeriesGap,
  kImageSeriesUneven,
  kImageGeometryInvalid,
  kImageTooLarge,
  kImageTruncated,
  kImageUnsupported,
  kImagePathUnsafe,
  kImageChanged,
  kImportProgramMissing,
  kImportCrashed,
  kImportTimedOut,
  kImportOutOfMemory,
  // anatomy
  kControlPointOutside,
  kContourTooShort,
  kContourEmpty,
  kMeshNotClosed,
  kPatientInvalid,
  kLabelsMismatch,
  // geometry
  kMeshInvalid,
  // scene and script
  kSceneInvalid,
  kScriptInvalid,
  kUnknownName,
  // simulation
  kStateNotFinite,
  kOrganFrozen,
  kTissueInvalid,
  kUnstableStep,
  kOutOfMemory,
  kStateInvalid,
  kRecordingInvalid,
  // store
  kStoreBusy,
  kStoreFull,
  kStoreAway,
  kStoreSchema,
  kStoreDamaged,
  kStoreReadOnly,
  kStoreRefused,
  kStoreUnknown,
  kStoreInvalid,
  // reports, ratings, learning records
  kRatingInvalid,
  kXapiUnsafe,
  kXapiAway,
  kXapiRefused,
  // drawing and video
  kNoGraphics,
  kGraphicsTooOld,
  kShaderFailed,
  kVideoFailed,
  // window
  kNoDisplay,
  kWindowMissing,
  kEditRefused,
  kCancelled,
  // devices
  kDeviceLost,
  kDeviceStale,
  kDeviceState,
  kDeviceSettings,
  kForceRefused,
  kDeviceBusy,
  kCalibrationPoor,
  kDeviceUnsupported,
  // command line and benchmarks
  kUsage,
  kBenchmarkWrong,
  // graphics processor for computing
  kGpuMissing,
  kGpuTooOld,
  kGpuFailed,
  kGpuMemory,
  kGpuLayout,
  // haptics
  kHapticNotArmed,
  kHapticSamplesBad,
  kHapticJump,
  kHapticOverrun,
  kHapticSupervisor,
  kHapticWarm,
  kHapticDeadMan,
  kHapticCheckPose,
  kHapticNotCalibrated,
  kHapticOverspeed,
  kHapticSimulation,
  // courses, levels, exams and certificates
  kCourseInvalid,
  kProficiencyInvalid,
  kAttemptsTooFew,
  kStepLocked,
  kPreparationFailed,
  kExamInvalid,
  kExamSealBroken,
  kKeyInvalid,
  kKeyUnsafe,
  kCertificateInvalid,
  kCertificateSigner,
  kCertificateRecording,
  kCertificateOutcome,
  kKeyLocked,
  // environments for reinforcement learning
  kActionInvalid,
  kEnvironmentState,
  // data sets and studies
  kDatasetInvalid,
  kStudyInvalid,
  kStudyChanged,
  kClusterAway,
  kCount
};

struct ErrorEntry {
  ErrorCode code;
  std::string_view text;     ///< "E-IMG-002"
  std::string_view meaning;  ///< one line
};

/// The table, in the order of the enumeration.
std::span<const ErrorEntry> ErrorTable() noexcept;

/// Stable text of a code, for example "E-IMG-002".
std::string_view CodeText(ErrorCode code) noexcept;

}  // namespace trocar::base
