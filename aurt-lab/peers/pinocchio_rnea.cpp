// Time of pinocchio::rnea on one core, for batch_torque.py.
//
// Arguments: joints, then of each joint alpha, a, d (alpha and a as they lead to that joint), mass, the three coordinates of
// the centre of mass and the six numbers XX XY XZ YY YZ ZZ of the inertia about it; then the file of states and the number
// of rounds. The file holds doubles: the number of samples, then q, q̇ and q̈ of each sample.
// Prints the processor's time of the fastest round in nanoseconds for one state, and then the torques of the first sample.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>

int main(int argc, char** argv) {
  constexpr int numbers = 13;
  if (argc < 2) return 2;
  const int joints = std::atoi(argv[1]);
  if (argc != 4 + numbers * joints) return 2;

  pinocchio::Model model;
  pinocchio::JointIndex parent = 0;
  for (int j = 0; j < joints; ++j) {
    double v[numbers];
    for (int k = 0; k < numbers; ++k) v[k] = std::atof(argv[2 + numbers * j + k]);
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(v[0], Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Eigen::Vector3d origin = Eigen::Vector3d(v[1], 0, 0) + rotation * Eigen::Vector3d(0, 0, v[2]);
    parent = model.addJoint(parent, pinocchio::JointModelRZ(), pinocchio::SE3(rotation, origin),
                            "joint_" + std::to_string(j));
    Eigen::Matrix3d inertia;
    inertia << v[7], v[8], v[9], v[8], v[10], v[11], v[9], v[11], v[12];
    model.appendBodyToJoint(parent, pinocchio::Inertia(v[3], Eigen::Vector3d(v[4], v[5], v[6]), inertia),
                            pinocchio::SE3::Identity());
  }
  pinocchio::Data data(model);

  std::ifstream file(argv[argc - 2], std::ios::binary);
  double count = 0.0;
  file.read(reinterpret_cast<char*>(&count), sizeof count);
  const long samples = static_cast<long>(count);
  using Columns = Eigen::MatrixXd;  // A column for each sample, contiguous.
  Columns series[3];
  for (Columns& values : series) {
    values.resize(joints, samples);
    file.read(reinterpret_cast<char*>(values.data()), sizeof(double) * joints * samples);
  }
  if (!file || samples < 1) return 2;

  Columns torque(joints, samples);
  double fastest = 1e300;
  for (int r = 0; r < std::atoi(argv[argc - 1]); ++r) {
    const std::clock_t start = std::clock();
    for (long s = 0; s < samples; ++s) {
      torque.col(s) = pinocchio::rnea(model, data, series[0].col(s), series[1].col(s), series[2].col(s));
    }
    const double elapsed_ns = 1e9 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    fastest = std::min(fastest, elapsed_ns / samples);
  }
  std::printf("%.3f\n", fastest);
  for (int j = 0; j < joints; ++j) std::printf("%.17g\n", torque(j, 0));
  return 0;
}
