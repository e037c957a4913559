// SPDX-License-Identifier: Apache-2.0
#include "bench/python/runs.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <string>
#include <vector>

#include "bench/logs/mcap_samples.h"
#include "bench/python/arrays.h"
#include "bench/replay/robot_log.h"
#include "bench/roster/robots.h"
#include "mjcf/trace/read/npy_writer.h"
#include "mjcf/trace/trace.h"

namespace tauext::python {

namespace py = pybind11;

namespace {

Trace made(const py::object& t, const py::object& q, const py::object& qd, const py::object& tau,
           const py::object& tau_ext, const py::object& contact, bool torque_at_instants,
           const py::object& joint_names) {
  const py::tuple all = arrays("run", t, q, qd, tau, tau_ext, contact, joint_names);
  Trace run;
  const auto times = all[0].cast<Array>();
  run.t.assign(times.data(), times.data() + times.size());
  run.q = columns(all[1]), run.qd = columns(all[2]), run.tau = columns(all[3]);
  if (!all[4].is_none()) run.tau_ext = columns(all[4]);
  if (!all[5].is_none()) {
    const auto touches = all[5].cast<py::array_t<std::uint8_t, py::array::forcecast>>();
    run.contact.assign(touches.data(), touches.data() + touches.size());
  }
  run.torque_at_instants = torque_at_instants;
  return run;
}

py::object or_none(const Eigen::MatrixXd& m) {
  if (m.cols() == 0) return py::none();
  return rows(m);
}

Trace read(const std::string& path, const std::string& columns, const std::string& channel,
           const std::string& robot_name) {
  const Robot* const of = robot_name.empty() ? nullptr : &robot(robot_name);
  RecordedLog log = of != nullptr
                        ? robot_log(*of, path, channel, columns)
                        : read_any_log(path, LogOptions{.channel = channel, .columns = columns});
  log.require_consistent(path);
  return std::move(log.trace);
}

}  // namespace

void bind_runs(py::module_& m) {
  py::class_<Trace>(
      m, "Run",
      "A run: what the sensors said and, if it is known, what was true. Arrays have a row for each "
      "sample and a column for each joint; each attribute is a copy.")
      .def(py::init(&made), py::arg("t"), py::arg("q"), py::arg("qd"), py::arg("tau"),
           py::arg("tau_ext") = py::none(), py::arg("contact") = py::none(), py::kw_only(),
           py::arg("torque_at_instants") = false, py::arg("joint_names") = py::tuple())
      .def_property_readonly(
          "t",
          [](const Trace& r) { return Array(static_cast<py::ssize_t>(r.t.size()), r.t.data()); },
          "[s]")
      .def_property_readonly(
          "q", [](const Trace& r) { return rows(r.q); }, "[rad] measured")
      .def_property_readonly(
          "qd", [](const Trace& r) { return rows(r.qd); }, "[rad/s] measured")
      .def_property_readonly(
          "tau", [](const Trace& r) { return rows(r.tau); }, "[N m] measured, on the link's side")
      .def_property_readonly(
          "tau_ext", [](const Trace& r) { return or_none(r.tau_ext); },
          "[N m] the truth, with the sign of equation (3); None if it is unknown")
      .def_property_readonly(
          "contact",
          [](const Trace& r) -> py::object {
            if (r.contact.empty()) return py::none();
            return py::array_t<std::uint8_t>(static_cast<py::ssize_t>(r.contact.size()),
                                             r.contact.data())
                .attr("astype")("bool");
          },
          "whether a collision acts; None if it is unknown")
      .def_property_readonly(
          "torque_at_instants", [](const Trace& r) { return r.torque_at_instants; },
          "whether tau was read at t; else it holds until the next sample")
      .def_property_readonly("joints", &Trace::dof)
      .def("__len__", &Trace::size)
      .def("__repr__",
           [](const Trace& r) {
             return fmt::format("<tauext.Run: {} samples of {} joints{}>", r.size(), r.dof(),
                                r.has_truth() ? ", with its truth" : "");
           })
      .def(
          "save",
          [](const Trace& r, const std::string& path) {
            if (path.ends_with(".npz"))
              write_npz(path, r);
            else if (path.ends_with(".mcap"))
              write_mcap(r, path);
            else
              write_csv(r, path);
          },
          py::arg("path"),
          "Writes a CSV, NumPy's arrays if the path ends in .npz, or MCAP if in .mcap.");
  m.def("read_log", &read, py::arg("path"), py::arg("columns") = "", py::arg("channel") = "",
        py::arg("robot") = "");
}

}  // namespace tauext::python
