// SPDX-License-Identifier: Apache-2.0
/// \file field_ranges.h  In which range each quantity of a scene, task, script or material file means something.
/// The JSON schemas say the same; FieldRanges.SchemaAndReaderAgree compares them field by field.
#pragma once

#include "trocar/host/json.h"

namespace trocar::files::range {

using Range = host::NumberRange;

// --- places. The origin is the umbilicus, or the middle of a training board; nobody's abdomen is 2 m wide.
inline constexpr Range kPlaceMm{-1000,
                                1000};  ///< port_mm, at_mm, from_mm, to_mm, centre_mm, points_mm, each part
inline constexpr Range kOffsetMm{-500, 500};   ///< offset_mm, lift_mm: from a landmark
inline constexpr Range kDirection{-1, 1};      ///< across, facing, each part [-]
inline constexpr Range kTurnDeg{-3600, 3600};  ///< spin_deg, post_deg, turn_deg: ten turns either way
inline constexpr Range kJawDeg{0, 90};
/// Nearer to each other than a trocar is thick, two ports would be one hole.
inline constexpr double kLeastPortDistanceMm = 5;

// --- scene
inline constexpr Range kTickHz{10, 2000};
inline constexpr Range kSeed{0, 2147483647};
inline constexpr Range kLaparoscopeDepthMm{10, 300};
inline constexpr Range kViewAngleDeg{0, 70};
inline constexpr Range kFieldOfViewDeg{20, 120};

// --- settings
inline constexpr Range kStiffnessScale{0.05, 20};
inline constexpr Range kShapeScale{0, 20};
inline constexpr Range kGravity{0, 30};    ///< gravity_m_s2
inline constexpr Range kTiltDeg{-30, 30};  ///< head_up_deg, right_up_deg
inline constexpr Range kMaxIterations{1, 100'000};
/// A relative residual; 0 is never reached, and below the least the sum of a tissue's forces is rounding.
inline constexpr Range kTolerance{1e-12, 1};
inline constexpr Range kMaxError{1e-9, 1};
inline constexpr Range kMaxNewtonSteps{1, 1000};
inline constexpr Range kMaxLinearTotal{1, 100'000};

// --- materials
inline constexpr Range kModulusPa{0, 1e9};  ///< young_modulus_pa, foundation_modulus_pa
inline constexpr Range kWallThicknessMm{0.001, 100};
inline constexpr Range kFoundationDepthMm{0.1, 1000};
inline constexpr Range kDensity{0, 20'000};  ///< density_kg_m3
inline constexpr Range kFailureStrain{1e-9, 100};
inline constexpr Range kFailureForceN{1e-9, 1000};
inline constexpr Range kStiffening{0, 1e4};
inline constexpr Range kStiffeningStrain{0, 10};
inline constexpr Range kWallFailureStrain{1e-3, 100};
inline constexpr Range kWallDamagePerS{0, 1e6};
inline constexpr Range kWallDamageExponent{1, 100};
inline constexpr Range kInternalPressurePa{-20e3, 20e3};

// --- operation
inline constexpr Range kFatSpacingMm{0, 10};  ///< 0 for none, else at least 1.5
inline constexpr Range kGallstoneDiameterMm{1, 30};

// --- objects
inline constexpr Range kShapeMm{0.1, 1000};  ///< size_mm, radius_mm, height_mm, length_mm, thickness_mm
inline constexpr Range kPathRadiusMm{0.1, 100};
inline constexpr Range kMassG{0, 1000};  ///< 0: it never moves
inline constexpr Range kFriction{0, 5};
inline constexpr Range kGripOpenDeg{1, 90};

// --- model
inline constexpr Range kTubeRadiusMm{0.3, 10};
inline constexpr Range kSagMm{0, 50};
inline constexpr Range kTubeSpacingMm{0.5, 20};
inline constexpr Range kBandRadiusMm{0.1, 5};
inline constexpr Range kSheetHalfMm{10, 60};
inline constexpr Range kSheetSpacingMm{2, 20};
inline constexpr Range kCircleMm{2, 200};
inline constexpr Range kPrestrain{0, 0.2};

// --- script
inline constexpr Range kTremorMm{0, 5};
inline constexpr Range kTimeS{0, 36'000};  ///< ten hours

// --- task
inline constexpr Range kParameter{-1e6, 1e6};  ///< its place of use bounds it further
inline constexpr Range kSpread{0, 1e6};
inline constexpr Range kLevelScore{1, 100};
inline constexpr Range kRegionMm{0.1, 1000};  ///< radius_mm, half_mm
inline constexpr Range kTimeLimitS{1, 36'000};
inline constexpr Range kPoints{0, 1e6};  ///< points, penalty, points_per_second_left
inline constexpr Range kReferencePoints{0, 1e9};
inline constexpr Range kStage{0, 1000};
inline constexpr Range kGrip{0, 15};  ///< grip of a stop, counted from 0
inline constexpr Range kSeconds{0, 3600};
inline constexpr Range kHeightMm{0, 1000};  ///< height_mm, fall_mm, near_mm, far_mm
inline constexpr Range kNewtons{0, 1000};
inline constexpr Range kWithinDeg{0.1, 90};
inline constexpr Range kFacingDeg{0.1, 180};
inline constexpr Range kClips{1, 100};
inline constexpr Range kCutDistanceMm{0.1, 100};
inline constexpr Range kCutAreaMm2{0.1, 1e4};

}  // namespace trocar::files::range
