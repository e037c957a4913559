// SPDX-License-Identifier: Apache-2.0
// tauext-calibrate: what nobody's file knows of an arm, from recordings.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/calibrate/arm_calibration.h"
#include "bench/calibrate/masses/masses.h"
#include "bench/calibrate/robot_file_writer.h"
#include "bench/calibrate/weighing.h"
#include "bench/logs/read_log.h"
#include "bench/program/program.h"
#include "bench/replay/torque_fit.h"
#include "mjcf/import/masses/body_masses.h"
#include "mjcf/import/robot_file.h"
#include "mjcf/plant/coordinates.h"
#include "mjcf/plant/model.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/table_writer.h"

namespace {

using namespace tauext;

struct Flags {
  std::vector<std::string> logs, loaded, terms;
  std::string channel, columns, contacts, robot, lock, out, format = "text";
  Windows windows;
  bool list = false, apply = false, masses = false;
};

struct Arm {
  ArmTree tree;
  Eigen::VectorXd torque_gain;     // [1] of logs of torques
  std::set<std::string> massless;  // bodies whose masses the file does not have
};

void add_flags(CLI::App& app, Flags& f) {
  app.add_option("logs", f.logs, "without contact: CSV, .npy, .npz, MCAP, a ROS 2 bag or LCM");
  app.add_option("--robot", f.robot, "its file of MJCF, URDF or ours")->type_name("FILE");
  app.add_option("--lock", f.lock, "joints of that file to fix, like grippers'")
      ->type_name("REGEX")
      ->check(not_empty);
  app.add_option("--out,-o", f.out, "robot file (.json) to write; - is standard output")
      ->type_name("FILE");
  app.add_option("--weigh", f.loaded,
                 "recordings with a payload, which is weighed; the logs are without it")
      ->type_name("LOG..");
  app.add_flag("--masses", f.masses, "find the bodies' masses, also of a file that has none");
  app.add_option("--columns", f.columns, "what the logs' columns mean (see tauext-replay --help)")
      ->type_name("PRESET|FILE.toml");
  app.add_option("--contacts", f.contacts,
                 "labels beside the logs, file,start,end [s]: there they are left out")
      ->type_name("FILE.csv")
      ->check(not_empty);
  app.add_option("--channel", f.channel, "of an LCM log, or topic of a bag, with several of them");
  app.add_option("--terms", f.terms, "to find, apart by commas (see --list); without it all")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,..");
  app.add_flag("--apply", f.apply,
               "write torque scales into the file, which then multiplies logs by them");
  app.add_option("--window", f.windows.length, "length of a difference and of the means [s]")
      ->capture_default_str();
  app.add_option("--min_speed", f.windows.min_speed,
                 "slower samples are left out: friction there is unknown [rad/s]")
      ->capture_default_str();
  app.add_option("--format", f.format, "of the tables: text, csv, json, md or latex")
      ->type_name("NAME");
  app.add_flag("--list", f.list, "list the terms, and stop");
}

std::string list_terms() {
  TableWriter table({{"term", "", true}, {"unit", "", true}, {"what it multiplies", "", true}});
  for (const JointTerm& t : kJointTerms) table.add({t.name, t.unit, t.what});
  return table.format();
}

std::string number(double x) {
  return fmt::format("{:.4g}", x);
}

// to a tenth of its standard error
std::string number(double x, double error) {
  const double digits = std::ceil(std::log10(std::abs(x / error))) + 1;
  return fmt::format("{:.{}g}", x, digits > 4 ? static_cast<int>(std::min(digits, 9.)) : 4);
}

// a sentence for each
std::string missing(const std::vector<Suspect>& all, const std::string& where) {
  std::string out;
  for (const Suspect& s : all) {
    out += fmt::format(
        "{}Missing? {} would explain {:.0f} % of the residuals' variance ({:.0f} standard "
        "errors).\n",
        where, s.name, 100 * s.share, s.surely);
  }
  if (!all.empty()) out += where + "The errors above do not know of what is missing.\n";
  return out;
}

// those whose torques and masses disagree
std::string scales_off_one(const std::vector<CalibratedJoint>& joints) {
  constexpr double kClear = 0.05;  // [1]
  std::string off;
  for (const CalibratedJoint& j : joints)
    if (j.scale != 0 && std::abs(j.scale - 1) > std::max(kClear, kSurely * j.scale_error))
      off += fmt::format("{}{} {:.3f}", off.empty() ? "" : ", ", printable_name(j.name), j.scale);
  if (off.empty()) return "";
  return fmt::format(
      "Measured torques and masses disagree by a factor, the torque scale: {}.\nEither the sensors "
      "say 1/scale of what they should, which --apply puts right, or the masses are wrong "
      "(--masses "
      "finds them).\n",
      off);
}

// the parameters of each joint with their errors
std::string parameter_table(const std::vector<CalibratedJoint>& joints, TableFormat format) {
  TableWriter table({{"joint", "", true},
                     {"term", "", true},
                     {"unit", "", true},
                     {"estimate"},
                     {"std error"},
                     {"excitation", "rms"},
                     {"own share"}});
  for (const CalibratedJoint& j : joints) {
    std::string name = printable_name(j.name);
    const auto add = [&](const std::string& term, const char* unit, double value, double error,
                         const std::string& excitation, const std::string& own) {
      table.add({format == TableFormat::kText ? std::exchange(name, "") : name, term, unit,
                 number(value, error), fmt::format("{:.2g}", error), excitation, own});
    };
    if (j.gain != 0)
      add(j.of_currents ? "gain" : "torque_gain", j.of_currents ? "N m/A" : "1",
          j.gain * j.gain_before, std::abs(j.gain_error * j.gain_before), "", "");
    for (const CalibratedTerm& t : j.terms) {
      const JointTerm& known =
          find_known(kJointTerms, "term", t.name, [](const JointTerm& k) { return k.name; });
      add(t.name, known.unit, t.value, t.error, number(t.excitation), fmt::format("{:.3f}", t.own));
    }
  }
  return table.format(format);
}

// how well they explain the recordings; and in sentences what may be missing, and what nobody can
// see
std::string fit_report(const std::vector<CalibratedJoint>& joints) {
  TableWriter table({{"joint", "", true},
                     {"torque", "N m rms"},
                     {"masses", "N m rms"},
                     {"without", "N m rms"},
                     {"with", "N m rms"},
                     {"held out", "N m rms"},
                     {"windows"},
                     {"left out"},
                     {"torque scale"},
                     {"std error"}});
  std::string sentences;
  bool unseen = false, currents = false;
  for (const CalibratedJoint& j : joints) {
    const bool seen = j.scale != 0;
    table.add({printable_name(j.name), number(j.torque), number(j.rigid), number(j.before),
               number(j.after), number(j.held_out), fmt::format("{}", j.windows),
               fmt::format("{}", j.left_out),
               j.gain != 0 && !seen ? "gain"
               : seen               ? fmt::format("{:.3f}", j.scale)
                                    : "unseen",
               !seen ? "" : fmt::format("{:.2g}", j.scale_error)});
    unseen = unseen || (j.gain == 0 && !seen);
    currents = currents || (j.gain != 0 && j.of_currents);
    sentences += missing(j.missing, printable_name(j.name) + ": ");
  }
  sentences += scales_off_one(joints);
  sentences +=
      "What no motion without contact can tell: f times all torques from f times all masses, "
      "friction and rotors.\nIf the masses are wrong by a factor, so are the ";
  sentences +=
      currents ? "gains, friction and every estimate" : "torque scale above and every estimate";
  sentences += ", by the same; a known payload shows it (--weigh).\n";
  const bool all_unseen = std::all_of(joints.begin(), joints.end(), [](const CalibratedJoint& j) {
    return j.gain == 0 && j.scale == 0;
  });
  if (all_unseen && !joints.empty())
    sentences +=
        "The masses take next to nothing of any joint's torque: are torques in N m, and currents "
        "in A?\n";
  if (unseen)
    sentences += fmt::format(
        "Where the masses take less than {:g} of the torque, its scale is unseen.\n", kSeen);
  return table.format() + "\n" + sentences;
}

// a weight seen with the payload, without it, and their difference
std::string weighing_table(const Weighing& w, TableFormat format) {
  const bool text = format == TableFormat::kText;
  std::vector<TableWriter::Column> columns = {
      {"seen", "", true},    {"mass", "kg"}, {"std error", "kg"},
      {"x", "kg m"},         {"y", "kg m"},  {"z", "kg m"},
      {"std error", "kg m"}, {"windows"},    {"left", "N m rms"}};
  if (!text)  // else in a sentence
    for (const char* axis : {"x", "y", "z"})
      for (const char* of : {"center ", "std error of center "})
        columns.push_back({std::string(of) + axis, "m"});
  TableWriter table(std::move(columns));
  const auto add = [&](const char* what, const Weight& s, bool measured) {
    std::vector<std::string> cells = {what,
                                      fmt::format("{:.3f}", s.mass),
                                      fmt::format("{:.2g}", s.mass_error),
                                      fmt::format("{:.4f}", s.moment[0]),
                                      fmt::format("{:.4f}", s.moment[1]),
                                      fmt::format("{:.4f}", s.moment[2]),
                                      fmt::format("{:.2g}", s.moment_error.maxCoeff()),
                                      measured ? fmt::format("{}", s.windows) : "",
                                      measured ? number(s.residual) : ""};
    for (int i = 0; i < 3 && !text; ++i) {
      const bool known = !measured && w.payload.mass > 3 * w.payload.mass_error;
      cells.push_back(known ? fmt::format("{:.4f}", w.center[i]) : "");
      cells.push_back(known ? fmt::format("{:.2g}", w.center_error[i]) : "");
    }
    table.add(std::move(cells));
  };
  add("loaded", w.loaded, true);
  if (w.empty.windows > 0) add("empty", w.empty, true);
  add("payload", w.payload, false);
  std::string out = table.format(format);
  if (!text) return out;
  out += fmt::format("\nMoments are about the origin of the body '{}', in its axes.\n",
                     printable_name(w.body));
  if (w.payload.mass > 3 * w.payload.mass_error) {
    out += fmt::format("Center of mass [m]: {:.4f} +- {:.2g}, {:.4f} +- {:.2g}, {:.4f} +- {:.2g}\n",
                       w.center[0], w.center_error[0], w.center[1], w.center_error[1], w.center[2],
                       w.center_error[2]);
  }
  if (w.empty.windows == 0)
    out +=
        "Without recordings of the empty arm (the logs before --weigh), what the model has wrong "
        "is weighed, too.\n";
  return out;
}

// what of the base parameters was shown, and of which bodies some were not
std::string shown(const IdentifiedMasses& m) {
  std::string words = fmt::format(
      "Torques can show {} combinations of these numbers (base parameters); the recordings show {} "
      "of them, with a standard error below a tenth of what the bodies have.\n",
      m.base.all, m.base.shown);
  std::vector<std::string> missing;
  for (std::size_t b = 0; b < m.bodies.size(); ++b)
    if (const double n = m.base.missing[static_cast<Eigen::Index>(b)]; n >= 0.5)
      missing.push_back(fmt::format("{:.0f} of {}", n, printable_name(m.bodies[b].name)));
  if (!missing.empty())
    words +=
        fmt::format("Not shown: {}. There the numbers stay near {}.\n", fmt::join(missing, ", "),
                    m.has_nominal ? "those of the file"
                                  : "those of rods from joint to joint, as the file has none");
  return words;
}

// the bodies' numbers, which have no errors, as torques do not show them one by one
std::string body_table(const IdentifiedMasses& m, TableFormat format) {
  TableWriter table({{"body", "", true},
                     {"mass", "kg"},
                     {"in the file", "kg"},
                     {"center x", "m"},
                     {"center y", "m"},
                     {"center z", "m"},
                     {"least moment", "kg m^2"},
                     {"middle", "kg m^2"},
                     {"largest", "kg m^2"}});
  for (const IdentifiedBody& b : m.bodies) {
    const MeasuredBody& found = b.identified;
    const Eigen::Vector3d I =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(detail::tensor(found)).eigenvalues();
    table.add({printable_name(b.name), number(found.mass), b.known ? number(b.file.mass) : "",
               number(found.center[0]), number(found.center[1]), number(found.center[2]),
               number(I[0]), number(I[1]), number(I[2])});
  }
  return table.format(format);
}

// what they are good for, joint by joint; and in sentences what was shown, and what nobody can see
std::string mass_report(const IdentifiedMasses& m) {
  TableWriter table({{"joint", "", true},
                     {"torque", "N m rms"},
                     {"file's masses", "N m rms"},
                     {"these masses", "N m rms"},
                     {"gravity", "+- N m"},
                     {"inertia", "+- kg m^2"}});
  for (const JointOfMasses& j : m.joints)
    table.add({j.name, number(j.torque), m.has_nominal ? number(j.nominal) : "", number(j.held_out),
               fmt::format("{:.2g}", j.gravity_error), fmt::format("{:.2g}", j.inertia_error)});
  return table.format() +
         "\nMasses leave that much of the torque, with friction that fits them, in stretches that "
         "the fit has not seen;\ngravity and inertia are one standard error of the torque that "
         "holds "
         "a joint, and of what it turns, in poses of all of its range.\n" +
         shown(m) +
         "No single mass, center or inertia is known by this, and none has an error here: others "
         "that make the same torques are as good.\n"
         "What no motion without contact can tell: f times all torques from f times all masses, "
         "friction and rotors.\n";
}

void write_file(const std::string& text, const std::string& out) {
  AtomicFile file(out);
  file.write(text);
  file.commit();
}

// what `make` makes of the logs, and of which logs it cannot
template <class Make>
auto naming(const std::vector<std::string>& logs, Make&& make) {
  try {
    return make();
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(fmt::format("{}: {}", fmt::join(logs, ", "), e.what()));
  }
}

int not_sure(const Flags& f) {
  say(fmt::format(
      "tauext-calibrate: {}these numbers are not to be used: is this the robot of the recordings, "
      "and do their columns have the right joints, units (rad, rad/s, N m or A) and signs? "
      "--columns tells them",
      f.out.empty() ? "" : f.out + " is not written, as "));
  return kAnswerIsNo;
}

std::vector<std::string> all_logs(const Flags& f) {
  std::vector<std::string> all = f.logs;
  all.insert(all.end(), f.loaded.begin(), f.loaded.end());
  return all;
}

struct Recordings {
  std::vector<Trace> logs;
  bool usable = true;          // most of each
  bool gravity_added = false;  // to the torques of one
};

// without those that repeat the one before though a joint moves: sensors are slower than the log
Trace without_repeats(const Trace& t) {
  constexpr double kMoves = 1e-3;  // [rad/s]
  std::vector<int> kept;
  for (int k = 0; k < t.size(); ++k) {
    const bool repeats = k > 0 && t.q.col(k) == t.q.col(k - 1) && t.qd.col(k) == t.qd.col(k - 1) &&
                         t.tau.col(k) == t.tau.col(k - 1) &&
                         t.qd.col(k).cwiseAbs().maxCoeff() > kMoves;
    if (!repeats) kept.push_back(k);
  }
  return static_cast<int>(kept.size()) == t.size() ? t : select_samples(t, kept);
}

Recordings read_logs(const Flags& f, const Arm& arm, const std::vector<std::string>& paths) {
  const auto contacts = contacts_of(f.contacts, all_logs(f));
  Recordings all;
  for (const std::string& path : paths) {
    RecordedLog log =
        read_any_log(path, {f.channel, f.columns, arm.tree.joint_names(), true, contacts});
    log.require_consistent(path);
    all.usable = all.usable && log.usable();
    if (log.velocity_delay > 0) {
      say(
          fmt::format("{}: its qd is made of q, some {:.0f} ms late, which makes rotors too large: "
                      "record qd, too",
                      path, 1000 * log.velocity_delay));
      all.usable = false;
    }
    log.trace = without_repeats(log.trace);
    all.gravity_added = all.gravity_added || log.trace.tau_without_gravity;
    if (log.trace.dof() != arm.tree.dof())
      throw std::invalid_argument(fmt::format("{}: the log has {} joints, and {} has {}", path,
                                              log.trace.dof(), f.robot, arm.tree.dof()));
    if (!log.trace.tau_is_current) log.trace.tau = arm.torque_gain.asDiagonal() * log.trace.tau;
    add_gravity(log.trace, arm.tree);
    all.logs.push_back(std::move(log.trace));
  }
  return all;
}

// bodies without a mass, of a file that cannot be read for them; what else is wrong with it is said
// when it is read without their masses
std::set<std::string> massless_of(const Flags& f) {
  try {
    load_mjcf(f.robot, {f.lock, {}});
    return {};
  } catch (const std::runtime_error&) {
    ImportOptions how{f.lock, {}};
    how.masses_unknown = true;
    load_mjcf(f.robot, how);
    const RobotFile file = robot_file(f.robot, how);
    return import_mjcf(file.path, file.options).massless;
  }
}

// says what is wrong with the robot's file
Arm arm_of(const Flags& f) {
  std::string changes;
  ImportOptions how{f.lock, {}};
  const std::set<std::string> massless = f.masses ? massless_of(f) : std::set<std::string>();
  how.masses_unknown = !massless.empty();
  const Model model = load_mjcf(f.robot, how, &changes);
  if (!changes.empty()) say(fmt::format("{}: {}", f.robot, changes));
  try {
    return {tree_of(model), torque_gains_of(model), massless};
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument(fmt::format("{}: {}", f.robot, e.what()));
  }
}

// and what was held; whether there is no doubt
bool say_doubts(const std::vector<CalibratedJoint>& joints) {
  bool sure = true;
  for (const CalibratedJoint& j : joints) {
    const std::string name = printable_name(j.name);
    for (const std::string& words : j.held) say(fmt::format("{}: {}", name, words));
    for (const std::string& why : j.doubts) say(fmt::format("joint '{}': {}", name, why));
    sure = sure && j.doubts.empty();
  }
  return sure;
}

// whether tau held, or was read at instants, as it is taken for: the other reading leaves no less
// than 1 / 1.5 of what is left
bool is_read_rightly(const ArmTree& arm, std::vector<Trace> logs, const CalibrateOptions& o,
                     const std::vector<CalibratedJoint>& as_it_is) {
  constexpr double kMuch = 1.5 * 1.5;                                 // [1] of mean squares
  const auto left = [](const std::vector<CalibratedJoint>& joints) {  // [1] of a torque's, mean
    double sum = 0;
    for (const CalibratedJoint& j : joints)
      if (j.torque > 0) sum += std::pow(j.after / j.torque, 2);
    return sum / static_cast<double>(joints.size());
  };
  for (Trace& log : logs) log.torque_at_instants = !log.torque_at_instants;
  const double other = left(calibrate_arm(arm, logs, o)), own = left(as_it_is);
  if (!(kMuch * other < own)) return true;
  const bool instant = logs.front().torque_at_instants;
  say(fmt::format(
      "tau seems to be {}: so read, {:.2g} of it is left over, and {:.2g} as it is. In a map "
      "(--columns), [{}] instead of [{}] says so",
      instant ? "read at each t" : "held from each t", std::sqrt(other), std::sqrt(own),
      instant ? "tau_instant" : "tau", instant ? "tau" : "tau_instant"));
  return false;
}

int calibrate(const Flags& f, const Arm& robot_arm) {
  const ArmTree& arm = robot_arm.tree;
  Recordings all = read_logs(f, robot_arm, f.logs);
  std::vector<Trace>& logs = all.logs;
  bool usable = all.usable;
  const bool currents = logs.front().tau_is_current;
  if ((arm.gain.array() != 0).all())  // else they are found
    for (Trace& log : logs) make_torques(log, arm.gain);
  if (!logs.front().tau_is_current)
    usable = torques_fit(arm, logs, all.gravity_added, f.logs) && usable;
  CalibrateOptions o;
  o.windows = f.windows;
  o.terms = f.terms;
  o.scale = f.apply;
  NewRobotFile robot{f.robot, f.lock, {}, nullptr, f.logs};
  robot.joints = naming(f.logs, [&] { return calibrate_arm(arm, logs, o); });
  if (!currents && !all.gravity_added)
    usable = naming(f.logs, [&] { return is_read_rightly(arm, logs, o, robot.joints); }) && usable;
  judge_by_file(robot, logs, f.windows);
  if (!logs.front().tau_is_current)  // what was scaled had a gain before
    for (int i = 0; i < arm.dof(); ++i) {
      CalibratedJoint& j = robot.joints[static_cast<std::size_t>(i)];
      j.of_currents = currents;
      j.gain_before = currents ? arm.gain[i] : robot_arm.torque_gain[i];
    }
  std::FILE* const to = f.out == "-" ? stderr : stdout;
  const TableFormat format = table_format(f.format);
  fmt::print(to, "{}", parameter_table(robot.joints, format));
  if (format == TableFormat::kText) fmt::print(to, "\n{}", fit_report(robot.joints));
  if (!say_doubts(robot.joints)) return not_sure(f);
  if (!f.out.empty()) write_file(robot_file_text(robot, f.out), f.out);
  return usable ? kGood : kAnswerIsNo;
}

// torques are compared with the masses that were found, as those of the file may be wrong
int find_masses(const Flags& f, const Arm& robot_arm) {
  Recordings all = read_logs(f, robot_arm, f.logs);
  std::vector<Trace>& logs = all.logs;
  if (all.gravity_added)
    throw std::invalid_argument(
        "--masses: these recordings have torques without gravity, which shows most of the masses: "
        "record torques with gravity in them");
  for (Trace& log : logs) make_torques(log, robot_arm.tree.gain);
  NewRobotFile robot{f.robot, f.lock, {}, nullptr, f.logs, {}};
  const IdentifiedMasses m = naming(f.logs, [&] {
    return identify_masses(robot_arm.tree, robot_arm.massless, logs, f.windows, robot);
  });
  judge_by_file(robot, logs, f.windows);
  std::FILE* const to = f.out == "-" ? stderr : stdout;
  const TableFormat format = table_format(f.format);
  fmt::print(to, "{}", body_table(m, format));
  if (format == TableFormat::kText)
    fmt::print(to, "\n{}\n{}", parameter_table(robot.joints, format), mass_report(m));
  bool sure = say_doubts(robot.joints);
  for (const std::string& why : m.doubts) say(why);
  if (!sure || !m.doubts.empty()) return not_sure(f);
  const bool usable = torques_fit(read_back(robot), logs, false, f.logs) && all.usable;
  if (!f.out.empty()) write_file(robot_file_text(robot, f.out), f.out);
  return usable ? kGood : kAnswerIsNo;
}

int weigh_payload(const Flags& f, const Arm& robot_arm) {
  const ArmTree& arm = robot_arm.tree;
  Recordings empty = read_logs(f, robot_arm, f.logs), loaded = read_logs(f, robot_arm, f.loaded);
  for (Recordings* const all : {&empty, &loaded})
    for (Trace& log : all->logs) make_torques(log, arm.gain);
  const auto w = naming(f.loaded, [&] { return weigh(arm, loaded.logs, empty.logs, f.windows); });
  fmt::print(f.out == "-" ? stderr : stdout, "{}", weighing_table(w, table_format(f.format)));
  std::string why = doubt(w);
  if (why.empty() && !f.out.empty() && !(w.payload.mass > 0))
    why = "the recordings show no payload";
  if (!why.empty()) {
    say(why);
    return not_sure(f);
  }
  if (!f.out.empty()) {
    write_file(robot_file_text({f.robot, f.lock, {}, &w, all_logs(f)}, f.out), f.out);
  }
  return empty.usable && loaded.usable ? kGood : kAnswerIsNo;
}

int run(const CLI::App& app, Flags& f) {
  if (f.list) {
    fmt::print("{}", list_terms());
    return kGood;
  }
  if (f.robot.empty())
    throw std::invalid_argument(
        "--robot FILE is required: of a testbed, an MJCF or URDF of its joint (see "
        "mjcf/testbed1.xml)");
  table_format(f.format);
  if (!f.out.empty() && f.out != "-") {
    if (!f.out.ends_with(".json"))
      throw std::invalid_argument(
          fmt::format("--out {}: the name of a robot file ends in .json", f.out));
    const AtomicFile probe(f.out);  // an unwritable path should not cost a run
  }
  require_mode(app, !f.masses, "finding a payload, friction or scales, not masses",
               {"--weigh", "--terms", "--apply"});
  const Arm arm = arm_of(f);
  if (!f.loaded.empty()) {
    require_mode(app, false, "calibrating, not with --weigh", {"--terms", "--apply"});
    return weigh_payload(f, arm);
  }
  if (f.logs.empty())
    throw std::invalid_argument("recordings are required; see tauext-calibrate --help");
  return f.masses ? find_masses(f, arm) : calibrate(f, arm);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Finds friction, rotors' inertia, offsets and drives' gains (--masses: masses, too) of an "
      "arm\n"
      "from recordings without contact, and writes a robot file that every --robot takes. --weigh\n"
      "weighs a payload.\n\n"
      "  tauext-calibrate free*.csv --robot arm.urdf --columns ur_rtde --out arm.json\n"
      "  tauext-calibrate free*.csv --robot arm.json --columns ur_rtde --weigh loaded.csv\n",
      "tauext-calibrate");
  Flags f;
  add_flags(app, f);
  return run_program(app, argc, argv, [&] { return run(app, f); });
}
