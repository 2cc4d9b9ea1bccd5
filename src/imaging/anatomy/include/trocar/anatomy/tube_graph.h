// SPDX-License-Identifier: Apache-2.0
/// \file tube_graph.h  Ducts and arteries as one graph: tubes that meet in shared nodes, organs that they
/// enter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// A tube's end is joined where it lies no further than this from what it names [m].
inline constexpr double kJoinReach = 0.003;

/// Both ends of a tube.
enum class TubeEnd { kFrom, kTo };

/// A point of a tube's centre line.
struct TubeVertex {
  std::uint32_t tube = 0;
  std::uint32_t point = 0;

  friend bool operator==(const TubeVertex&, const TubeVertex&) = default;
};

/// A place where tubes meet, or where one ends.
struct TubeNode {
  enum class Kind {
    kJoint,   ///< of two tubes or more
    kOrgan,   ///< an end that enters an organ
    kOpen,    ///< an end that leaves the scene
    kNowhere  ///< an end that names what is not there, itself, or what lies too far away
  };
  Kind kind = Kind::kJoint;
  int organ = -1;                    ///< of kOrgan
  std::vector<TubeVertex> vertices;  ///< what lies in this place, ascending by tube; at least one
};

/// A piece of a tube between two nodes.
struct TubePiece {
  std::uint32_t tube = 0;
  std::uint32_t first = 0, last = 0;  ///< points of its centre line, first < last
  std::uint32_t from = 0, to = 0;     ///< nodes
};

struct TubeGraph {
  std::vector<TubeNode> nodes;
  std::vector<TubePiece> pieces;  ///< by tube, from its first point to its last
};

/// Works out who meets whom, by the names and by the places. An end that names another tube meets that tube's
/// nearest point; tubes whose lines are not usable (fewer than two points, not finite) are left out.
/// Ends that name an organ count as joined to it: whether they reach it is the linter's question.
TubeGraph MakeTubeGraph(const patient::Patient& patient);

/// Tubes with an end in the organ, ascending; each once.
/// \return indices into patient.tubes
std::vector<std::uint32_t> FindEnteringTubes(const patient::Patient& patient, const TubeGraph& graph,
                                             roles::OrganRole organ);

/// Tubes of a kind that can be reached from a tube along tubes of that kind, itself included, ascending.
std::vector<std::uint32_t> FindConnectedTubes(const patient::Patient& patient, const TubeGraph& graph,
                                              std::uint32_t tube);

/// Tubes on a closed way along tubes of one kind: bile and blood branch as trees, so there should be none.
/// Ways that pass through an organ do not count. Ascending.
std::vector<std::uint32_t> FindCycleTubes(const patient::Patient& patient, const TubeGraph& graph);

/// An end that does not meet what it names.
struct OpenJoint {
  std::uint32_t tube = 0;
  TubeEnd end = TubeEnd::kFrom;
  double gap = 0;  ///< [m]
};

/// Makes every joint exact: an end that names another tube and lies within `reach` of its skin moves onto the
/// nearest point of its centre line, an end that names an organ onto its surface (or stays inside the liver).
/// Neighbouring points follow by a falling share, so that no kink appears.
/// \return the ends that lie further away; they stay as they are
std::vector<OpenJoint> JoinTubes(patient::Patient& patient, double reach = kJoinReach);

}  // namespace trocar::anatomy
