// SPDX-License-Identifier: Apache-2.0
/// \file result.h  A value, or an error with a stable code and a message that names the remedy.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "trocar/base/assert.h"
#include "trocar/base/error_codes.h"

namespace trocar::base {

/// Error: its code, and a message that says what went wrong, where, and what to do next. Never holds patient data.
struct Error {
  ErrorCode code = ErrorCode::kNone;
  std::string message;

  /// "E-IMG-002 slice 0561 is missing in ...: ..."
  std::string Text() const { return std::string(CodeText(code)) + " " + message; }
};

/// A T or an Error; the same shape as std::expected, which C++20 lacks.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT: a value is a result
  Result(Error error) : content_(std::move(error)) {}  // NOLINT: an error is a result

  bool ok() const noexcept { return content_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }

  /// \pre ok() (TROCAR_ASSERT)
  T& value() & {
    TROCAR_ASSERT(ok());
    return *std::get_if<T>(&content_);
  }
  const T& value() const& {
    TROCAR_ASSERT(ok());
    return *std::get_if<T>(&content_);
  }
  T&& value() && {
    TROCAR_ASSERT(ok());
    return std::move(*std::get_if<T>(&content_));
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  /// \pre !ok() (TROCAR_ASSERT)
  const Error& error() const {
    TROCAR_ASSERT(!ok());
    return *std::get_if<Error>(&content_);
  }

 private:
  std::variant<T, Error> content_;
};

/// Success without a value, or an error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT: an error is a result

  bool ok() const noexcept { return !error_.has_value(); }
  explicit operator bool() const noexcept { return ok(); }
  const Error& error() const {
    TROCAR_ASSERT(!ok());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

using Status = Result<void>;

}  // namespace trocar::base
