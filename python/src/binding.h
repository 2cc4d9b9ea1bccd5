// SPDX-License-Identifier: Apache-2.0
/// \file binding.h  Helpers that the parts of the Python module share: errors as exceptions, vectors as arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <exception>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "guard.h"
#include "trocar/base/result.h"
#include "trocar/host/printable_output.h"
#include "trocar/math/pose.h"

namespace trocar::python {

namespace py = pybind11;

/// Leaves a function of the module as trocar.Error.
class Failure : public std::exception {
 public:
  /// Names of files and fields in its message are printable within their line: a traceback goes to a terminal.
  explicit Failure(base::Error error)
      : error_{error.code, host::PrintableLine(error.message)}, text_(error_.Text()) {}
  const char* what() const noexcept override { return text_.c_str(); }
  const base::Error& Get() const { return error_; }

 private:
  base::Error error_;
  std::string text_;
};

template <typename T>
T Take(base::Result<T> result) {
  if (!result.ok()) throw Failure(result.error());
  return std::move(result).value();
}
inline void Check(const base::Status& status) {
  if (!status.ok()) throw Failure(status.error());
}

/// (3)
inline py::array_t<double> ToArray(const math::Vec3& v) {
  py::array_t<double> array(3);
  double* to = array.mutable_data();
  to[0] = v.x, to[1] = v.y, to[2] = v.z;
  return array;
}
/// (4) w, x, y, z
inline py::array_t<double> ToArray(const math::Quaternion& q) {
  py::array_t<double> array(4);
  double* to = array.mutable_data();
  to[0] = q.w, to[1] = q.x, to[2] = q.y, to[3] = q.z;
  return array;
}
/// (4, 4) homogeneous
py::array_t<double> ToMatrix(const math::Pose& pose);
/// (n, 3)
py::array_t<double> ToArray(std::span<const math::Vec3> points);

void BindErrors(py::module_& module);
void BindSimulation(py::module_& module);
void BindEnvironment(py::module_& module);
void BindPicture(py::module_& module);

}  // namespace trocar::python
