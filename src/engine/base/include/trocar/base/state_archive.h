// SPDX-License-Identifier: Apache-2.0
/// \file state_archive.h  One list of fields for everything that is done with a state: save, restore, hash, compare.
///
/// A type whose content decides the future lists its fields once, in a member `void VisitState(StateArchive&)` or a
/// free function `void VisitState(StateArchive&, T&)`. What is not listed is neither saved nor hashed: it has to be
/// constant, or be made anew from the listed fields when a state has been restored.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "trocar/base/state_hash.h"

namespace trocar::base {

/// Whether the bytes of a T are its value: no padding, no pointer, no invariant. Specialised for small structs of
/// numbers (math/state_fields.h does it for vectors and poses).
template <typename T>
inline constexpr bool kIsPlainState = std::is_arithmetic_v<T> || std::is_enum_v<T>;
/// A byte that is neither 0 nor 1 is no bool: it is read as a number and compared.
template <>
inline constexpr bool kIsPlainState<bool> = false;
/// Sizes and counts go as eight bytes, also where they have four.
template <>
inline constexpr bool kIsPlainState<std::size_t> = sizeof(std::size_t) == sizeof(std::uint64_t);

class StateArchive {
 public:
  enum class Mode : std::uint8_t { kSave, kRestore, kHash };

  /// Appends to `bytes`; what was in it stays.
  static StateArchive ForSave(std::vector<std::byte>& bytes);
  /// Reads what ForSave wrote, from the same list of fields. \param bytes  have to outlive the archive
  static StateArchive ForRestore(std::span<const std::byte> bytes);
  static StateArchive ForHash(StateHash& hash);

  Mode GetMode() const noexcept { return mode_; }
  bool IsRestoring() const noexcept { return mode_ == Mode::kRestore; }

  /// One field: a plain value, a string, a vector, array or optional of what can be a field, or a type with VisitState.
  /// \param name  unique among its neighbours; a literal
  template <typename T>
  void Field(std::string_view name, T& value) {
    Enter(name);
    // a class leaves out the fields of which it consists
    if constexpr (std::is_copy_constructible_v<T> && !requires { value.VisitState(*this); }) {
      if (IsOmitted()) {
        T other = value;
        Visit(other);
        Leave();
        return;
      }
    }
    Visit(value);
    Leave();
  }

  /// A vector whose length the model gives: bytes that claim another are refused, and `value` keeps its length. Of a
  /// vector of vectors every length is the model's.
  template <typename T>
  void FixedField(std::string_view name, std::vector<T>& value) {
    Enter(name);
    if constexpr (std::is_copy_constructible_v<T>) {
      if (IsOmitted()) {
        std::vector<T> other = value;
        VisitFixed(other);
        Leave();
        return;
      }
    }
    VisitFixed(value);
    Leave();
  }

  /// Reports that what was read is no state of this model. Every later field keeps its value.
  void Fail(std::string reason);
  bool ok() const noexcept { return failure_.empty(); }
  /// Path of the field and the reason; empty while all is well.
  const std::string& Failure() const noexcept { return failure_; }
  /// When restoring: nothing of the bytes is left.
  bool IsAtEnd() const noexcept { return read_ == source_.size(); }

  // --- for tests, and to find what differs

  /// Restores every field but this one, which keeps its value. \param path  "tissue/position"
  void Omit(std::string path) { omitted_ = std::move(path); }
  /// Calls back after each field that has no fields of its own, with its path and a hash of its value alone.
  void Trace(std::function<void(const std::string& path, std::uint64_t hash)> trace) {
    trace_ = std::move(trace);
  }

 private:
  explicit StateArchive(Mode mode) : mode_(mode) {}

  template <typename T>
  struct IsVector : std::false_type {};
  template <typename T>
  struct IsVector<std::vector<T>> : std::true_type {};
  template <typename T>
  struct IsArray : std::false_type {};
  template <typename T, std::size_t n>
  struct IsArray<std::array<T, n>> : std::true_type {};
  template <typename T>
  struct IsOptional : std::false_type {};
  template <typename T>
  struct IsOptional<std::optional<T>> : std::true_type {};

  template <typename T>
  void Visit(T& value) {
    if constexpr (kIsPlainState<T>) {
      Bytes(&value, sizeof(T));
    } else if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = value ? 1 : 0;
      Bytes(&byte, 1);
      if (IsRestoring() && ok()) value = byte != 0;
    } else if constexpr (std::is_same_v<T, std::size_t>) {
      std::uint64_t word = value;
      Bytes(&word, sizeof(word));
      if (IsRestoring() && ok()) value = static_cast<std::size_t>(word);
    } else if constexpr (std::is_same_v<T, std::string>) {
      value.resize(Count(value.size(), 1));
      Bytes(value.data(), value.size());
    } else if constexpr (IsVector<T>::value) {
      using Element = typename T::value_type;
      static_assert(!std::is_same_v<Element, bool>, "a vector of bool has no bytes: use std::uint8_t");
      if constexpr (kIsPlainState<Element>) {
        const std::size_t count = Count(value.size(), sizeof(Element));
        if (IsRestoring()) value.resize(count);
        Bytes(value.data(), value.size() * sizeof(Element));
      } else {
        const std::size_t count = Count(value.size(), 1);
        if constexpr (std::is_default_constructible_v<Element>) {
          if (IsRestoring()) value.resize(count);
        } else if (count != value.size()) {
          Fail("has another length");
          return;
        }
        for (Element& element : value) Visit(element);
      }
    } else if constexpr (IsArray<T>::value) {
      if constexpr (kIsPlainState<typename T::value_type>) {
        Bytes(value.data(), sizeof(T));
      } else {
        for (auto& element : value) Visit(element);
      }
    } else if constexpr (IsOptional<T>::value) {
      std::uint8_t has = value.has_value() ? 1 : 0;
      Bytes(&has, 1);
      if (IsRestoring()) {
        if (has == 0) value.reset();
        if constexpr (std::is_default_constructible_v<typename T::value_type>) {
          if (has != 0 && !value) value.emplace();
        } else if ((has != 0) != value.has_value()) {
          Fail("is there in one state and not in the other");
          return;
        }
      }
      if (value) Visit(*value);
    } else if constexpr (requires { value.VisitState(*this); }) {
      value.VisitState(*this);
    } else {
      VisitState(*this, value);
    }
  }

  template <typename T>
  void VisitFixed(std::vector<T>& value) {
    const std::size_t count = Count(value.size(), 1);
    if (count != value.size()) {
      Fail("has " + std::to_string(count) + " elements where the model has " + std::to_string(value.size()));
      return;
    }
    if constexpr (kIsPlainState<T>) {
      Bytes(value.data(), value.size() * sizeof(T));
    } else {
      for (T& element : value) {
        if constexpr (IsVector<T>::value) {
          VisitFixed(element);
        } else {
          Visit(element);
        }
      }
    }
  }

  void Enter(std::string_view name);
  void Leave();
  bool IsOmitted() const noexcept {
    return !omitted_.empty() && IsRestoring() && path_.compare(0, omitted_.size(), omitted_) == 0 &&
           (path_.size() == omitted_.size() || path_[omitted_.size()] == '/');
  }
  void Bytes(void* data, std::size_t size);
  /// The count of elements that follow: written, or read and checked against what is left of the bytes.
  std::size_t Count(std::size_t now, std::size_t least_bytes_each);

  Mode mode_;
  std::vector<std::byte>* target_ = nullptr;
  std::span<const std::byte> source_;
  std::size_t read_ = 0;
  StateHash* hash_ = nullptr;
  std::string failure_;

  /// Saving and hashing are done every few ticks; only restoring and tracing name what they visit.
  bool KeepsPaths() const noexcept { return IsRestoring() || trace_; }

  std::string path_, omitted_;
  std::vector<std::size_t> path_ends_;
  std::function<void(const std::string&, std::uint64_t)> trace_;
  StateHash field_hash_;
  bool is_leaf_ = false;
};

/// Fingerprint of a state as its VisitState lists it.
template <typename T>
void AddStateTo(StateHash& hash, const T& state) {
  StateArchive archive = StateArchive::ForHash(hash);
  archive.Field("state", const_cast<T&>(state));  // hashing reads only
}

/// Appends a state as its VisitState lists it.
template <typename T>
void SaveState(const T& state, std::vector<std::byte>& bytes) {
  StateArchive archive = StateArchive::ForSave(bytes);
  archive.Field("state", const_cast<T&>(state));  // saving reads only
}

}  // namespace trocar::base
