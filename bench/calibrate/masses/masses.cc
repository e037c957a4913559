// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/masses.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/calibrate/arm_calibration.h"
#include "bench/calibrate/joint_fit.h"
#include "bench/calibrate/masses/body_terms.h"
#include "bench/calibrate/masses/physical_fit.h"
#include "bench/calibrate/masses/window_sums.h"
#include "mjcf/import/robot_file.h"
#include "mjcf/mujoco/layout.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kBestModel = 1e-3;  // [1] of a joint's torque; none is better
constexpr int kPoses = 200;          // in which other motions are judged

// numbers of all bodies, and then of the terms of each joint
struct MassAnswer {
  VectorXd theta;
  MatrixXd covariance;
};

// its inverse, where some rows may be 0 or imitate each other: (this)^T (this)
MatrixXd inverse_root(const MatrixXd& square) {
  constexpr double kRounding = 1e-11;  // [1] of the largest eigenvalue
  const VectorXd scale = square.diagonal().cwiseSqrt().cwiseMax(1e-150).cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> own(scale.asDiagonal() * square *
                                                    scale.asDiagonal());
  VectorXd root = own.eigenvalues();
  const double least = kRounding * root.maxCoeff();
  for (double& x : root) x = x > least ? 1 / std::sqrt(x) : 0;
  return root.asDiagonal() * own.eigenvectors().transpose() * scale.asDiagonal();
}

MatrixXd scaled_inverse(const MatrixXd& positive) {
  const VectorXd scale = positive.diagonal().cwiseSqrt().cwiseMax(1e-150).cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * positive * scale.asDiagonal();
  return scale.asDiagonal() *
         MatrixXd(scaled.ldlt().solve(MatrixXd::Identity(scaled.rows(), scaled.cols()))) *
         scale.asDiagonal();
}

// a body that a joint moves
struct MovingBody {
  std::string name;   // as the file has it
  int joint = 0;      // whose body it is, by its number in ArmTree::joints
  Vector3d origin;    // [m] of its frame in that of the joint, which has the same axes
  bool known = true;  // whether the file has a mass of it
  BodyVector file;    // what it has, if so
  // What it is taken for where the recordings do not show it: as the file has it, but no thinner
  // than 1 cm. Of one without a mass, a rod from its joint to the next, half as thick as it is
  // long (at least a tenth of the arm's reach), of 100 kg for each cubic meter of its length.
  BodyVector prior;
};

constexpr double kFrame = 1e-9;  // [kg] that a frame between joints may have

// of mass m at c, with that spread of it [m^2] about c
BodyVector body_at(double m, const Vector3d& c, const Matrix3d& spread) {
  Eigen::Matrix4d P;
  P << m * (spread + c * c.transpose()), m * c, m * c.transpose(), m;
  return body_vector(P);
}

// no thinner than that of a body of 1 cm
BodyVector thick(const TreeJoint& j) {
  constexpr double kThinnest = 0.01 * 0.01 / 12, kShare = 0.01;  // [m^2], [1] of its length
  const Matrix3d I = j.inertia / j.mass;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> own(
      Matrix3d(I.trace() / 2 * Matrix3d::Identity() - I));
  const double least = std::max(kThinnest, kShare * own.eigenvalues()[2]);
  const Vector3d spread = own.eigenvalues().cwiseMax(least);
  return body_at(j.mass, j.center,
                 own.eigenvectors() * spread.asDiagonal() * own.eigenvectors().transpose());
}

// [m] from a joint to the next, or to the end effector
Vector3d way_on(const ArmTree& arm, int joint) {
  Vector3d sum = Vector3d::Zero();
  int children = 0;
  for (const TreeJoint& j : arm.joints)
    if (j.parent == joint) sum += j.position, ++children;
  if (children > 0) return sum / children;
  const ArmPoint& end = arm.point(kEndEffector);
  return end.joint == joint ? end.place : sum;
}

double reach(const ArmTree& arm) {
  double length = 0;
  for (const TreeJoint& j : arm.joints) length += j.parent < 0 ? 0 : j.position.norm();
  return std::max(length, 0.1);
}

BodyVector rod(const ArmTree& arm, int joint) {
  constexpr double kDensity = 100, kThickness = 0.5, kShortest = 0.1;  // [kg/m^3], [1], [1]
  const Vector3d way = way_on(arm, joint);
  const double length = std::max(way.norm(), kShortest * reach(arm));
  const double thickness = kThickness * length;
  return body_at(kDensity * std::pow(length, 3), way / 2,
                 (way * way.transpose() + thickness * thickness * Matrix3d::Identity()) / 12);
}

// those of an arm before anything is known of them but their file; frames between joints that weigh
// nothing are none
std::vector<MovingBody> moving_bodies(const ArmTree& arm, const std::set<std::string>& massless) {
  std::vector<MovingBody> all;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const TreeJoint& j = arm.joints[i];
    if (j.mass <= kFrame) continue;  // also of a body with several joints all but the last
    const int joint = static_cast<int>(i);
    if (arm.bodies[i].empty())
      throw std::invalid_argument(
          fmt::format("the body behind joint {} '{}' has no name; give it one in the robot's file",
                      joint + 1, arm.names[i]));
    MovingBody b{arm.bodies[i], joint, arm.point(arm.bodies[i]).place};
    b.known = massless.count(b.name) == 0;
    if (b.known) b.file = body_vector(j);
    b.prior = b.known ? thick(j) : rod(arm, joint);
    all.push_back(b);
  }
  if (all.empty()) throw std::invalid_argument("no body of this arm has a mass");
  return all;
}

// the place of a term in kJointTerms
int term_number(std::string_view name) {
  const auto* const at = std::find_if(std::begin(kJointTerms), std::end(kJointTerms),
                                      [&](const JointTerm& t) { return name == t.name; });
  return static_cast<int>(at - std::begin(kJointTerms));
}

// What terms of joints are free in a fit of all joints together, and what is held: armature and
// friction at 0, and a skew of viscous friction at all of that. The terms stand in theta behind
// `before` other numbers.
class JointBounds {
 public:
  // all are free
  JointBounds(int before, int joints) : before_(before) {
    std::array<Is, kTermsOfJoint> free;
    free.fill(Is::kFree);
    joints_.assign(static_cast<std::size_t>(joints), free);
  }

  // theta = (this) phi, of what is free
  MatrixXd freedom() const {
    const int n = at(static_cast<int>(joints_.size()), 0), viscous = term_number("viscous");
    MatrixXd T = MatrixXd::Zero(n, n);
    int columns = before_;
    T.leftCols(before_).topRows(before_).setIdentity();
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const int joint = static_cast<int>(j);
      for (int k = 0; k < kTermsOfJoint; ++k)
        if (joints_[j][static_cast<std::size_t>(k)] == Is::kFree) T(at(joint, k), columns++) = 1;
      const Is skew = joints_[j][static_cast<std::size_t>(term_number("viscous_skew"))];
      if (skew == Is::kViscous || skew == Is::kMinusViscous)
        T.row(at(joint, term_number("viscous_skew"))) =
            (skew == Is::kViscous ? 1 : -1) * T.row(at(joint, viscous));
    }
    return T.leftCols(columns);
  }

  // holds the term that is furthest beyond what a joint can have, in standard errors, and tells
  // `found` which term of which joint that is, and how far beyond; false if there is none.
  template <class Found>
  bool hold(const VectorXd& theta, const VectorXd& errors, Found&& found) {
    int joint = 0, term = 0;
    double much = 0;
    if (!furthest(theta, errors, joint, term, much)) return false;
    found(joint, term, much);
    take(joint, term, theta[at(joint, term)] < 0);
    return true;
  }
  // the number in theta of a joint's term
  int at(int joint, int term) const { return before_ + joint * kTermsOfJoint + term; }

 private:
  enum class Is { kFree, kZero, kViscous, kMinusViscous };

  bool furthest(const VectorXd& theta, const VectorXd& errors, int& joint, int& term,
                double& much) const {
    const int viscous = term_number("viscous"), skew = term_number("viscous_skew"),
              offset = term_number("offset");
    double most = 0;
    for (int j = 0; j < static_cast<int>(joints_.size()); ++j) {
      for (int k = 0; k < kTermsOfJoint; ++k) {
        const bool free =
            joints_[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)] == Is::kFree;
        if (!free || k == offset) continue;
        const double x = theta[at(j, k)];
        const double beyond = k == skew ? std::abs(x) - std::max(theta[at(j, viscous)], 0.) : -x;
        if (beyond <= 1e-12 * std::abs(x)) continue;
        const double errors_beyond = beyond / std::max(errors[at(j, k)], 1e-300);
        if (errors_beyond <= most) continue;
        most = errors_beyond, joint = j, term = k, much = beyond;
      }
    }
    return most > 0;
  }

  void take(int joint, int term, bool negative) {
    Is& is = joints_[static_cast<std::size_t>(joint)][static_cast<std::size_t>(term)];
    is = term != term_number("viscous_skew") ? Is::kZero
         : negative                          ? Is::kMinusViscous
                                             : Is::kViscous;
  }

  int before_;
  std::vector<std::array<Is, kTermsOfJoint>> joints_;
};

class Search {
 public:
  Search(const ArmTree& arm, const std::set<std::string>& massless, const std::vector<Trace>& logs,
         const Windows& windows, NewRobotFile& robot)
      : arm_(arm),
        logs_(logs),
        windows_(windows),
        robot_(robot),
        bodies_(moving_bodies(arm, massless)),
        terms_(arm, joints_of(bodies_)),
        slip_(VectorXd::Constant(arm.dof(), TreeJoint().v_s)) {}

  IdentifiedMasses run() {
    ArmTree found = arm_;
    for (int pass = 0; pass < 3; ++pass) {
      sums_ = window_sums(arm_, terms_, logs_, windows_, slip_);
      if (pass == 0) scale_unknown_bodies();
      settle();
      put_into_file();
      found = read_back(robot_);
      const VectorXd before = std::exchange(slip_, slips(found));
      if (((slip_ - before).array().abs() <= 0.05 * before.array()).all()) break;
    }
    IdentifiedMasses m;
    m.has_nominal =
        std::all_of(bodies_.begin(), bodies_.end(), [](const MovingBody& b) { return b.known; });
    m.joints.resize(robot_.joints.size());
    judge_stretches(m);
    judge_bodies(m);
    judge_joints(found.usual_torque, m);
    return m;
  }

 private:
  static std::vector<int> joints_of(const std::vector<MovingBody>& bodies) {
    std::vector<int> all;
    for (const MovingBody& b : bodies) all.push_back(b.joint);
    return all;
  }
  JointBounds all_free() const { return {terms_.columns(), arm_.dof()}; }
  double torque(std::size_t joint) const {
    return sums_[joint].all.residual(VectorXd::Zero(terms_.columns() + kTermsOfJoint));
  }
  // theta's part that a joint's columns multiply
  VectorXd of_joint(const VectorXd& theta, std::size_t joint) const {
    VectorXd part(terms_.columns() + kTermsOfJoint);
    part << theta.head(terms_.columns()),
        theta.segment<kTermsOfJoint>(all_free().at(static_cast<int>(joint), 0));
    return part;
  }

  // of all stretches, or without one of them
  Quadratic data(int without = -1) const {
    const int bodies = terms_.columns(), n = bodies + kTermsOfJoint * arm_.dof();
    WindowSums all(n);
    for (std::size_t j = 0; j < sums_.size(); ++j) {
      const double per_variance =
          1 / (sigma_[static_cast<Index>(j)] * sigma_[static_cast<Index>(j)]);
      std::vector<Index> place;
      for (int k = 0; k < bodies; ++k) place.push_back(k);
      for (int k = 0; k < kTermsOfJoint; ++k)
        place.push_back(all_free().at(static_cast<int>(j), k));
      for (int s = 0; s < kStretches; ++s) {
        if (s == without) continue;
        const WindowSums& sums = sums_[j].stretches[static_cast<std::size_t>(s)];
        all.ZZ(place, place) += per_variance * sums.ZZ;
        all.ZA(place, place) += per_variance * sums.ZA;
        all.Zy(place) += per_variance * sums.Zy;
      }
    }
    const MatrixXd root = inverse_root(all.ZZ), R = root * all.ZA;
    return {R.transpose() * R, R.transpose() * (root * all.Zy)};
  }

  std::vector<BodyVector> priors() const {
    std::vector<BodyVector> all;
    for (const MovingBody& b : bodies_) all.push_back(b.prior);
    return all;
  }

  MassAnswer answer(const Quadratic& d, const JointBounds& bounds) const {
    const MatrixXd T = bounds.freedom();
    Quadratic free{T.transpose() * d.H * T, T.transpose() * d.b};
    const VectorXd phi = physical_fit(free, priors());
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const auto at = static_cast<Index>(b) * kBodyTerms;
      free.H.block<kBodyTerms, kBodyTerms>(at, at) += metric(phi.segment<kBodyTerms>(at));
    }
    return {T * phi, T * scaled_inverse(free.H) * T.transpose()};
  }

  // with the file's masses: the terms of joints alone
  MassAnswer answer_nominal(const Quadratic& d, const JointBounds& bounds) const {
    const int n = terms_.columns();
    const Index rest = d.b.size() - n;
    MassAnswer a{VectorXd(d.b.size()), MatrixXd::Zero(d.b.size(), d.b.size())};
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      a.theta.segment<kBodyTerms>(static_cast<Index>(b) * kBodyTerms) = bodies_[b].file;
    const MatrixXd all = bounds.freedom(), T = all.bottomRightCorner(rest, all.cols() - n);
    const VectorXd b = d.b.tail(rest) - d.H.bottomLeftCorner(rest, n) * a.theta.head(n);
    const MatrixXd C = scaled_inverse(T.transpose() * d.H.bottomRightCorner(rest, rest) * T);
    a.theta.tail(rest) = T * (C * (T.transpose() * b));
    a.covariance.bottomRightCorner(rest, rest) = T * C * T.transpose();
    return a;
  }

  // with what a joint can have; says what was held
  template <class Fit, class Found>
  MassAnswer bounded(Fit&& fit, JointBounds& bounds, Found&& found) const {
    for (;;) {
      const MassAnswer a = fit(bounds);
      const VectorXd errors = a.covariance.diagonal().cwiseMax(0).cwiseSqrt();
      const bool more = bounds.hold(a.theta, errors, [&](int joint, int term, double much) {
        const auto at = bounds.at(joint, term);
        found(joint, term, a.theta[at], errors[at], much);
      });
      if (!more) return a;
    }
  }

  // the weight of each joint is that of what is left of its torque
  void settle() {
    sigma_.resize(arm_.dof());
    for (std::size_t j = 0; j < sums_.size(); ++j) {
      sigma_[static_cast<Index>(j)] = 0.1 * std::max(torque(j), 1e-9);
      check_terms(j);
    }
    for (int k = 0; k < 4; ++k) {
      bounds_ = all_free();
      const Quadratic d = data();
      best_ = bounded([&](const JointBounds& b) { return answer(d, b); }, bounds_,
                      [](int, int, double, double, double) {});
      for (std::size_t j = 0; j < sums_.size(); ++j)
        sigma_[static_cast<Index>(j)] = std::max(
            {sums_[j].all.residual(of_joint(best_.theta, j)), kBestModel * torque(j), 1e-12});
    }
  }

  // whether a joint's own terms can be told from each other
  void check_terms(std::size_t j) const {
    const MatrixXd own = sums_[j].all.AA.bottomRightCorner(kTermsOfJoint, kTermsOfJoint);
    const VectorXd scale = own.diagonal().cwiseSqrt().cwiseMax(1e-150).cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * own *
                                                        scale.asDiagonal());
    if (eigen.eigenvalues()[0] > 1e-8) return;
    throw std::invalid_argument(fmt::format(
        "joint {} '{}': the motion cannot tell its friction, armature and offset from each other: "
        "record one in which it moves both ways, at several speeds",
        j + 1, joint_name_in_file(arm_, static_cast<int>(j))));
  }

  // bodies without a mass in the file are as dense as the torques are large
  void scale_unknown_bodies() {
    sigma_ = VectorXd::Ones(arm_.dof());
    for (std::size_t j = 0; j < sums_.size(); ++j)
      sigma_[static_cast<Index>(j)] = std::max(torque(j), 1e-9);
    const Quadratic d = data();
    const int n = terms_.columns();
    VectorXd known = VectorXd::Zero(d.b.size()), unknown = known;
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      (bodies_[b].known ? known : unknown).segment<kBodyTerms>(static_cast<Index>(b) * kBodyTerms) =
          bodies_[b].prior;
    if (unknown.isZero(0)) return;
    MatrixXd T = MatrixXd::Zero(d.b.size(), d.b.size() - n + 1);
    T.col(0) = unknown;
    T.bottomRightCorner(d.b.size() - n, d.b.size() - n).setIdentity();
    const double factor =
        (scaled_inverse(T.transpose() * d.H * T) * (T.transpose() * (d.b - d.H * known)))[0];
    if (!(factor > 0)) return;  // such torques are doubted when all is fitted
    for (MovingBody& b : bodies_)
      if (!b.known) b.prior *= std::clamp(factor, 0.01, 100.);
  }

  VectorXd slips(const ArmTree& arm) const {
    VectorXd all(arm.dof());
    for (int i = 0; i < arm.dof(); ++i)
      all[i] = arm.joints[static_cast<std::size_t>(arm.leaders[static_cast<std::size_t>(i)])].v_s;
    return all;
  }

  BodyVector numbers(std::size_t body) const {
    return best_.theta.segment<kBodyTerms>(static_cast<Index>(body) * kBodyTerms);
  }

  void put_into_file() {
    robot_.bodies.clear(), robot_.joints.clear();
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      robot_.bodies[bodies_[b].name] = body_of(numbers(b), bodies_[b].origin);
    for (std::size_t j = 0; j < sums_.size(); ++j) {
      CalibratedJoint joint;
      joint.name = joint_name_in_file(arm_, static_cast<int>(j));
      for (int k = 0; k < kTermsOfJoint; ++k)
        joint.terms.push_back(
            {kJointTerms[k].name, best_.theta[bounds_.at(static_cast<int>(j), k)]});
      robot_.joints.push_back(std::move(joint));
    }
  }

  // what each stretch shows that the fit has not seen, and how the fits differ
  void judge_stretches(IdentifiedMasses& m) {
    JointBounds nominal_bounds = all_free();
    const Quadratic all = data();
    if (m.has_nominal)
      bounded([&](const JointBounds& b) { return answer_nominal(all, b); }, nominal_bounds,
              [](int, int, double, double, double) {});
    stretches_.resize(best_.theta.size(), kStretches);
    for (int s = 0; s < kStretches; ++s) {
      const Quadratic d = data(s);
      stretches_.col(s) = answer(d, bounds_).theta;
      VectorXd nominal;
      if (m.has_nominal) nominal = answer_nominal(d, nominal_bounds).theta;
      for (std::size_t j = 0; j < sums_.size(); ++j) {
        const WindowSums& sums = sums_[j].stretches[static_cast<std::size_t>(s)];
        const double share = static_cast<double>(sums.windows) / sums_[j].all.windows;
        const auto square = [&](const VectorXd& theta) {
          return share * std::pow(sums.residual(of_joint(theta, j)), 2);
        };
        m.joints[j].held_out += square(stretches_.col(s));
        if (m.has_nominal) m.joints[j].nominal += square(nominal);
      }
    }
    for (JointOfMasses& j : m.joints)
      j.held_out = std::sqrt(j.held_out), j.nominal = std::sqrt(j.nominal);
  }

  void judge_bodies(IdentifiedMasses& m) {
    std::vector<BodyVector> found;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const MovingBody& body = bodies_[b];
      found.push_back(numbers(b));
      IdentifiedBody out{body.name, body.known, {}, body_of(numbers(b), body.origin)};
      if (body.known) out.file = body_of(body.file, body.origin);
      m.bodies.push_back(std::move(out));
    }
    // without what the terms of joints can imitate
    const MatrixXd T = bounds_.freedom(), H = T.transpose() * data().H * T;
    const Index n = terms_.columns(), rest = H.cols() - n;
    const MatrixXd root = inverse_root(H.bottomRightCorner(rest, rest)),
                   cross = root * H.bottomLeftCorner(rest, n);
    m.base =
        base_parameters(arm_, terms_, found, H.topLeftCorner(n, n) - cross.transpose() * cross);
    judge_predictions(m);
  }

  // one standard error, rms over rows of what theta is multiplied by
  double error_of(const MatrixXd& rows) const {
    const double fit = (rows * best_.covariance).cwiseProduct(rows).sum(),
                 between = jackknife_errors(rows * stretches_).squaredNorm();
    return std::sqrt(std::max(fit, between) / static_cast<double>(rows.rows()));
  }

  // of the torques that other motions take, in poses of all of its range
  void judge_predictions(IdentifiedMasses& m) {
    const MatrixXd poses = even_poses(arm_, kPoses);
    const VectorXd rest = VectorXd::Zero(arm_.dof());
    std::vector<MatrixXd> gravity(sums_.size(), MatrixXd::Zero(kPoses, best_.theta.size()));
    std::vector<MatrixXd> inertia = gravity;
    for (int k = 0; k < kPoses; ++k) {
      const MatrixXd g = terms_.at(poses.col(k), rest).rest;
      for (int i = 0; i < arm_.dof(); ++i) {
        const auto joint = static_cast<std::size_t>(i);
        const VectorXd only = VectorXd::Unit(arm_.dof(), i);
        gravity[joint].row(k).head(terms_.columns()) = g.row(i);
        inertia[joint].row(k).head(terms_.columns()) =
            terms_.at(poses.col(k), only).momentum.row(i);
      }
    }
    for (std::size_t j = 0; j < m.joints.size(); ++j) {
      gravity[j].col(bounds_.at(static_cast<int>(j), kTermsOfJoint - 1)).setOnes();  // its offset
      inertia[j].col(bounds_.at(static_cast<int>(j), 0)).setOnes();                  // its rotor
      m.joints[j].gravity_error = error_of(gravity[j]);
      m.joints[j].inertia_error = error_of(inertia[j]);
    }
    set_scale(gravity, m);
  }

  // of gravity, by the file's, and whether that is all by which they differ
  void set_scale(const std::vector<MatrixXd>& gravity, IdentifiedMasses& m) const {
    if (!m.has_nominal) return;
    const Index n = terms_.columns();
    VectorXd file(n);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      file.segment<kBodyTerms>(static_cast<Index>(b) * kBodyTerms) = bodies_[b].file;
    double product = 0, square = 0;
    for (const MatrixXd& rows : gravity) {
      const VectorXd of_file = rows.leftCols(n) * file;
      product += of_file.dot(rows.leftCols(n) * best_.theta.head(n));
      square += of_file.squaredNorm();
    }
    if (!(square > 0)) return;
    m.scale = product / square;
    constexpr double kAlike = 0.5, kSeen = 5;  // [1] of gravity, and of its standard error
    bool seen = false, alike = true;
    for (std::size_t j = 0; j < gravity.size(); ++j) {
      const double all = (gravity[j].leftCols(n) * best_.theta.head(n)).norm(),
                   left = (gravity[j].leftCols(n) * (best_.theta.head(n) - m.scale * file)).norm();
      if (!(all > kSeen * m.joints[j].gravity_error * std::sqrt(kPoses))) continue;
      seen = true, alike = alike && left <= kAlike * all;
    }
    m.differs_by_scale = seen && alike;
  }

  void judge_joints(const VectorXd& usual, IdentifiedMasses& m) {
    constexpr double kMostError = 0.1, kAcceleration = 10;  // [1] of the usual torque, [rad/s^2]
    fill_joints(m);
    double worse = 0;
    for (std::size_t i = 0; i < m.joints.size(); ++i) {
      const JointOfMasses& j = m.joints[i];
      const double usually = usual[static_cast<Index>(i)];
      if (j.gravity_error > kMostError * usually)
        m.doubts.push_back(fmt::format(
            "joint '{}': the torque that holds it is known to +- {:.3g} N m in other poses, and "
            "its usual torque is {:.3g} N m: record motions in which it and the joints around it "
            "go "
            "further, and raise the links against gravity",
            j.name, j.gravity_error, usually));
      if (kAcceleration * j.inertia_error > kMostError * usually)
        m.doubts.push_back(fmt::format(
            "joint '{}': its inertia is known to +- {:.3g} kg m^2, which makes {:.3g} N m at {:g} "
            "rad/s^2, and its usual torque is {:.3g} N m: record motions that accelerate it more, "
            "in several poses of the other joints",
            j.name, j.inertia_error, kAcceleration * j.inertia_error, kAcceleration, usually));
      if (j.held_out > j.torque / 2)
        m.doubts.push_back(fmt::format(
            "joint '{}': {:.3g} N m of its torque of {:.3g} N m are left over, which no masses, "
            "friction and rotors explain",
            j.name, j.held_out, j.torque));
      if (!m.has_nominal) continue;
      worse += std::pow(j.held_out / std::max(j.nominal, 1e-9 * j.torque), 2);
      if (j.held_out > 1.1 * j.nominal + kMatters * j.torque)
        m.doubts.push_back(fmt::format(
            "joint '{}': the masses that were found leave {:.3g} N m in stretches that the fit has "
            "not seen, and the file's leave {:.3g} N m",
            j.name, j.held_out, j.nominal));
    }
    if (m.has_nominal && worse > static_cast<double>(m.joints.size()))
      m.doubts.emplace_back(
          "in stretches that the fit has not seen, the masses that were found are no better than "
          "those of the file: keep these");
    if (m.differs_by_scale && (m.scale > kMostScale || m.scale < kLeastScale))
      m.doubts.push_back(fmt::format(
          "the masses that were found hold {:.3g} times the torque of the file's, which must be "
          "between {:g} and {:g}: are torques in N m, on the arm's side of the gears?",
          m.scale, kLeastScale, kMostScale));
  }

  // what a robot file and its judge want to know of each joint
  void fill_joints(IdentifiedMasses& m) {
    std::vector<CalibratedJoint>& joints = robot_.joints;
    JointBounds again = all_free();
    const Quadratic d = data();
    const MassAnswer unbounded = answer(d, again);
    const VectorXd jackknife = jackknife_errors(stretches_);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      CalibratedJoint& j = joints[i];
      const WindowSums& all = sums_[i].all;
      j.torque = torque(i);
      j.windows = all.windows, j.left_out = sums_[i].left_out, j.fastest = sums_[i].fastest;
      j.slip = slip_[static_cast<Index>(i)];
      j.unbounded = all.residual(of_joint(unbounded.theta, i));
      j.held_out = m.joints[i].held_out;
      for (const Trace& log : logs_)
        j.largest = std::max(j.largest, log.tau.row(static_cast<Index>(i)).cwiseAbs().maxCoeff());
      for (int k = 0; k < kTermsOfJoint; ++k) {
        const int at = again.at(static_cast<int>(i), k), own = terms_.columns() + k;
        CalibratedTerm& term = j.terms[static_cast<std::size_t>(k)];
        const double variance = unbounded.covariance(at, at), information = d.H(at, at);
        term.error = std::max(std::sqrt(std::max(variance, 0.)), jackknife[at]);
        term.excitation = std::sqrt(all.AA(own, own) / all.windows);
        term.own = std::min(1., 1 / std::sqrt(std::max(variance * information, 1e-300)));
      }
      m.joints[i].name = printable_name(j.name), m.joints[i].torque = j.torque;
    }
    bounded([&](const JointBounds& b) { return answer(d, b); }, again,
            [&](int joint, int term, double found, double error, double much) {
              say_held(joints[static_cast<std::size_t>(joint)], term, found, error, much);
            });
  }

  static void say_held(CalibratedJoint& j, int term, double found, double error, double much) {
    const JointTerm& t = kJointTerms[term];
    const std::string words =
        fmt::format("{} would be {:.3g} +- {:.2g} {}", t.name, found, error, t.unit);
    const double effect = much * j.terms[static_cast<std::size_t>(term)].excitation;
    if (std::string_view(t.name) == "coulomb" && much > kSurely * error &&
        effect > kMatters * j.torque)
      j.doubts.push_back(words +
                         ", and no joint has less than none: is the sign of its torque right? "
                         "`sign` in the map of columns turns it");
    else
      j.held.push_back(words + ": held at a bound, the others fitted again");
  }

  const ArmTree& arm_;
  const std::vector<Trace>& logs_;
  Windows windows_;
  NewRobotFile& robot_;
  std::vector<MovingBody> bodies_;
  BodyTerms terms_;
  VectorXd slip_;  // [rad/s]
  std::vector<JointSums> sums_;
  VectorXd sigma_;  // [N m] of what is left of each joint
  JointBounds bounds_{0, 0};
  MassAnswer best_;
  MatrixXd stretches_;  // theta without each of them
};

void check_masses(const ArmTree& arm, const std::vector<Trace>& logs, const Windows& windows,
                  const NewRobotFile& robot) {
  check_windows(windows);
  require_own_joints(arm);
  if (logs.empty()) throw std::invalid_argument("no recording to find masses from");
  for (const Trace& log : logs) {
    detail::require_size(arm, log.dof());
    if (log.tau_is_current)
      throw std::invalid_argument(
          "masses are found from torques, and these recordings have currents: `gain` in the map of "
          "columns gives that of each drive [N m/A]");
  }
  if (robot_file(robot.from).options.measured.payload)
    throw std::invalid_argument(
        "\"payload\" of the robot file would count twice, as the masses that are found have it in "
        "them: take it out, and weigh it afterwards (--weigh)");
}

}  // namespace

IdentifiedMasses identify_masses(const ArmTree& arm, const std::set<std::string>& massless,
                                 const std::vector<Trace>& logs, const Windows& windows,
                                 NewRobotFile& robot) {
  check_masses(arm, logs, windows, robot);
  return Search(arm, massless, logs, windows, robot).run();
}

}  // namespace tauext
