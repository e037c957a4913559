// SPDX-License-Identifier: Apache-2.0
// What tauext/__init__.py is made of.
#include "bench/python/python_estimator.h"
#include "bench/python/robots.h"
#include "bench/python/runs.h"
#include "bench/python/scores.h"
#include "bench/report/provenance.h"
#include "mjcf/mujoco/handles.h"

PYBIND11_MODULE(_core, m) {
  m.def("build", &tauext::build);
  m.def("mujoco_version", &tauext::mujoco_version);
  tauext::python::register_estimators();
  tauext::python::bind_runs(m);
  tauext::python::bind_robots(m);
  tauext::python::bind_scores(m);
}
