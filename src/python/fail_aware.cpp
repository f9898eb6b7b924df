// The Python module fail_aware: fail_aware::Odometry with numpy arrays. doc/library.md has examples.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <sys/types.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "fail_aware_lidar_odometry/odometry.hpp"
#include "fail_aware_lidar_odometry/version.hpp"

namespace py = pybind11;

namespace {

using fail_aware::ExternalPose;
using fail_aware::Odometry;
using fail_aware::Parameters;
using fail_aware::Result;
using fail_aware::Sweep;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A contiguous array of numbers of type T with `columns` columns (0: one dimension) and `rows` rows (-1: any).
template <class T>
py::array_t<T> numbers(const py::object& object, const char* name, ssize_t rows, ssize_t columns) {
  const py::array given = py::array::ensure(object);
  if (!given) PyErr_Clear();
  const bool numeric = given && std::string("fiu").find(given.dtype().kind()) != std::string::npos;
  const bool shaped = given && given.ndim() == (columns == 0 ? 1 : 2) && (columns == 0 || given.shape(1) == columns) &&
                      (rows < 0 || given.shape(0) == rows);
  if (numeric && shaped) return py::array_t<T, py::array::c_style | py::array::forcecast>(given);
  std::ostringstream text;
  text << name << ": must be an array of numbers of shape (" << (rows < 0 ? "N" : std::to_string(rows));
  text << (columns == 0 ? "," : ", " + std::to_string(columns)) << ")";
  if (given)
    text << ", not " << std::string(py::str(given.dtype())) << ' '
         << std::string(py::str(py::tuple(given.attr("shape"))));
  throw py::value_error(text.str());
}

Eigen::MatrixXd matrix(const py::object& object, const char* name, ssize_t size) {
  const py::array_t<double> values = numbers<double>(object, name, size, size);
  Eigen::MatrixXd result(size, size);
  for (ssize_t row = 0; row < size; ++row) {
    for (ssize_t column = 0; column < size; ++column) result(row, column) = values.at(row, column);
  }
  if (!result.allFinite()) throw py::value_error(std::string(name) + ": must be finite");
  return result;
}

/// Times of a clock count from the first of them, so that 32 bits keep their resolution.
void setTimes(const py::array_t<double>& times_s, Sweep& sweep) {
  constexpr double kLargestOwnTime_s = 2.0;  // times within a sweep are smaller
  const double* const begin = times_s.data();
  const double* const end = begin + times_s.size();
  double first_s = std::numeric_limits<double>::infinity(), largest_s = 0.0;
  std::for_each(begin, end, [&](double time_s) {
    if (!std::isfinite(time_s)) return;
    first_s = std::min(first_s, time_s);
    largest_s = std::max(largest_s, std::abs(time_s));
  });
  if (largest_s > kLargestOwnTime_s) sweep.time_field.origin_s = first_s;
  sweep.times_s.reserve(static_cast<std::size_t>(times_s.size()));
  std::for_each(begin, end, [&](double time_s) {
    sweep.times_s.push_back(static_cast<float>(time_s - sweep.time_field.origin_s));
  });
}

Sweep sweepOf(const py::object& points_xyz, double stamp, const py::object& point_times, const py::object& rings) {
  if (!std::isfinite(stamp)) throw py::value_error("stamp: must be finite");
  Sweep sweep;
  sweep.stamp_s = stamp;
  const py::array_t<float> points = numbers<float>(points_xyz, "points_xyz", -1, 3);
  const ssize_t count = points.shape(0);
  sweep.points_lidar.resize(static_cast<std::size_t>(count));
  for (ssize_t i = 0; i < count; ++i) {
    sweep.points_lidar[static_cast<std::size_t>(i)] = Eigen::Map<const Eigen::Vector3f>(points.data(i));
  }
  if (!point_times.is_none()) {
    setTimes(numbers<double>(point_times, "point_times", count, 0), sweep);
  }
  if (!rings.is_none()) {
    const py::array_t<double> numbers_of_rings = numbers<double>(rings, "rings", count, 0);
    for (ssize_t i = 0; i < count; ++i) {
      const double ring = numbers_of_rings.at(i);
      if (!(ring >= 0.0 && ring <= std::numeric_limits<std::uint16_t>::max() && ring == std::floor(ring))) {
        throw py::value_error("rings: must be whole numbers from 0 to 65535");
      }
      sweep.rings.push_back(static_cast<std::uint16_t>(ring));
    }
  }
  return sweep;
}

/// True -> "true", 0.1 -> "0.1", (0, 1) -> "[0, 1]"
std::string textOf(const py::handle& value) {
  const bool text = py::isinstance<py::str>(value);
  if (!text && py::hasattr(value, "__iter__")) {
    std::string list;
    for (const py::handle item : value) list += (list.empty() ? "" : ", ") + textOf(item);
    return "[" + list + "]";
  }
  const std::string word = py::str(value);
  return text || (word != "True" && word != "False") ? word : word == "True" ? "true" : "false";
}

ExternalPose poseOf(const py::object& pose, double stamp, const py::object& covariance) {
  if (!std::isfinite(stamp)) throw py::value_error("stamp: must be finite");
  ExternalPose result;
  result.stamp_s = stamp;
  result.T_odom_base.matrix() = matrix(pose, "pose", 4);
  const Eigen::Matrix3d R = result.T_odom_base.linear();
  const bool affine = result.T_odom_base.matrix().row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
  if (!affine || !(R * R.transpose()).isIdentity(1e-6) || R.determinant() < 0.0) {
    throw py::value_error("pose: must be a rotation, a translation and the row 0 0 0 1");
  }
  if (!covariance.is_none()) result.covariance = matrix(covariance, "covariance", 6);
  return result;
}

void refuseIf(const std::string& reason) {
  if (!reason.empty()) throw py::value_error(reason);
}

std::vector<std::string> reasonsOf(const Result& result) {
  std::vector<std::string> names;
  std::istringstream text(fail_aware::reasonText(result.monitor.reasons));
  for (std::string name; std::getline(text, name, '|');) names.push_back(name);
  return names;
}

void bindResult(py::handle module) {
  const auto orNone = [](double value) { return value < 0.0 ? std::optional<double>() : value; };
  py::class_<Result>(module, "Result", "What the odometry says about one sweep.")
      .def_property_readonly(
          "stamp", [](const Result& r) { return r.stamp_s; }, "s; the pose is that of this instant")
      .def_property_readonly(
          "status", [](const Result& r) { return fail_aware::toString(r.status); },
          "not_started, first, corrected, predicted or stamp_not_advancing")
      .def_property_readonly("has_pose", &Result::hasPose, "False: the sweep has no pose of its own")
      .def_property_readonly(
          "pose", [](const Result& r) { return Eigen::Matrix4d(r.T_odom_base.matrix()); },
          "(4, 4) float64: base_link in odom, p_odom = pose @ p_base; m")
      .def_property_readonly(
          "covariance", [](const Result& r) { return r.covariance; },
          "(6, 6) float64, of pose, accumulated since the start: x y z (m), rotation about the fixed axes x y z of "
          "odom "
          "(rad)")
      .def_property_readonly(
          "state", [](const Result& r) { return fail_aware::toString(r.monitor.state); },
          "UNKNOWN, OK, DEGRADED, FAILING or FAILED")
      .def_property_readonly("reasons", &reasonsOf, "list of str: why the state is what it is; doc/troubleshooting.md")
      .def_property_readonly(
          "time_to_failure", [](const Result& r) { return r.monitor.time_to_failure.seconds; },
          "s from now; 0: already failed, -1: unknown; see time_to_failure_status")
      .def_property_readonly(
          "time_to_failure_status",
          [](const Result& r) { return fail_aware::toString(r.monitor.time_to_failure.status); },
          "UNKNOWN, REACHED, WITHIN_HORIZON or BEYOND_HORIZON (time_to_failure is the horizon)")
      .def_property_readonly(
          "t1", [orNone](const Result& r) { return orNone(r.monitor.t1_stamp_s); },
          "s: stamp from which the odometry serves as the localisation; None: it does not")
      .def_property_readonly(
          "sigma_xy", [](const Result& r) { return Eigen::Vector2d(r.monitor.sigma_x_m, r.monitor.sigma_y_m); },
          "(2,) float64: standard deviations of the position since t1, m, in the frame at t1")
      .def_property_readonly(
          "protection_level", [orNone](const Result& r) { return orNone(r.monitor.protection_level_m); },
          "m: bound of the horizontal error since t1; 1e6: nothing bounds it, None: unknown")
      .def_property_readonly(
          "min_information_ahead", [](const Result& r) { return r.monitor.min_information_ahead; },
          "0..1, on the weakest stretch in view: ratio of the walls' information along the road; 1: not known")
      .def_property_readonly(
          "information_ahead_distance", [](const Result& r) { return r.monitor.information_ahead_distance_m; },
          "m: to where this stretch begins")
      .def_property_readonly(
          "pose_set_refused", [](const Result& r) { return r.pose_set_refused; },
          "why a pose that was set could not be taken; empty: it is done, it waits for a motion, or there was none");
}

}  // namespace

PYBIND11_MODULE(fail_aware, module) {
  module.doc() = "Lidar odometry for road vehicles that says how long it can be trusted.";
  module.attr("__version__") = FAIL_AWARE_LIDAR_ODOMETRY_VERSION;
  bindResult(module);
  py::class_<Odometry>(module, "Odometry",
                       "One sweep in, one Result out. Deterministic. Not for several threads at once.")
      .def(py::init([](const std::string& profile, const std::string& vehicle, const std::string& sensor,
                       const std::map<std::string, py::object>& parameters, const std::vector<std::string>& files,
                       int threads, const std::string& cfg) {
             Parameters chosen;
             chosen.profile = profile;
             chosen.vehicle = vehicle;
             chosen.sensor = sensor;
             chosen.files = files;
             chosen.cfg = cfg;
             for (const auto& [key, value] : parameters) chosen.overrides[key] = textOf(value);
             return std::make_unique<Odometry>(chosen, threads);
           }),
           py::arg("profile") = "default", py::arg("vehicle") = "passat_b6", py::arg("sensor") = "hdl64e",
           py::arg("parameters") = std::map<std::string, py::object>(), py::arg("files") = std::vector<std::string>(),
           py::arg("threads") = 2, py::arg("cfg") = "",
           "profile, vehicle, sensor: names of the package's files or paths of yaml files.\n"
           "parameters: dict, key -> value, over the files, as {'sensor.timing.source': 'none'} (doc/parameters.md).\n"
           "files: yaml files with some keys each. cfg: the folder of the package's files; '': the installed one.\n"
           "Raises ValueError (a key or a value) or RuntimeError (a file).")
      .def(
          "step",
          [](Odometry& odometry, const py::object& points_xyz, double stamp, const py::object& point_times,
             const py::object& rings) {
            Sweep sweep = sweepOf(points_xyz, stamp, point_times, rings);
            const py::gil_scoped_release released;
            return odometry.step(std::move(sweep));
          },
          py::arg("points_xyz"), py::arg("stamp"), py::arg("point_times") = py::none(), py::arg("rings") = py::none(),
          "One revolution; sweeps come in the order of their stamps.\n"
          "points_xyz: (N, 3) float32 or float64, m, sensor frame; points that are not finite or (0, 0, 0) are left "
          "out.\n"
          "stamp: s. point_times: (N,), s from any instant of the sweep, or of a clock (float64). rings: (N,), laser "
          "number,\n"
          "0 = lowest beam.\n"
          "Releases the GIL. Raises ValueError for other shapes and types.")
      .def(
          "start_redundant",
          [](Odometry& odometry, double from_stamp) {
            if (std::isnan(from_stamp)) throw py::value_error("from_stamp: must not be NaN");
            odometry.startRedundant(from_stamp);
          },
          py::arg("from_stamp") = std::numeric_limits<double>::lowest(),
          "t1: from the next sweep that is not before from_stamp (s), the odometry serves as the localisation, and\n"
          "the time to failure counts the error since then. While no motion is measured yet, t1 is the first sweep\n"
          "that is observed.")
      .def("stop_redundant", &Odometry::stopRedundant,
           "Another localisation serves again: no t1; the state is UNKNOWN until start_redundant.")
      .def(
          "set_pose",
          [](Odometry& odometry, const py::object& pose, double stamp, const py::object& covariance) {
            refuseIf(odometry.setPose(poseOf(pose, stamp, covariance)));
          },
          py::arg("pose"), py::arg("stamp") = 0.0, py::arg("covariance") = py::none(),
          "base_link is there: taken with the next sweep. pose: (4, 4), base_link in odom, m. stamp: s, 0: that of "
          "the\n"
          "next sweep. covariance: (6, 6) as Result.covariance; None: known exactly. Raises ValueError if it is "
          "refused.")
      .def("add_source", &Odometry::addSource, py::arg("name"), py::arg("tolerance"),
           "A source of poses that join the fusion, each within tolerance (s) of its sweep.")
      .def(
          "offer",
          [](Odometry& odometry, const std::string& source, const py::object& pose, double stamp,
             const py::object& covariance) { refuseIf(odometry.offer(source, poseOf(pose, stamp, covariance))); },
          py::arg("source"), py::arg("pose"), py::arg("stamp"), py::arg("covariance"),
          "A pose of a source, before the sweep it is for; as in set_pose. A rotation block of zeros: not measured.")
      .def("reset", &Odometry::reset, "Everything anew; the next sweep is the first.");
}
