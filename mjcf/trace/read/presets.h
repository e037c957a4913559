// SPDX-License-Identifier: Apache-2.0
/// @file
/// Maps of recordings that many people have (column_map.h), as TOML.
#pragma once

#include <span>
#include <string_view>

namespace tauext::detail {

/// A quantity and the regular expression of its columns.
struct NamedQuantity {
  std::string_view quantity;    ///< of kQuantities
  std::string_view expression;  ///< for whole names
};

/// A map that somebody can ask for.
struct ColumnPreset {
  std::string_view name;                 ///< by which it is asked for
  std::string_view what;                 ///< it reads
  std::span<const NamedQuantity> names;  ///< the map, if there is no more to say
  std::string_view toml;                 ///< else this
  std::string_view messages = "";        ///< types of ROS 2's that it reads, apart by blanks
};

/// What quantities are called in our own files.
inline constexpr NamedQuantity kTauext[] = {{"t", "t"},
                                            {"q", R"(q(\d+))"},
                                            {"qd", R"(qd(\d+))"},
                                            {"tau", R"(tau(\d+))"},
                                            {"tau_instant", R"(tau_instant(\d+))"},
                                            {"tau_ext", R"(tau_ext(\d+))"},
                                            {"driver", R"(driver(\d+))"},
                                            {"contact", "contact"}};

/// tau_J has gravity in it; tau_ext_hat_filtered is tau_J less the model, so the sign of (3).
inline constexpr std::string_view kLibfranka = R"(
[t]
columns = 'time|duration'
unit = "ms"
[q]
columns = '(?:state\.)?q\[(\d)\]'
[qd]
columns = '(?:state\.)?dq\[(\d)\]'
[tau_instant]
columns = '(?:state\.)?tau_J\[(\d)\]'
[driver]
columns = '(?:state\.)?tau_ext_hat_filtered\[(\d)\]'
[contact]
columns = 'contact'
)";

/// The robot measures no torque. Where it does not report its currents as torques, whoever uses it
/// says the gain of each drive.
inline constexpr std::string_view kUrRtde = R"(
[t]
columns = "timestamp"
[q]
columns = 'actual_q_(\d)'
[qd]
columns = 'actual_qd_(\d)'
[tau_instant]
columns = 'actual_current_as_torque_(\d)'
[current]
columns = 'actual_current_(\d)'
[contact]
columns = 'contact'
)";

/// External torque of KUKA has the opposite sign.
inline constexpr std::string_view kKukaFri = R"(
[t]
columns = ["tsec", "tnsec"]
unit = ["s", "ns"]
[q]
columns = 'mp(\d)|.*measured_joint_position.*?(\d)\D*'
[tau_instant]
columns = 'mt(\d)|.*measured_torque.*?(\d)\D*'
[driver]
columns = 'et(\d)|.*external_torque.*?(\d)\D*'
sign = -1
)";

/// Its LBRState, in a bag of ROS 2 or from one: the controller's clock.
inline constexpr std::string_view kLbrState = R"(
preset = "kuka_fri"
[t]
columns = ["time_stamp_sec", "time_stamp_nano_sec"]
unit = ["s", "ns"]
)";

/// Franka's state in a bag of ROS 2 (bag_rows.h), old and new: tau_ext_hat_filtered as libfranka's.
inline constexpr NamedQuantity kFrankaState[] = {
    {"t", "t"},
    {"q", R"(q\[(\d)\]|measured_joint_state\.position\.(.*))"},
    {"qd", R"(dq\[(\d)\]|measured_joint_state\.velocity\.(.*))"},
    {"tau_instant", R"(tau_[jJ]\[(\d)\]|measured_joint_state\.effort\.(.*))"},
    {"driver", R"(tau_ext_hat_filtered(?:\[(\d)\]|\.effort\.(.*)))"}};

/// In our own MCAP files: by the messages' t, as the stamps of the file are whole nanoseconds.
inline constexpr NamedQuantity kTauextMcap[] = {
    {"t", R"(message\.t)"},
    {"q", R"(q\[(\d+)\])"},
    {"qd", R"(qd\[(\d+)\])"},
    {"tau", R"(tau\[(\d+)\])"},
    {"tau_instant", R"(tau_instant\[(\d+)\])"},
    {"current", R"(current\[(\d+)\])"},
    {"tau_without_gravity", R"(tau_without_gravity\[(\d+)\])"},
    {"tau_ext", R"(tau_ext\[(\d+)\])"},
    {"driver", R"(driver\[(\d+)\])"},
    {"force", R"(force\[(\d+)\])"},
    {"contact", "contact"}};

/// In a bag of ROS 2 (bag_rows.h).
inline constexpr NamedQuantity kJointState[] = {{"t", "t"},
                                                {"q", R"(position\.(.*))"},
                                                {"qd", R"(velocity\.(.*))"},
                                                {"tau_instant", R"(effort\.(.*))"}};

/// The first one is what is taken if nobody says.
inline constexpr ColumnPreset kColumnPresets[] = {
    {"tauext", "CSV, .npy and .npz of tauext", kTauext, ""},
    {"libfranka", "franka::logToCSV of libfranka (Panda, FR3), old and new", {}, kLibfranka},
    {"ur_rtde", "Universal Robots' RTDE (record.py, ur_rtde); [current] wants a gain", {}, kUrRtde},
    {"kuka_fri", "KUKA's FRI as pyfri writes it", {}, kKukaFri},
    {"lbr_state",
     "LBRState of lbr_fri_idl or lbr_fri_msgs, in ROS 2 bags",
     {},
     kLbrState,
     "lbr_fri_idl/LBRState lbr_fri_msgs/LBRState"},
    {"franka_state", "FrankaRobotState or FrankaState of franka_msgs, in ROS 2 bags", kFrankaState,
     "", "franka_msgs/FrankaRobotState franka_msgs/FrankaState"},
    {"tauext_mcap", "MCAP of tauext: JSON with t, q, qd, tau or tau_instant, ..", kTauextMcap, "",
     "tauext.Measured"},
    {"joint_state", "sensor_msgs/JointState of ROS 2 bags", kJointState, "",
     "sensor_msgs/JointState"},
};

}  // namespace tauext::detail
