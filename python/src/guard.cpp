// SPDX-License-Identifier: Apache-2.0
#include "guard.h"

#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "binding.h"
#include "trocar/base/assert.h"

namespace trocar::python {
namespace {

constexpr int kChanging = -1;

/// Readers of each object that is in use, or kChanging.
std::unordered_map<const void*, int>& Uses() {
  static std::unordered_map<const void*, int> uses;
  return uses;
}

/// A use for as long as a block of Python: `with Hold(object):`.
class Hold {
 public:
  explicit Hold(py::object object) : object_(std::move(object)) {}
  void Enter() {
    const py::type type = py::type::of(object_);
    const auto* known = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(type.ptr()));
    if (known == nullptr)
      throw Failure({base::ErrorCode::kUsage, "only objects of this module's classes can be held"});
    auto* instance = reinterpret_cast<py::detail::instance*>(object_.ptr());
    use_.emplace().Begin(instance->get_value_and_holder(known).value_ptr(), true, type);
  }
  void Exit() { use_.reset(); }

 private:
  py::object object_;
  std::optional<Use> use_;
};

}  // namespace

void Use::Begin(const void* object, bool changes, py::handle type) {
  TROCAR_ASSERT(PyGILState_Check() == 1 && object_ == nullptr);
  int& uses = Uses()[object];
  if (uses == kChanging || (changes && uses > 0)) {
    throw Failure({base::ErrorCode::kEnvironmentState,
                   "this " + std::string(py::str(type.attr("__name__"))) +
                       " is in the middle of another call; give each thread its own, or let threads take "
                       "turns with a threading.Lock"});
  }
  uses = changes ? kChanging : uses + 1;
  object_ = object;
  changes_ = changes;
}

Use::~Use() {
  if (object_ == nullptr) return;
  const auto at = Uses().find(object_);
  if (changes_ || --at->second == 0) Uses().erase(at);
}

void BindGuard(py::module_& module) {
  py::class_<Hold>(module, "Hold",
                   "Marks an object as in the middle of a call for as long as a with block lasts; for tests.")
      .def(py::init<py::object>(), py::arg("object"))
      .def("__enter__", &Hold::Enter)
      .def("__exit__", [](Hold& hold, const py::args&) { hold.Exit(); });
}

}  // namespace trocar::python
