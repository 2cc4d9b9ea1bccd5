// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "binding.h"
#include "trocar/base/simd_choice.h"
#include "trocar/host/version.h"

namespace trocar::python {

py::array_t<double> ToMatrix(const math::Pose& pose) {
  py::array_t<double> array({4, 4});
  auto at = array.mutable_unchecked<2>();
  for (int column = 0; column < 3; ++column) {
    math::Vec3 axis;
    axis[column] = 1;
    const math::Vec3 turned = math::Rotate(pose.rotation, axis);
    for (int row = 0; row < 3; ++row) at(row, column) = turned[row];
    at(column, 3) = pose.translation[column];
    at(3, column) = 0;
  }
  at(3, 3) = 1;
  return array;
}

py::array_t<double> ToArray(std::span<const math::Vec3> points) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
  double* to = array.mutable_data();
  for (const math::Vec3& point : points) {
    *to++ = point.x, *to++ = point.y, *to++ = point.z;
  }
  return array;
}

void BindErrors(py::module_& module) {
  // made by the package, so that it has attributes: python/trocar/errors.py
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Failure& failure) {
      const base::Error& error = failure.Get();
      const auto table = base::ErrorTable();
      const auto entry =
          std::find_if(table.begin(), table.end(), [&](const auto& e) { return e.code == error.code; });
      const py::object type = py::module_::import("trocar.errors").attr("Error");
      const py::object made = type(py::str(std::string(base::CodeText(error.code))), py::str(error.message),
                                   py::str(std::string(entry->meaning)));
      PyErr_SetObject(type.ptr(), made.ptr());
    }
  });
  module.def(
      "error_table",
      [] {
        py::dict table;
        for (const base::ErrorEntry& entry : base::ErrorTable())
          table[py::str(std::string(entry.text))] = std::string(entry.meaning);
        return table;
      },
      "Every error code and its meaning.");
}

}  // namespace trocar::python

PYBIND11_MODULE(_trocar, module) {
  module.doc() = "The compiled part of the package trocar.";
  module.attr("__version__") = trocar::host::VersionText();
  trocar::python::BindErrors(module);
  trocar::python::Check(trocar::base::CheckSimdLevel());
  trocar::python::BindGuard(module);
  trocar::python::BindSimulation(module);
  trocar::python::BindEnvironment(module);
  trocar::python::BindPicture(module);
}
