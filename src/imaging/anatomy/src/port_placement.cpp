// SPDX-License-Identifier: Apache-2.0
#include "port_placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "trocar/anatomy/move_port.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using math::Hypot;

// The usual patient: fundus from the navel on the insufflated wall, ports as in scenes/cholecystectomy.json [m].
constexpr math::Vec3 kUsualFundus{-0.075, 0.095, -0.070};
constexpr std::array<math::Vec3, patient::kPortUseCount> kUsualPorts = {
    math::Vec3{0, 0, 0}, math::Vec3{-0.090, 0.045, -0.015}, math::Vec3{0, 0.080, -0.003},
    math::Vec3{-0.140, 0.060, -0.040}};
// The insufflated wall as surgery/cavity.h has it: how it falls away from its top, across and along the body [1/m].
constexpr double kAcross = 2.3, kAlong = 0.27;
constexpr double kLift = 0.040;           // of the wall by the gas [m]
constexpr double kWallThickness = 0.025;  // at the navel, skin to peritoneum [m]
constexpr double kNavelRadius = 0.035;    // round it, in which the front is looked for [m]
// What a navel may lie from the fundus, caudal and in front of it; beyond that the map is not believed [m].
constexpr double kLeastCaudal = 0.050, kMostCaudal = 0.160, kLeastFront = 0.045, kMostFront = 0.125;
constexpr double kNearest = 0.110,
                 kFarthest = 0.190;  // of the laparoscope's port from the gallbladder's neck [m]
constexpr double kLeastReach = 0.075, kMostReach = 0.220;               // of the others
constexpr double kRibGap = 0.015, kOrganGap = 0.010, kPortGap = 0.045;  // [m]
constexpr double kStep = 0.005;
constexpr int kMostSteps = 20;
constexpr double kUsualHeadUp = 12, kUsualRightUp = 8;   // [deg]
constexpr double kSteepHeadUp = 15, kSteepRightUp = 10;  // where bowel lies on the gallbladder
constexpr double kBowelNear = 0.008;                     // [m]

std::string Mm(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f mm", 1000 * metres);
  return text;
}

bool Sinks(roles::NeighbourRole role) {
  return role == roles::NeighbourRole::kStomach || role == roles::NeighbourRole::kDuodenum ||
         role == roles::NeighbourRole::kColon || role == roles::NeighbourRole::kSmallBowel;
}

void MoveBy(const math::Vec3& shift, patient::Patient& patient) {
  for (patient::Organ& organ : patient.organs) {
    for (math::Vec3& p : organ.mesh.positions) p += shift;
  }
  for (patient::Tube& tube : patient.tubes) {
    for (math::Vec3& p : tube.line.points) p += shift;
  }
  for (patient::Neighbour& neighbour : patient.neighbours) {
    for (math::Vec3& p : neighbour.mesh.positions) p += shift;
  }
  for (patient::Landmark& landmark : patient.landmarks) landmark.position += shift;
}

math::Vec3 PlaceOf(const patient::Patient& patient, roles::LandmarkRole role) {
  const patient::Landmark* landmark = patient.LandmarkOf(role);
  TROCAR_ASSERT(landmark != nullptr);
  return landmark->position;
}

/// Where the navel is on the insufflated wall, and how that is known.
struct Navel {
  math::Vec3 place;
  std::string reason;
  bool is_usual = true;  ///< nothing of it was measured
};

Navel FindNavel(const patient::Patient& patient, const BodyShape& body) {
  const math::Vec3 fundus = PlaceOf(patient, roles::LandmarkRole::kFundus);
  Navel navel;
  navel.place = fundus - kUsualFundus;
  if (body.midline) {
    navel.place.x = *body.midline;
    navel.reason += body.is_midline_of_spine ? "in the midline by the spine"
                                             : "in the midline, taken as that between aorta and vena cava";
    navel.is_usual = false;
  } else {
    navel.reason += Mm(-kUsualFundus.x) + " left of the fundus as usual (no spine is outlined)";
  }
  if (body.navel) {
    navel.place.y = std::clamp(*body.navel, fundus.y - kMostCaudal, fundus.y - kLeastCaudal);
    navel.reason += navel.place.y == *body.navel
                        ? ", at the height of the disc between the third and fourth lumbar vertebrae"
                        : ", as near to the height between the third and fourth lumbar vertebrae as the "
                          "gallbladder allows";
    navel.is_usual = false;
  } else {
    navel.reason += ", " + Mm(kUsualFundus.y) +
                    " caudal of the fundus as usual (no third and fourth lumbar vertebra named)";
  }
  const auto skin = body.skin.FindHeight(navel.place.x, navel.place.y, kNavelRadius);
  const auto organs = body.organs.FindHeight(navel.place.x, navel.place.y, kNavelRadius);
  if (navel.is_usual && !skin) {
    navel.reason += ", " + Mm(-kUsualFundus.z) + " in front of it";
    return navel;
  }
  const auto place = [&](double front, const std::string& what) {
    const double z = std::clamp(front + kLift, fundus.z + kLeastFront, fundus.z + kMostFront);
    navel.reason += ", " + what + " and " + Mm(kLift) + " that the gas lifts it";
    if (z != front + kLift) navel.reason += ", brought to " + Mm(z - fundus.z) + " in front of the fundus";
    navel.place.z = z;
    navel.is_usual = false;
  };
  if (skin) {
    place(*skin - kWallThickness, "behind the skin by " + Mm(kWallThickness) + " of wall");
  } else if (organs && *organs > fundus.z - kLift) {
    place(*organs, "on what lies foremost there");
  } else {
    navel.reason +=
        ", " + Mm(-kUsualFundus.z) + " in front of it (nothing in the map lies behind the wall there)";
  }
  return navel;
}

/// The insufflated wall of this body.
class Wall {
 public:
  Wall(const math::Vec3& navel, const patient::Patient& patient) : navel_(navel) {
    for (const patient::Organ& organ : patient.organs) Add(organ.mesh);
    for (const patient::Neighbour& neighbour : patient.neighbours) {
      if (neighbour.role == roles::NeighbourRole::kRibs) {
        ribs_ = neighbour.mesh.positions;
      } else if (neighbour.is_seen && neighbour.role != roles::NeighbourRole::kSpine) {
        Add(neighbour.mesh);
      }
    }
    for (const math::Vec3& p :
         patient.organs[static_cast<std::size_t>(patient.OrganOf(roles::OrganRole::kLiver))].mesh.positions)
      liver_.Add(p);
  }

  math::Vec3 PlaceAt(double x, double y) const {
    math::Vec3 place = PlaceAlone(x, y);
    if (const auto organs = front_.FindHeight(x, y, kOrganGap))
      place.z = std::max(place.z, *organs + kOrganGap);
    return place;
  }
  /// How far caudal a port must at least go to lie below the ribs and below the liver's edge.
  double MostCranial(const math::Vec3& port, std::string& why) const {
    double most = HUGE_VAL;
    for (const math::Vec3& p : ribs_) {
      if (std::fabs(p.x - port.x) < kRibGap && p.z > port.z - 0.06) most = std::min(most, p.y - kRibGap);
    }
    if (most < port.y) why = ", moved to " + Mm(kRibGap) + " below the costal margin";
    double y = std::min(most, port.y);
    for (int step = 0; step < kMostSteps; ++step) {
      const auto liver = liver_.FindHeight(port.x, y, kOrganGap);
      const math::Vec3 free = PlaceAlone(port.x, y);
      if (!liver || *liver < free.z - kOrganGap) break;
      y -= kStep;
      why = ", moved caudal until the liver's edge lies clear of it";
    }
    return y;
  }

 private:
  /// As if nothing lay behind the wall.
  math::Vec3 PlaceAlone(double x, double y) const {
    const double across = x - navel_.x, along = y - navel_.y;
    return {x, y, navel_.z - kAcross * across * across - kAlong * along * along};
  }
  void Add(const geometry::TriangleMesh& mesh) {
    for (const math::Vec3& p : mesh.positions) front_.Add(p);
  }

  math::Vec3 navel_;
  FrontMap front_, liver_;
  std::vector<math::Vec3> ribs_;
};

/// The laparoscope's: the navel, or the midline near it where that is too near or too far.
patient::Port PlaceLaparoscope(const Navel& navel, const math::Vec3& neck, const Wall& wall) {
  patient::Port port{patient::PortUse::kLaparoscope, navel.place, "At the navel: " + navel.reason};
  const double distance = math::Distance(port.position, neck);
  const double step = distance > kFarthest ? kStep : distance < kNearest ? -kStep : 0.0;
  double moved = 0;
  for (int i = 0; step != 0 && i < kMostSteps; ++i) {
    const double now = math::Distance(port.position, neck);
    if (now <= kFarthest && now >= kNearest) break;
    moved += step;
    port.position = wall.PlaceAt(navel.place.x, navel.place.y + moved);
  }
  if (moved != 0) {
    port.reason += "; then " + Mm(std::fabs(moved)) + (moved > 0 ? " above" : " below") +
                   " it in the midline, so that the neck of the gallbladder lies " +
                   Mm(math::Distance(port.position, neck)) + " away";
  }
  port.reason += ".";
  return port;
}

/// A working port: its usual place beside the gallbladder, as far as this body allows.
patient::Port PlaceWorking(patient::PortUse use, const patient::Patient& patient, double midline,
                           const Wall& wall, const std::vector<patient::Port>& others) {
  const math::Vec3 fundus = PlaceOf(patient, roles::LandmarkRole::kFundus),
                   neck = PlaceOf(patient, roles::LandmarkRole::kInfundibulum);
  const math::Vec3 usual = kUsualPorts[static_cast<std::size_t>(use)] - kUsualFundus;
  constexpr std::array<const char*, patient::kPortUseCount> kSites = {
      "", "Right subcostal in the midclavicular line, for the left hand",
      "Epigastric, right of the falciform ligament, for the right hand",
      "Lateral in the anterior axillary line, for the assistant who holds the fundus"};
  double x = fundus.x + usual.x, y = fundus.y + usual.y;
  patient::Port port{use, {}, kSites[static_cast<std::size_t>(use)]};
  if (use == patient::PortUse::kRightHand && std::fabs(x - midline) > 0.010) {
    x = std::clamp(x, midline - 0.020, midline + 0.005);
    port.reason += ", kept at the midline";
  }
  port.position = wall.PlaceAt(x, y);
  std::string why;
  if (const double most = wall.MostCranial(port.position, why); most < y) {
    y = most;
    port.position = wall.PlaceAt(x, y);
    port.reason += why;
  }
  // within reach of the neck, and away from the ports that there are
  const auto distance = [&] { return math::Distance(port.position, neck); };
  const auto is_close = [&] {
    return std::any_of(others.begin(), others.end(), [&](const patient::Port& other) {
      return math::Distance(other.position, port.position) < kPortGap;
    });
  };
  const auto move_while = [&](const auto& is_wrong, const auto& way, const std::string& reason) {
    int moved = 0;
    for (; moved < kMostSteps && is_wrong(); ++moved) {
      const math::Vec3 step = kStep * way();
      x += step.x, y += step.y;
      port.position = wall.PlaceAt(x, y);
    }
    if (moved > 0) port.reason += reason;
  };
  move_while([&] { return distance() > kMostReach; },
             [&] {
               return math::Normalized(math::Vec3{neck.x - x, neck.y - y, 0});
             },
             ", brought within reach");
  move_while([&] { return distance() < kLeastReach; },
             [] {
               return math::Vec3{0, -1, 0};
             },
             ", moved away from the gallbladder to leave room for the shaft");
  move_while(
      is_close,
      [use] {
        return use == patient::PortUse::kRightHand ? math::Vec3{0, 1, 0} : math::Vec3{-1, 0, 0};
      },
      ", kept " + Mm(kPortGap) + " from the other ports");
  char where[96];
  std::snprintf(where, sizeof where, "; the neck of the gallbladder lies %.0f mm away.", 1000 * distance());
  port.reason += where;
  return port;
}

patient::Table PlaceTable(const patient::Patient& patient) {
  const int gallbladder = patient.OrganOf(roles::OrganRole::kGallbladder);
  const meshing::NearestSurface surface(patient.organs[static_cast<std::size_t>(gallbladder)].mesh);
  double nearest = HUGE_VAL;
  const patient::Neighbour* bowel = nullptr;
  for (const patient::Neighbour& neighbour : patient.neighbours) {
    if (!neighbour.is_seen || !Sinks(neighbour.role)) continue;
    for (const math::Vec3& p : neighbour.mesh.positions) {
      const double distance = surface.Find(p).distance;
      if (distance < nearest) nearest = distance, bowel = &neighbour;
    }
  }
  if (nearest < kBowelNear) {
    return {kSteepHeadUp * math::kDegree, kSteepRightUp * math::kDegree,
            "Head up and right side up more than usual: the " + roles::SpokenName(bowel->role) + " lies " +
                (nearest < 0.001 ? "on" : Mm(nearest) + " from") + " the gallbladder and is to fall away."};
  }
  return {
      kUsualHeadUp * math::kDegree, kUsualRightUp * math::kDegree,
      bowel != nullptr ? "As usual: no bowel lies on the gallbladder." : "As usual: no bowel is outlined."};
}

/// By how much a place breaks each rule [m]; 0: not at all. `why` says the first that is broken.
struct Breach {
  double worst = 0;
  std::string why;
  void Add(double amount, const std::string& reason) {
    if (amount <= worst) return;
    worst = amount;
    why = reason;
  }
};

Breach FindBreach(const patient::Patient& patient, const Wall& wall, patient::PortUse use,
                  const math::Vec3& place) {
  Breach breach;
  const double distance = math::Distance(place, PlaceOf(patient, roles::LandmarkRole::kInfundibulum));
  const bool is_laparoscope = use == patient::PortUse::kLaparoscope;
  const double least = is_laparoscope ? kNearest : kLeastReach,
               most = is_laparoscope ? kFarthest : kMostReach;
  breach.Add(distance - most,
             "the neck of the gallbladder would lie " + Mm(distance) + " away, more than " + Mm(most));
  breach.Add(least - distance,
             "the neck of the gallbladder would lie " + Mm(distance) + " away, less than " + Mm(least));
  for (const patient::Port& other : patient.ports) {
    if (other.use == use) continue;
    const double apart = math::Distance(other.position, place);
    breach.Add(kPortGap - apart, "another port would lie " + Mm(apart) + " away, less than " + Mm(kPortGap));
  }
  std::string ignored;
  breach.Add(place.y - wall.MostCranial(place, ignored), "it would lie on the ribs or over the liver's edge");
  return breach;
}

}  // namespace

base::Result<patient::Port> MovePort(const patient::Patient& patient, patient::PortUse use, double x,
                                     double y) {
  const patient::Port* now = patient.PortOf(use);
  if (now == nullptr || patient.LandmarkOf(roles::LandmarkRole::kInfundibulum) == nullptr)
    return base::Error{base::ErrorCode::kEditRefused,
                       "the patient has no such port, or no neck of the gallbladder"};
  const Wall wall({}, patient);
  patient::Port port{use, wall.PlaceAt(x, y), {}};
  const Breach breach = FindBreach(patient, wall, use, port.position);
  // a proposal that had to break a rule may be made better
  constexpr double kRounding = 1e-9;
  if (breach.worst > FindBreach(patient, wall, use, now->position).worst + kRounding)
    return base::Error{base::ErrorCode::kEditRefused, "The port stays: " + breach.why + "."};
  char text[96];
  std::snprintf(text, sizeof text, "Placed by hand; the neck of the gallbladder lies %.0f mm away.",
                1000 * math::Distance(port.position, PlaceOf(patient, roles::LandmarkRole::kInfundibulum)));
  port.reason = text;
  return port;
}

double FindMidline(const patient::Patient& patient, const BodyShape& body) {
  return body.midline.value_or(PlaceOf(patient, roles::LandmarkRole::kFundus).x - kUsualFundus.x);
}

void PlacePorts(const BodyShape& body, patient::Patient& patient) {
  Navel navel = FindNavel(patient, body);
  patient.table = PlaceTable(patient);
  patient.ports.clear();
  if (navel.is_usual) {
    // an assembled patient stands as usual: its origin is the navel
    for (std::size_t use = 0; use < patient::kPortUseCount; ++use) {
      patient.ports.push_back({static_cast<patient::PortUse>(use), kUsualPorts[use],
                               use == 0 ? "At the navel: " + navel.reason + "."
                                        : "At its usual place: the images say nothing of this body's wall."});
    }
    return;
  }
  MoveBy(-navel.place, patient);
  const double midline = FindMidline(patient, body) - (body.midline ? navel.place.x : 0.0);
  navel.place = {};
  const Wall wall(navel.place, patient);
  const math::Vec3 neck = PlaceOf(patient, roles::LandmarkRole::kInfundibulum);
  patient.ports.push_back(PlaceLaparoscope(navel, neck, wall));
  for (const patient::PortUse use :
       {patient::PortUse::kLeftHand, patient::PortUse::kRightHand, patient::PortUse::kAssistant})
    patient.ports.push_back(PlaceWorking(use, patient, midline, wall, patient.ports));
  for (patient::Landmark& landmark : patient.landmarks) {
    if (landmark.role == roles::LandmarkRole::kUmbilicus) landmark.position = navel.place;
  }
}

std::vector<std::string> SinkUnderGas(patient::Patient& patient) {
  // ways that must be free: from each port to the gallbladder, the wider the farther from it
  constexpr double kWide = 0.016, kFade = 0.050, kNarrowFrom = 0.045, kMostSinking = 0.070, kCell = 0.004;
  std::vector<math::Vec3> targets;
  for (const roles::LandmarkRole role :
       {roles::LandmarkRole::kFundus, roles::LandmarkRole::kGallbladderBody,
        roles::LandmarkRole::kInfundibulum, roles::LandmarkRole::kHepatocysticTriangle}) {
    if (const patient::Landmark* landmark = patient.LandmarkOf(role)) targets.push_back(landmark->position);
  }
  // how far each column of the body must sink
  std::map<std::pair<int, int>, double> needs;
  for (const patient::Neighbour& neighbour : patient.neighbours) {
    if (!Sinks(neighbour.role)) continue;
    for (const math::Vec3& v : neighbour.mesh.positions) {
      double need = 0;
      for (const patient::Port& port : patient.ports) {
        for (const math::Vec3& target : targets) {
          const math::Vec3 way = target - port.position;
          const double t = std::clamp(((v.x - port.position.x) * way.x + (v.y - port.position.y) * way.y) /
                                          (way.x * way.x + way.y * way.y),
                                      0.0, 1.0);
          const math::Vec3 on = port.position + t * way;
          const double wide = kWide * std::min(1.0, (1.0 - t) * math::Norm(way) / kNarrowFrom);
          const double aside = Hypot(v.x - on.x, v.y - on.y);
          if (aside < wide) need = std::max(need, v.z - (on.z - wide));
        }
      }
      if (need <= 0) continue;
      double& cell = needs[{base::FloorTo<int>(v.x / kCell), base::FloorTo<int>(v.y / kCell)}];
      cell = std::max(cell, std::min(need, kMostSinking));
    }
  }
  if (needs.empty()) return {};
  const auto sinking = [&](const math::Vec3& p) {
    double most = 0;
    for (const auto& [cell, need] : needs) {
      const double aside = Hypot(p.x - (cell.first + 0.5) * kCell, p.y - (cell.second + 0.5) * kCell);
      if (aside >= kFade) continue;
      const double share = 1.0 - aside / kFade;
      most = std::max(most, need * std::min(1.0, 1.15 * share * share * (3.0 - 2.0 * share)));
    }
    return most;
  };
  std::vector<std::string> notes;
  for (patient::Neighbour& neighbour : patient.neighbours) {
    if (!Sinks(neighbour.role)) continue;
    double most = 0;
    for (math::Vec3& p : neighbour.mesh.positions) {
      const double depth = sinking(p);
      p.z -= depth;
      most = std::max(most, depth);
    }
    if (most < 0.001) continue;
    notes.push_back("Under the gas the " + roles::SpokenName(neighbour.role) + " sinks by up to " + Mm(most) +
                    ", out of the way from the ports to the gallbladder.");
  }
  return notes;
}

}  // namespace trocar::anatomy
