// SPDX-License-Identifier: Apache-2.0
#include "bench/python/runs.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "bench/python/arrays.h"
#include "bench/replay/robot_log.h"
#include "bench/roster/robots.h"
#include "mjcf/trace/read/npy_writer.h"
#include "mjcf/trace/trace.h"

namespace tauext::python {

namespace py = pybind11;

namespace {

Trace made(const Array& t, const Array& q, const Array& qd, const Array& tau,
           const py::object& tau_ext, const py::object& contact, bool torque_at_instants) {
  if (t.ndim() != 1 || q.ndim() != 2)
    throw std::invalid_argument("a run has t with a number, and q with a row, for each sample");
  const py::ssize_t n = t.shape(0), joints = q.shape(1);
  Trace run;
  run.t.assign(t.data(), t.data() + n);
  for (std::size_t k = 1; k < run.t.size(); ++k) {
    if (!(run.t[k] > run.t[k - 1]))
      throw std::invalid_argument(
          fmt::format("t must increase, and does not from {} to {} s", run.t[k - 1], run.t[k]));
  }
  run.q = columns(q, n, joints, "q");
  run.qd = columns(qd, n, joints, "qd");
  run.tau = columns(tau, n, joints, "tau");
  if (!tau_ext.is_none()) run.tau_ext = columns(tau_ext.cast<Array>(), n, joints, "tau_ext");
  if (!contact.is_none()) {
    const auto touches = contact.cast<Array>();
    if (touches.ndim() != 1 || touches.shape(0) != n)
      throw std::invalid_argument("contact has a number for each sample");
    for (py::ssize_t k = 0; k < n; ++k) run.contact.push_back(touches.at(k) != 0);
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
           py::arg("torque_at_instants") = false)
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
            else
              write_csv(r, path);
          },
          py::arg("path"), "Writes a CSV, or NumPy's arrays if the path ends in .npz.");
  m.def("read_log", &read, py::arg("path"), py::arg("columns") = "", py::arg("channel") = "",
        py::arg("robot") = "");
}

}  // namespace tauext::python
