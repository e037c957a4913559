// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/region_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "mjcf/plant/plant.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/random.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kLinks = 3;  // of an arm that are touched, its last

std::vector<RegionClass> classes() {
  std::vector<RegionClass> all;
  const auto add = [&all](RegionClass c, const char* region) {
    c.region = &body_region(region);
    c.name = fmt::format("{}_{}", region, c.kind);
    all.push_back(c);
  };
  for (const char* region : {"hand", "lower_arm", "upper_arm", "chest", "abdomen"}) {
    for (const double v : {0.1, 0.25}) add({.kind = fmt::format("{:.2f}", v), .speed = v}, region);
    for (const double share : {0.25, 0.5, 1.})
      add({.kind = fmt::format("{:.0f}%", 100 * share), .share_of_limit = share}, region);
    add({.kind = "grazing", .meeting = Meeting::kGrazing}, region);
  }
  for (const char* region : {"hand", "lower_arm", "abdomen"})
    add({.kind = "clamped", .meeting = Meeting::kClamped}, region);
  return all;
}

MatrixXd jacobian(const Plant& plant, const std::string& point) {
  MatrixXd J(3, plant.dof());
  const Plant::Place place = plant.place(point);
  for (int i = 0; i < 3; ++i) J.row(i) = -plant.tau_ext_of(Vector3d::Unit(i), place).transpose();
  return J;
}

}  // namespace

const std::vector<RegionClass>& region_classes() {
  static const std::vector<RegionClass> all = classes();
  return all;
}

TouchPoints::TouchPoints(const Model& model, const VectorXd& home) {
  const ArmTree arm = tree_of(model);
  Plant plant(model);
  plant.set_state(home, VectorXd::Zero(plant.dof()));
  std::string to = kEndEffector;
  for (auto body = arm.bodies.rbegin(); body != arm.bodies.rend(); ++body) {
    if (body->empty() || !arm.points.contains(*body)) continue;
    Link link{*body, to, jacobian(plant, *body), jacobian(plant, to)};
    if (link.J_to.norm() > 1e-3) links_.push_back(std::move(link));
    if (links_.size() == kLinks) break;
    to = *body;
  }
  if (links_.empty())
    throw std::invalid_argument("no link that has a name moves its end: nothing to touch");
}

std::vector<RegionTouch> TouchPoints::draw(std::size_t number, std::uint64_t seed, double from,
                                           double until) const {
  const RegionClass& of = region_classes().at(number);
  Random random(seed, 2000 + number);
  const auto one_of = [&](const auto& list) -> const auto& {
    const double n = static_cast<double>(list.size());
    return list[static_cast<std::size_t>(std::min(random.uniform(0, n), n - 0.5))];
  };
  std::vector<RegionTouch> all;
  for (double t = from;;) {
    RegionTouch touch{.meeting = of.meeting, .region = of.region};
    touch.begin = t + random.uniform(0, 1);
    const Link& link = one_of(links_);
    touch.at = {link.from, link.to, random.uniform(0.3, 1)};
    touch.stiffness_factor = one_of(std::array{0.5, 1., 2.});
    const MatrixXd J = (1 - touch.at.share) * link.J_from + touch.at.share * link.J_to;
    Vector3d way;
    do {
      VectorXd qd(J.cols());
      for (double& x : qd) x = random.uniform(-1, 1);
      way = J * qd;
    } while (way.norm() < 1e-3 * J.norm());
    touch.direction = way.normalized();
    touch.speed = of.speed;
    touch.share_of_limit = of.share_of_limit;
    if (of.meeting == Meeting::kGrazing) {
      touch.depth = of.limit() / 4 / touch.stiffness();
      touch.rise = random.uniform(0.01, 0.03);
    } else if (of.meeting == Meeting::kClamped) {
      touch.force = of.limit();
      touch.rise = random.uniform(0.1, 0.3);
      touch.hold = 1;
      touch.fall = 0.3;
    }
    t = touch.end() + 1;
    if (t > until) return all;
    all.push_back(touch);
  }
}

}  // namespace tauext
