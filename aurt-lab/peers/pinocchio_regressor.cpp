// Time of pinocchio::computeJointTorqueRegressor on one core, for pinocchio.py.
//
// Arguments: joints, then alpha, a, d of each joint (alpha and a as they lead to that joint), then rounds.
// Prints the fastest round in nanoseconds per evaluation. Each evaluation has its own sample, as in the kernel's
// benchmark, and writes Pinocchio's one dense matrix, which stays in the fastest cache.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/multibody.hpp>

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const int joints = std::atoi(argv[1]);
  if (argc != 3 + 3 * joints) return 2;

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
    model.appendBodyToJoint(parent, pinocchio::Inertia::Random(), pinocchio::SE3::Identity());
  }
  pinocchio::Data data(model);

  constexpr int samples = 256;
  constexpr double golden = 0.6180339887498949;
  std::vector<Eigen::VectorXd> q, qd, qdd;
  for (int s = 0; s < samples; ++s) {
    Eigen::VectorXd unit(joints);
    for (int j = 0; j < joints; ++j) {
      const double k = golden * (j * samples + s);
      unit[j] = 2.0 * (k - std::floor(k)) - 1.0;
    }
    q.push_back(3.0 * unit);
    qd.push_back(2.0 * unit);
    qdd.push_back(10.0 * unit);
  }

  const int rounds = std::atoi(argv[argc - 1]);
  double fastest = 1e300;
  double sum = 0.0;
  for (int r = 0; r < rounds; ++r) {
    const auto start = std::chrono::steady_clock::now();
    for (int s = 0; s < samples; ++s) {
      pinocchio::computeJointTorqueRegressor(model, data, q[s], qd[s], qdd[s]);
      sum += data.jointTorqueRegressor(0, 10 * joints - 1);
    }
    const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - start;
    fastest = std::min(fastest, elapsed.count() / samples);
  }
  std::printf("%.2f\n", fastest);
  return std::isnan(sum) ? 1 : 0;
}
