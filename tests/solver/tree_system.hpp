#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "solver/direct/tree_solver.hpp"

namespace cycloid::solver {

/// Bodies at points of space, joints between them, and a solve of them. Body 0 does not move.
template <int D>
struct TreeSystem {
  static constexpr int kFreedoms = JointBlock<D>::kFreedoms;
  std::vector<JointBlock<D>> joints;
  std::vector<BodyMass<D>> masses;
  std::vector<Vec<D>> positions;
  std::vector<float> rhs;
  std::vector<float> lambda;
  TreeSolver<D> solver;

  TreeSystem() { add_body(0.0f, 0.0f, Vec<D>::zero()); }

  /// `inertia` is that about every axis before -1/10 of its inverse couples them; 0 is infinite, as
  /// for the mass.
  std::uint32_t add_body(float mass, float inertia, Vec<D> position) {
    BodyMass<D> body{};
    body.inverse_mass = mass > 0.0f ? 1.0f / mass : 0.0f;
    for (int i = 0; i < Dim<D>::kSpin; ++i)
      for (int k = 0; k < Dim<D>::kSpin && inertia > 0.0f; ++k)
        body.inverse_inertia.m[i * Dim<D>::kSpin + k] = (i == k ? 1.0f : -0.1f) / inertia;
    masses.push_back(body);
    positions.push_back(position);
    return static_cast<std::uint32_t>(masses.size() - 1);
  }

  /// The first `rows` of: the D rows of a common point, then the rows of a common rotation.
  JointBlock<D>& add_joint(std::uint32_t a, std::uint32_t b, Vec<D> point, int rows) {
    JointBlock<D> joint{};
    joint.body_a = a;
    joint.body_b = b;
    joint.rows = rows;
    for (int i = 0; i < kFreedoms; ++i) {
      Spin<D> spin = Spin<D>::zero();
      Vec<D> shift = Vec<D>::zero();
      (i < D ? shift[i] : spin[i - D]) = 1.0f;
      const Vec<D> at_a = shift + spin_cross(spin, point - positions[a]);
      const Vec<D> at_b = shift + spin_cross(spin, point - positions[b]);
      for (int row = 0; row < rows; ++row) {
        joint.j_a[row][i] = row < D ? -at_a[row] : -spin[row - D];
        joint.j_b[row][i] = row < D ? at_b[row] : spin[row - D];
      }
    }
    joints.push_back(joint);
    rhs.resize(joints.size() * kFreedoms, 0.0f);
    return joints.back();
  }

  void solve() {
    solver.analyse(joints, masses);
    solver.factor(joints, masses);
    lambda.assign(rhs.size(), -1.0f);
    solver.solve(rhs, lambda);
  }

  /// Rows of the joints in trees; other rows are zero.
  Eigen::MatrixXd jacobian() const {
    const int columns = static_cast<int>(masses.size()) * kFreedoms;
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(static_cast<int>(rhs.size()), columns);
    for (int i = 0; i < static_cast<int>(joints.size()); ++i)
      for (int row = 0; solver.in_tree(i) && row < joints[i].rows; ++row)
        for (int f = 0; f < kFreedoms; ++f) {
          const JointBlock<D>& joint = joints[i];
          j(i * kFreedoms + row, static_cast<int>(joint.body_a) * kFreedoms + f) +=
              static_cast<double>(joint.j_a[row][f]);
          j(i * kFreedoms + row, static_cast<int>(joint.body_b) * kFreedoms + f) +=
              static_cast<double>(joint.j_b[row][f]);
        }
    return j;
  }

  Eigen::MatrixXd inverse_mass() const {
    const int size = static_cast<int>(masses.size()) * kFreedoms;
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(size, size);
    for (int b = 0; b < static_cast<int>(masses.size()); ++b)
      for (int i = 0; i < kFreedoms; ++i)
        for (int k = 0; k < kFreedoms; ++k) {
          const bool linear = i < D && i == k;
          const int spin = (i - D) * Dim<D>::kSpin + k - D;
          if (linear) inverse(b * kFreedoms + i, b * kFreedoms + k) = masses[b].inverse_mass;
          if (i >= D && k >= D)
            inverse(b * kFreedoms + i, b * kFreedoms + k) = masses[b].inverse_inertia.m[spin];
        }
    return inverse;
  }

  Eigen::VectorXd softness() const {
    Eigen::VectorXd s = Eigen::VectorXd::Zero(static_cast<int>(rhs.size()));
    for (int i = 0; i < static_cast<int>(joints.size()); ++i)
      for (int row = 0; row < joints[i].rows; ++row)
        s[i * kFreedoms + row] = static_cast<double>(joints[i].softness[row]);
    return s;
  }

  static Eigen::VectorXd in_double(const std::vector<float>& values) {
    Eigen::VectorXd result(static_cast<int>(values.size()));
    for (int i = 0; i < result.size(); ++i) result[i] = static_cast<double>(values[i]);
    return result;
  }

  /// Impulses by a dense solve in double. Precondition: independent rows.
  Eigen::VectorXd exact() const {
    const Eigen::MatrixXd j = jacobian();
    Eigen::MatrixXd a = j * inverse_mass() * j.transpose();
    Eigen::VectorXd r = in_double(rhs);
    for (int i = 0; i < a.rows(); ++i) {
      a(i, i) += softness()[i];
      if (!j.row(i).isZero(0.0)) continue;
      a(i, i) = 1.0;
      r[i] = 0.0;
    }
    return a.partialPivLu().solve(r);
  }

  /// Largest miss of a row by the velocities that the solver computed.
  double error_of_velocities() const {
    Eigen::VectorXd change(static_cast<int>(masses.size()) * kFreedoms);
    for (int i = 0; i < change.size(); ++i)
      change[i] = static_cast<double>(
          solver.velocity_change(static_cast<std::uint32_t>(i / kFreedoms), i % kFreedoms));
    return error_of(change);
  }

  /// Largest miss of a row by the velocities that follow from the impulses.
  double error_of_impulses() const {
    return error_of(inverse_mass() * (jacobian().transpose() * in_double(lambda)));
  }

  /// Largest error of an impulse relative to the largest impulse.
  double relative_impulse_error() const {
    const Eigen::VectorXd truth = exact();
    return (in_double(lambda) - truth).cwiseAbs().maxCoeff() / truth.cwiseAbs().maxCoeff();
  }

 private:
  double error_of(const Eigen::VectorXd& change) const {
    const Eigen::MatrixXd j = jacobian();
    const Eigen::VectorXd soft = softness().cwiseProduct(in_double(lambda));
    const Eigen::VectorXd error = j * change + soft - in_double(rhs);
    double largest = 0.0;
    for (int i = 0; i < error.size(); ++i)
      if (!j.row(i).isZero(0.0)) largest = std::max(largest, std::abs(error[i]));
    return largest;
  }
};

}  // namespace cycloid::solver
