// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/scene_fields.h"

#include "trocar/base/state_hash.h"

namespace trocar::scene {
namespace {

class Hasher {
 public:
  template <typename T>
  void Value(const T& value) {
    if constexpr (std::is_same_v<T, std::string>) {
      hash_.Add(std::uint64_t{value.size()});
      for (const char letter : value)
        hash_.Add(static_cast<std::uint64_t>(static_cast<unsigned char>(letter)));
    } else if constexpr (std::is_floating_point_v<T>) {
      hash_.Add(static_cast<double>(value));
    } else {
      hash_.Add(static_cast<std::uint64_t>(value));
    }
  }
  template <typename List>
  void Length(const List& list) {
    hash_.Add(std::uint64_t{list.size()});
  }
  template <typename Perhaps>
  void Presence(const Perhaps& perhaps) {
    hash_.Add(std::uint64_t{perhaps.has_value()});
  }
  template <typename Either>
  void Choice(const Either& either) {
    hash_.Add(std::uint64_t{either.index()});
  }

  std::uint64_t Hash() const { return hash_.Value(); }

 private:
  base::StateHash hash_;
};

}  // namespace

std::uint64_t CalcSceneFingerprint(const Scene& scene) {
  Hasher hasher;
  VisitFields(scene, hasher);
  return hasher.Hash();
}

}  // namespace trocar::scene
