// SPDX-License-Identifier: Apache-2.0
/// \file guard.h  One thread at a time in each object: calls that change an object exclude all others of it.
///
/// Calls that only read an object go side by side. A call that finds its object taken fails with kEnvironmentState. It does not
/// wait: two threads that take turns by chance would step a simulation in an order that no seed repeats.
#pragma once

#include <pybind11/pybind11.h>

#include <type_traits>

namespace trocar::agent {
class Surgeon;
}
namespace trocar::scene {
struct Input;
}

namespace trocar::python {

namespace py = pybind11;

class Camera;
struct RunningEnvironment;
struct DrawnPool;
struct Running;

/// Every class of the module whose objects change. Of what stands here no bound function gets a reference or a pointer
/// without a Use, which its argument's caster takes; pybind11 keeps the casters until the call has ended.
template <typename T>
inline constexpr bool kIsGuarded =
    std::is_same_v<T, Running> || std::is_same_v<T, RunningEnvironment> || std::is_same_v<T, DrawnPool> ||
    std::is_same_v<T, Camera> || std::is_same_v<T, agent::Surgeon> || std::is_same_v<T, scene::Input>;

/// A call's claim to an object, from Begin until it is destroyed.
/// \pre The GIL is held at both: it guards the table of uses. So bound functions release it inside (gil_scoped_release), and none
///     by py::call_guard, which would release it before arguments are taken.
class Use {
 public:
  Use() = default;
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;
  ~Use();

  /// \param type  the object's, whose name the message gives
  /// \throw Failure kEnvironmentState where another call changes the object, or, if this one is to, where another one uses it
  void Begin(const void* object, bool changes, py::handle type);

 private:
  const void* object_ = nullptr;
  bool changes_ = false;
};

/// Takes an argument `const T&` to be read, `T&` to be changed.
template <typename T>
class GuardedCaster : public py::detail::type_caster_base<T> {
  using Base = py::detail::type_caster_base<T>;

  template <typename Argument>
  struct Taken {
    using Bare = std::remove_reference_t<Argument>;
    static constexpr bool kIsPointer = std::is_pointer_v<Bare>;
    // what is taken by value is copied, that is read
    static constexpr bool kReads = std::is_const_v<std::remove_pointer_t<Bare>> ||
                                   (!kIsPointer && !std::is_lvalue_reference_v<Argument>);
    using Object = std::conditional_t<kReads, const T, T>;
    using Type = std::conditional_t<kIsPointer, Object*, Object&>;
  };

 public:
  template <typename Argument>
  using cast_op_type = typename Taken<Argument>::Type;

  operator T*() { return Take(true); }
  operator const T*() { return Take(false); }
  operator T&() { return TakeOne(true); }
  operator const T&() { return TakeOne(false); }

 private:
  T* Take(bool changes) {
    if (this->value != nullptr) use_.Begin(this->value, changes, py::type::handle_of<T>());
    return static_cast<T*>(this->value);
  }
  T& TakeOne(bool changes) {
    if (this->value == nullptr) throw py::reference_cast_error();
    return *Take(changes);
  }
  Use use_;
};

void BindGuard(py::module_& module);

}  // namespace trocar::python

namespace pybind11::detail {

template <typename T>
class type_caster<T, enable_if_t<trocar::python::kIsGuarded<T>>> : public trocar::python::GuardedCaster<T> {};

}  // namespace pybind11::detail
