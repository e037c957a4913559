// SPDX-License-Identifier: Apache-2.0
#include "bench/python/robots.h"

#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/python/arm.h"
#include "bench/python/arrays.h"
#include "bench/python/python_estimator.h"
#include "bench/roster/robots.h"
#include "bench/roster/roster.h"
#include "bench/roster/threshold_file.h"
#include "bench/score/degradation.h"
#include "mjcf/record.h"
#include "mjcf/scenarios/scenario.h"

namespace tauext::python {

namespace py = pybind11;

namespace {

// what one detector said of a run
struct Detections {
  std::vector<Detection> all;
};

std::vector<std::string> names_of(std::vector<std::string> all) {
  std::erase(all, "python");
  return all;
}

Trace record(const Robot& robot, const std::string& scenario, const std::string& degrade,
             std::uint64_t seed) {
  return unlocked([&] {
    const Scenario& s = scenario_of(robot, scenario);
    Degradation d = degradation_of(degrade, seed);
    Sensors sensors = sensors_for(s, d.sensors);
    sensors.seed = seed;
    return record(robot.load_for(s, error_for(s, d.model_error)), s, sensors, {.drives = d.drives});
  });
}

Output estimated(const Robot& robot, const std::string& estimator, const Trace& run) {
  return unlocked([&] {
    robot.require_joints(run.dof());
    return robot.run(estimator, run);
  });
}

// of estimates that anybody made
Output given(const py::object& tau_ext, const py::object& joint_names) {
  Output out;
  out.tau_ext = columns(arrays("table", tau_ext, "tau_ext", py::none(), py::none(), joint_names));
  out.status.assign(static_cast<std::size_t>(out.tau_ext.cols()), Status::kOk);
  return out;
}

Detections detected(const Robot& robot, const std::string& detector, const Trace& run,
                    const Output& estimates, const std::string& thresholds,
                    const std::string& estimator, const std::string& condition) {
  robot.require_joints(run.dof());
  if (estimates.tau_ext.cols() != run.size())
    throw std::invalid_argument(
        fmt::format("{} estimates of {} samples", estimates.tau_ext.cols(), run.size()));
  DetectorSettings settings;
  if (!thresholds.empty())
    settings.thresholds =
        trained_for(read_thresholds(thresholds), robot, 0, estimator, detector, condition);
  return {robot.detect(detector, run, estimates, settings)};
}

template <class T, class Get>
py::array_t<T> each(const std::vector<Detection>& all, const Get& get) {
  py::array_t<T> out(static_cast<py::ssize_t>(all.size()));
  for (std::size_t k = 0; k < all.size(); ++k)
    out.mutable_at(static_cast<py::ssize_t>(k)) = get(all[k]);
  return out;
}

py::list fields(const std::vector<FieldHelp>& all) {
  py::list out;
  for (const FieldHelp& f : all) {
    py::dict d;
    d["key"] = f.key, d["unit"] = f.unit, d["value"] = f.value, d["effect"] = f.effect;
    out.append(d);
  }
  return out;
}

void bind_answers(py::module_& m) {
  py::class_<Output>(m, "Estimates", "What an estimator made of a run.")
      .def(py::init(&given), py::arg("tau_ext"), py::kw_only(),
           py::arg("joint_names") = py::tuple())
      .def_property_readonly(
          "tau_ext", [](const Output& o) { return rows(o.tau_ext); }, "[N m] a row for each sample")
      .def_property_readonly(
          "status",
          [](const Output& o) {
            std::vector<std::string> all;
            for (const Status s : o.status) all.emplace_back(name_of(s));
            return all;
          },
          "of each sample: ok, started, or why it could not be used")
      .def("__len__", [](const Output& o) { return o.status.size(); });
  py::class_<Detections>(m, "Detections", "What a detector made of estimates, sample by sample.")
      .def_property_readonly(
          "mark",
          [](const Detections& d) {
            return each<bool>(d.all, [](const Detection& x) { return x.mark; });
          },
          "whether a contact is marked here")
      .def_property_readonly(
          "score",
          [](const Detections& d) {
            return each<double>(d.all, [](const Detection& x) { return x.score; });
          },
          "[1] which marks where it rises through 1")
      .def_property_readonly(
          "contact",
          [](const Detections& d) {
            return each<int>(d.all, [](const Detection& x) { return static_cast<int>(x.contact); });
          },
          "of tauext.CONTACTS")
      .def("__len__", [](const Detections& d) { return d.all.size(); });
}

}  // namespace

Degradation degradation_of(const std::string& degrade, std::uint64_t seed) {
  Degradation d;
  if (degrade.starts_with('{'))
    set_degradation(degrade, d);
  else if (!degrade.empty())
    read_degradation(degrade, d);
  d.sensors.seed = seed;
  return d;
}

void bind_robots(py::module_& m) {
  bind_answers(m);
  py::class_<Robot, std::unique_ptr<Robot, py::nodelete>>(m, "Robot")
      .def_property_readonly("name", &Robot::name)
      .def_property_readonly("joints", &Robot::dof)
      .def_property_readonly("joint_names", &Robot::joints)
      .def("scenarios",
           [](const Robot& r) {
             std::vector<std::pair<std::string, std::string>> all;
             for (const Scenario& s : r.scenarios()) all.emplace_back(s.name, s.description);
             return all;
           })
      .def("estimators", [](const Robot& r) { return names_of(r.estimators()); })
      .def("detectors", &Robot::detectors)
      .def("estimator_fields",
           [](const Robot& r, const std::string& e) { return fields(r.estimator_fields(e)); })
      .def("detector_fields",
           [](const Robot& r, const std::string& d) { return fields(r.detector_fields(d)); })
      .def("record", &record)
      .def("estimate", &estimated)
      .def("detect", &detected)
      .def("arm", &arm_of);
  py::class_<Arm, std::shared_ptr<Arm>>(m, "Arm").def(
      "terms",
      [](const Arm& a, const py::object& q, const py::object& qd, const py::object& names) {
        const auto [B, bias, momentum_bias, friction] =
            a.terms(vector(q, "q", a.joints(), names), vector(qd, "qd", a.joints(), names));
        return py::make_tuple(rows(B.transpose()), bias, momentum_bias, friction);
      });
  m.def(
      "robot",
      [](const std::string& name, const std::string& lock) {
        return const_cast<Robot*>(&robot(name, lock));
      },
      py::return_value_policy::reference);
  m.def("robots", [] {
    std::vector<std::string> all;
    for (const auto& r : robots()) all.push_back(r->name());
    for (const std::string_view name : kRobotsByMjcf) all.emplace_back(name);
    return all;
  });
}

}  // namespace tauext::python
