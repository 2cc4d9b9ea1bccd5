// SPDX-License-Identifier: Apache-2.0
// Checked by check_names.sh: nothing to complain about here.
namespace trocar::tissue {

constexpr double kLargestStep = 0.1;

enum class SolverKind { kRelaxation, kChebyshev };

struct Spring {
  double rest_length = 0;
};

class Solver {
 public:
  double CalcStep(double K_local) const { return K_local * step_; }

 private:
  double step_ = kLargestStep;
};

double CalcForce(const Spring& spring, double length) {
  const double X_world_tool = length - spring.rest_length;
  return X_world_tool + Solver().CalcStep(1) * static_cast<double>(SolverKind::kChebyshev);
}

}  // namespace trocar::tissue
