// SPDX-License-Identifier: Apache-2.0
// Planted violations, one a line marked "wrong": check_names.sh expects clang-tidy to find every one of them.
namespace trocar::Tissue {  // wrong

constexpr double largest_step = 0.1;  // wrong

enum class solver_kind {  // wrong
  Relaxation              // wrong
};

struct spring_data {      // wrong
  double RestLength = 0;  // wrong
};

class Solver {
 public:
  double calc_step(double Local) const {  // wrong
    return Local * step;
  }

 private:
  double step = largest_step;  // wrong
};

double calcForce(const spring_data& spring) {  // wrong
  const double worldTool = spring.RestLength;  // wrong
  return worldTool + Solver().calc_step(1) * static_cast<double>(solver_kind::Relaxation);
}

}  // namespace trocar::Tissue
