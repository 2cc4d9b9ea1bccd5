// SPDX-License-Identifier: Apache-2.0
/// \file phantom_tissue.h  Tissue at each place of the phantom's images: the body around liver and gallbladder.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

enum class Substance {
  kGel,  ///< the frozen block around the body; it fills what was gas, too
  kSkin,
  kFat,
  kMuscle,
  kBone,
  kDisc,
  kCord,
  kLung,
  kHeart,
  kBlood,
  kVesselWall,
  kBowelWall,
  kBowelContent,
  kKidney,
  kMedulla,
  kSpleen,
  kConnective,
  kLiver,
  kGallbladderWall,
  kBile,
  kDuct,
  kArtery,
  kAorticBlood,
  kCount
};

/// Colour in red, green, blue [0, 255].
using Tint = std::array<double, 3>;

/// Smooth random values on a lattice that repeats.
class NoiseField {
 public:
  explicit NoiseField(std::uint64_t seed);
  /// About [-1, 1], bumps `wavelength` apart [mm].
  double At(const math::Vec3& p, double wavelength) const;
  /// Two octaves.
  double Rough(const math::Vec3& p, double wavelength) const {
    return 0.7 * At(p, wavelength) + 0.45 * At(p, 0.43 * wavelength);
  }

 private:
  std::vector<float> values_;
};

/// Colour of a substance at a place, with its texture.
Tint CalcTint(Substance substance, const math::Vec3& p, const NoiseField& noise);

/// Landmarks that the body is drawn around; left, cranial, anterior [mm].
struct BodyPlan {
  geometry::Box liver;
  double lowest = 0;         ///< of the gallbladder
  math::Vec3 fundus, porta;  ///< of the gallbladder: its end and its neck
};

/// Everything but liver, gallbladder and the patient's own ducts and arteries. World frame in millimetres:
/// left, cranial, anterior.
class PhantomBody {
 public:
  PhantomBody(const patient::Patient& patient, std::uint64_t seed);
  PhantomBody(const BodyPlan& plan, std::uint64_t seed);

  const geometry::Box& Extent() const { return extent_; }  ///< of the pictures [mm]
  const NoiseField& Noise() const { return noise_; }

  struct Pipe {
    std::vector<math::Vec3> points;
    double radius = 0, wall = 0;
    Substance skin, filling;
    double gas = 2;  ///< height above the axis, in radii, from which gas fills it (2: none)
  };

  /// Pipes that come near the slice at height y.
  std::vector<Pipe> FindPipes(double y) const;
  /// \param pipes  as FindPipes(p.y) gave them;
  /// \param liver_distance  in the slice, to the liver or gallbladder [mm]
  Substance Find(const math::Vec3& p, const std::vector<Pipe>& pipes, double liver_distance) const;
  /// Blood inside the liver, or the liver itself.
  Substance FindInLiver(const math::Vec3& p, const std::vector<Pipe>& veins) const;
  std::vector<Pipe> FindVeins(double y) const;

 private:
  struct Ball {
    math::Vec3 centre, radii;
    double Distance(const math::Vec3& p) const;
  };
  Substance FindWall(const math::Vec3& p, double depth) const;
  Substance FindSpine(const math::Vec3& p, bool& is_there) const;
  double OutlineDepth(const math::Vec3& p) const;

  NoiseField noise_;
  geometry::Box liver_, extent_;
  double midline_ = 0, half_width_ = 0, half_depth_ = 0, middle_z_ = 0;
  Ball right_kidney_, left_kidney_, spleen_, stomach_, heart_;
  std::vector<Pipe> pipes_, veins_;
};

}  // namespace trocar::anatomy
