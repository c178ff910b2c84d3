#pragma once

#include <vector>

#include "bench/accuracy/contact_problem.hpp"
#include "bench/accuracy/measure.hpp"
#include "bench/trials/motions.hpp"

namespace cycloid::accuracy {

/// Of many sizes; changes their order.
Spread spread_of(std::vector<double>& sizes);

/// The sum of momenta and of their sizes; angular about the common centre of mass.
struct Momenta {
  std::array<double, 3> linear{};   ///< kg m/s
  std::array<double, 3> angular{};  ///< kg m^2/s; in the plane the last number.
  double linear_size = 0.0;
  double angular_size = 0.0;
};
template <int D>
Momenta momenta_of(const solver::WorldState<D>& state);

/// How far contacts creep that stick: the tangential motion of their material points, from poses.
template <int D>
class StickDrift {
 public:
  /// After every tick of the time that is measured. A contact that does not stick in `problem`, or
  /// was not there at the first call, drops out.
  void look(const solver::WorldState<D>& state, const ContactProblem<D>& problem);
  /// The farthest, m per tick between the calls; nothing where no contact has stuck through two of
  /// them or more.
  std::optional<double> farthest_m_per_tick() const;

 private:
  struct Sticking {
    std::uint32_t shape_a;
    std::uint32_t shape_b;
    solver::Vec<D> at_a;  ///< The points that touched after the last tick, frames of the bodies.
    solver::Vec<D> at_b;
    solver::Vec<D> normal;
    solver::Vec<D> crept;  ///< World, m.
  };
  std::vector<Sticking> sticking_;
  int looks_ = 0;
};

/// Watches one run, tick after tick, and says what was wrong in it.
template <int D>
class Observer {
 public:
  /// @param start  the state at tick 0.
  /// @param acted_on  is_acted_on: something acts on the bodies of which no state tells.
  Observer(const solver::WorldState<D>& start, std::uint32_t ticks, bool acted_on,
           const MeasureOptions& options);
  /// After every tick. @returns false where the world is no longer finite.
  bool look(const solver::WorldState<D>& state, std::uint32_t tick);
  /// What was seen. @param end  the last state.
  Metrics finish(const solver::WorldState<D>& end);

 private:
  void look_at_momenta(const solver::WorldState<D>& state, std::uint32_t tick);
  void look_at_poses(const solver::WorldState<D>& state, bool steady);
  void look_at_impulses(const solver::WorldState<D>& state, bool measured);

  MeasureOptions options_;
  std::uint32_t ticks_;
  std::uint32_t steady_from_;  ///< The last tick of the transient time.
  bool has_impulses_;
  bool keeps_momentum_;                  ///< Nothing pushes the bodies from outside.
  bool keeps_angular_;                   ///< Nor turns them.
  bool is_driven_;                       ///< Something may bring energy in.
  bool has_looked_[2] = {false, false};  ///< At poses: transient, steady.
  double energy_start_j_;
  double kinetic_max_j_ = 0.0;
  Momenta momenta_start_;
  solver::Vec<D> weight_;                        ///< N
  std::vector<solver::Vec<D>> positions_start_;  ///< By slot.
  double linear_drift_ = 0.0;
  double angular_drift_ = 0.0;
  double linear_size_ = 0.0;
  double angular_size_ = 0.0;
  double speed_squares_ = 0.0;
  std::uint64_t speeds_ = 0;
  std::vector<double> depths_[2];  ///< Transient, steady.
  std::vector<double> gaps_[2];
  StickDrift<D> stick_;
  Metrics metrics_;
};

}  // namespace cycloid::accuracy
