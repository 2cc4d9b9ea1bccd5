// SPDX-License-Identifier: Apache-2.0
#include "trocar/core/error_codes.h"

#include <cstddef>
#include <iterator>

namespace trocar::core {
namespace {

constexpr ErrorEntry kTable[] = {
    {ErrorCode::kNone, "E-000", "no error"},
    {ErrorCode::kFileMissing, "E-IO-001", "a file or folder does not exist"},
    {ErrorCode::kFileUnreadable, "E-IO-002", "a file cannot be read"},
    {ErrorCode::kFileUnwritable, "E-IO-003", "a file cannot be written"},
    {ErrorCode::kJsonSyntax, "E-IO-004", "a file is not valid JSON"},
    {ErrorCode::kJsonField, "E-IO-005", "a JSON field is missing, of the wrong kind or out of range"},
    {ErrorCode::kNumberNotFinite, "E-IO-006", "a number is NaN or infinite"},
    {ErrorCode::kFileTooLarge, "E-IO-007", "a file is larger than the reader accepts"},
    {ErrorCode::kFileInUse, "E-IO-008", "another program works on a file or device"},
    {ErrorCode::kImageFolderMissing, "E-IMG-001", "the folder or file of images does not exist"},
    {ErrorCode::kImageSliceMissing, "E-IMG-002", "a slice is missing in the folder of images"},
    {ErrorCode::kImageSizeDiffers, "E-IMG-003",
     "a slice has another size than its neighbours or the control points"},
    {ErrorCode::kImageUndecodable, "E-IMG-004", "an image cannot be decoded"},
    {ErrorCode::kImageSpacingUnknown, "E-IMG-005",
     "the images do not say how large a pixel is, how far slices are apart or how they lie in the body"},
    {ErrorCode::kImageSeriesMixed, "E-IMG-006", "a folder holds images that do not belong to one series"},
    {ErrorCode::kImageSeriesGap, "E-IMG-007", "slices are missing between others"},
    {ErrorCode::kImageSeriesUneven, "E-IMG-008", "slices are unevenly spaced, doubled or sheared"},
    {ErrorCode::kImageGeometryInvalid, "E-IMG-009",
     "a spacing, position or orientation of images is impossible or too oblique"},
    {ErrorCode::kImageTooLarge, "E-IMG-010", "an image needs more memory than is allowed"},
    {ErrorCode::kImageTruncated, "E-IMG-011", "an image file holds fewer bytes than its header announces"},
    {ErrorCode::kImageUnsupported, "E-IMG-012", "an image is of a kind that is not read"},
    {ErrorCode::kImagePathUnsafe, "E-IMG-013",
     "an image path is a link, a device, a pipe or leaves its folder"},
    {ErrorCode::kImageChanged, "E-IMG-014", "an image file changed while it was read"},
    {ErrorCode::kImportProgramMissing, "E-IMG-015", "the program that reads images cannot be started"},
    {ErrorCode::kImportCrashed, "E-IMG-016", "the program that reads images crashed on a file"},
    {ErrorCode::kImportTimedOut, "E-IMG-017", "the program that reads images did not finish in time"},
    {ErrorCode::kImportOutOfMemory, "E-IMG-018", "the program that reads images ran out of memory"},
    {ErrorCode::kControlPointOutside, "E-ANA-001", "a control point lies outside its image"},
    {ErrorCode::kContourTooShort, "E-ANA-002", "a contour has fewer points than a closed curve needs"},
    {ErrorCode::kContourEmpty, "E-ANA-003", "a contour or structure encloses nothing"},
    {ErrorCode::kMeshNotClosed, "E-ANA-004", "an organ's mesh is not closed and manifold"},
    {ErrorCode::kPatientInvalid, "E-ANA-005", "a patient is inconsistent"},
    {ErrorCode::kLabelsMismatch, "E-ANA-006", "reference labels do not match the images"},
    {ErrorCode::kMeshInvalid, "E-GEO-001", "a mesh has a bad index or a coordinate that is not finite"},
    {ErrorCode::kSceneInvalid, "E-SCN-001", "a scene is inconsistent"},
    {ErrorCode::kScriptInvalid, "E-SCN-002", "a script is inconsistent"},
    {ErrorCode::kUnknownName, "E-SCN-003", "a name is not known"},
    {ErrorCode::kStateNotFinite, "E-SIM-001",
     "the tissue state was not finite; the last good state was restored"},
    {ErrorCode::kOrganFrozen, "E-SIM-002", "an organ is held still after repeated failures"},
    {ErrorCode::kTissueInvalid, "E-SIM-003", "a mass-spring system cannot be solved"},
    {ErrorCode::kUnstableStep, "E-SIM-004", "the relaxation's step is larger than any stable one"},
    {ErrorCode::kOutOfMemory, "E-SIM-005", "more memory is needed than there is"},
    {ErrorCode::kStateInvalid, "E-SIM-006",
     "a saved state is damaged, of another version or of another scene"},
    {ErrorCode::kRecordingInvalid, "E-REC-001",
     "a recording is damaged, of another version, or its scene has changed since"},
    {ErrorCode::kRatingInvalid, "E-RPT-001", "a rating or its form cannot be used"},
    {ErrorCode::kXapiUnsafe, "E-LRS-001", "learning records would travel in the open, or their password lies open"},
    {ErrorCode::kXapiAway, "E-LRS-002", "the learning record store cannot be reached"},
    {ErrorCode::kXapiRefused, "E-LRS-003", "the learning record store refused the credentials or a statement"},
    {ErrorCode::kNoGraphics, "E-GL-001", "no OpenGL context can be made"},
    {ErrorCode::kGraphicsTooOld, "E-GL-002", "OpenGL is older than 3.3"},
    {ErrorCode::kShaderFailed, "E-GL-003", "a shader does not compile"},
    {ErrorCode::kVideoFailed, "E-VID-001", "the video cannot be written"},
    {ErrorCode::kNoDisplay, "E-WIN-001", "there is no display for the window"},
    {ErrorCode::kWindowMissing, "E-WIN-002", "this build has no window"},
    {ErrorCode::kEditRefused, "E-WIN-003", "the contours do not allow this edit"},
    {ErrorCode::kCancelled, "E-WIN-004", "the work was given up on request"},
    {ErrorCode::kDeviceLost, "E-DEV-001", "a device was lost"},
    {ErrorCode::kDeviceStale, "E-DEV-002", "a device sends no fresh data"},
    {ErrorCode::kDeviceState, "E-DEV-003", "a device was asked for something out of turn"},
    {ErrorCode::kDeviceSettings, "E-DEV-004", "the settings of a device cannot work"},
    {ErrorCode::kForceRefused, "E-DEV-008", "a force was refused and the output disarmed"},
    {ErrorCode::kDeviceBusy, "E-DEV-020", "a device or port is used by another program"},
    {ErrorCode::kCalibrationPoor, "E-DEV-021", "a calibration does not fit what was measured"},
    {ErrorCode::kDeviceUnsupported, "E-DEV-022", "this build lacks the library that a device needs"},
    {ErrorCode::kUsage, "E-CLI-001", "the command line is wrong"},
    {ErrorCode::kBenchmarkWrong, "E-BEN-001", "a benchmark's result is wrong, so its time means nothing"},
    {ErrorCode::kGpuMissing, "E-GPU-001", "there is no NVIDIA GPU, no driver, or no GPU code in this build"},
    {ErrorCode::kGpuTooOld, "E-GPU-002", "the GPU or its driver is too old"},
    {ErrorCode::kGpuFailed, "E-GPU-003", "the GPU failed; the processor goes on"},
    {ErrorCode::kGpuMemory, "E-GPU-004", "the GPU has not enough memory"},
    {ErrorCode::kGpuLayout, "E-GPU-005", "a memory layout cannot hold this tissue or load"},
    {ErrorCode::kHapticNotArmed, "E-HAP-001", "force feedback is not armed"},
    {ErrorCode::kHapticSamplesBad, "E-HAP-002", "a haptic device sends nonsense"},
    {ErrorCode::kHapticJump, "E-HAP-003", "a haptic device's position jumped"},
    {ErrorCode::kHapticOverrun, "E-HAP-004", "the haptic loop stood still"},
    {ErrorCode::kHapticSupervisor, "E-HAP-005",
     "the haptic supervisor is missing, gone, or had to stop the force"},
    {ErrorCode::kHapticWarm, "E-HAP-006", "the motors of a haptic device are too hot"},
    {ErrorCode::kHapticDeadMan, "E-HAP-007", "nobody holds the safety switch of a haptic device"},
    {ErrorCode::kHapticCheckPose, "E-HAP-008", "it is not confirmed which haptic device is which hand"},
    {ErrorCode::kHapticNotCalibrated, "E-HAP-009", "a haptic device is not calibrated"},
    {ErrorCode::kHapticOverspeed, "E-HAP-010", "a haptic device ran away with its force"},
    {ErrorCode::kHapticSimulation, "E-HAP-011",
     "the simulation has no good tissue state for the haptic loop"},
};
static_assert(std::size(kTable) == static_cast<std::size_t>(ErrorCode::kCount));

}  // namespace

std::span<const ErrorEntry> ErrorTable() noexcept {
  return kTable;
}

std::string_view CodeText(ErrorCode code) noexcept {
  return kTable[static_cast<std::size_t>(code)].text;
}

}  // namespace trocar::core
