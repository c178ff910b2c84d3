#include "bench/reference/stacks.hpp"

#include "bench/reference/direct.hpp"
#include "bench/reference/residual.hpp"

namespace cycloid::reference {

Assembled stack_of_circles(const std::vector<double>& masses, double gravity, double step_s) {
  const int n = static_cast<int>(masses.size());
  std::vector<double> jacobian(static_cast<std::size_t>(n) * n, 0.0);
  std::vector<double> inverse_mass(n);
  for (int i = 0; i < n; ++i) {
    jacobian[static_cast<std::size_t>(i) * n + i] = 1.0;
    if (i > 0) jacobian[static_cast<std::size_t>(i) * n + i - 1] = -1.0;
    inverse_mass[i] = 1.0 / masses[i];
  }
  return assemble(n, jacobian, inverse_mass, std::vector<double>(n, -gravity * step_s));
}

Assembled box_on_pole(double half_width, double contact_offset, double speed) {
  const double inertia = 2.0 / 3.0 * half_width * half_width;
  return assemble(2, {1.0, -contact_offset, 1.0, contact_offset}, {1.0, 1.0 / inertia},
                  {-speed, 0.0});
}

template <class Real>
int sweeps_to(const Mlcp& problem, double tolerance, const PgsOptions& options) {
  const DirectResult exact = solve_direct(problem);
  if (!exact.converged || exact.rank_deficient) return 0;
  int sweeps = 0;
  projected_gauss_seidel(problem, options, std::vector<Real>(problem.n, Real(0)),
                         [&](int sweep, const std::vector<Real>& lambda) {
                           const std::vector<double> widened(lambda.begin(), lambda.end());
                           if (impulse_error(widened, exact.lambda).max <= tolerance)
                             sweeps = sweep;
                           return sweeps == 0;
                         });
  return sweeps;
}

template int sweeps_to<float>(const Mlcp&, double, const PgsOptions&);
template int sweeps_to<double>(const Mlcp&, double, const PgsOptions&);

}  // namespace cycloid::reference
