// Time of pinocchio::rnea, aba and crba on one core, for dynamics.py.
//
// Arguments: joints, then alpha, a, d of each joint (alpha and a as they lead to that joint), then rounds. Every link has the
// body of our benchmark. Prints the fastest round in nanoseconds for one state of each algorithm, and then what the first two
// and the diagonal of the third give at the state of the first sample, for the comparison.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>

template <typename Work>
double fastest(int rounds, Work work) {
  constexpr int calls = 200;
  double best = 1e300;
  for (int r = 0; r < rounds; ++r) {
    const auto start = std::chrono::steady_clock::now();
    for (int c = 0; c < calls; ++c) work();
    const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - start;
    best = std::min(best, elapsed.count() / calls);
  }
  return best;
}

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const int joints = std::atoi(argv[1]);
  if (joints != 6 || argc != 3 + 3 * joints) return 2;

  pinocchio::Model model;
  pinocchio::JointIndex parent = 0;
  for (int j = 0; j < joints; ++j) {
    const double alpha = std::atof(argv[2 + 3 * j]);
    const double a = std::atof(argv[3 + 3 * j]);
    const double d = std::atof(argv[4 + 3 * j]);
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(alpha, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Eigen::Vector3d origin = Eigen::Vector3d(a, 0, 0) + rotation * Eigen::Vector3d(0, 0, d);
    parent = model.addJoint(parent, pinocchio::JointModelRZ(), pinocchio::SE3(rotation, origin),
                            "joint_" + std::to_string(j));
    const Eigen::Matrix3d inertia = Eigen::Vector3d(0.02, 0.03, 0.03).asDiagonal();
    model.appendBodyToJoint(parent, pinocchio::Inertia(3.0, Eigen::Vector3d(0.1, 0.02, 0.05), inertia),
                            pinocchio::SE3::Identity());
  }
  pinocchio::Data data(model);

  Eigen::VectorXd q(joints), qd(joints), tau(joints);
  q << 0.3, -1.0, 1.2, 0.4, -0.7, 2.0;
  qd.setConstant(0.5);
  tau << 10.0, -30.0, 12.0, 2.0, 1.0, 0.5;
  const int rounds = std::atoi(argv[argc - 1]);
  std::printf("%.3f\n", fastest(rounds, [&] { pinocchio::rnea(model, data, q, qd, tau); }));
  std::printf("%.3f\n", fastest(rounds, [&] { pinocchio::aba(model, data, q, qd, tau); }));
  std::printf("%.3f\n", fastest(rounds, [&] { pinocchio::crba(model, data, q); }));
  const Eigen::VectorXd torque = pinocchio::rnea(model, data, q, qd, tau);
  const Eigen::VectorXd acceleration = pinocchio::aba(model, data, q, qd, tau);
  const Eigen::MatrixXd mass = pinocchio::crba(model, data, q);
  for (int j = 0; j < joints; ++j) std::printf("%.17g %.17g %.17g\n", torque[j], acceleration[j], mass(j, j));
  return 0;
}
